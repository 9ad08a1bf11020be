// Options and result of hmf_parameterize.
import { callback, indices, realNumber } from './arguments.js';

export const PARAMETERIZE_OPTIONS = ['tolerance', 'seamEdges', 'progress'];

/** hmf_parameterize on a level with the given counts. */
export function parameterize(frame, hierarchy, { index, vertexCount, edgeCount, triangleCount }, values, options, progressFields) {
    const fields = { ...progressFields };
    if (options.tolerance !== undefined) fields.tolerance = realNumber(options.tolerance, 'tolerance');
    if (options.progress !== undefined) callback(options.progress, 'progress');
    if (options.seamEdges !== undefined) {
        const edges = indices(options.seamEdges, 'seamEdges');
        fields.seam_edges = frame.copy(edges);
        fields.seam_edge_count = edges.length;
    }
    const arrays = {
        corner_uv: [Float64Array, 6 * triangleCount],
        transition: [Float64Array, 3 * edgeCount],
        seam: [Uint8Array, edgeCount],
        cone: [Int32Array, vertexCount],
        dilatation: [Float64Array, triangleCount],
        differential: [Float64Array, 2 * triangleCount],
    };
    const rooms = Object.fromEntries(Object.entries(arrays).map(([name, [Type, count]]) => [name, frame.room(Type, count)]));
    const out = frame.structure('hmf_parameterization', { ...rooms, vertex_capacity: vertexCount, edge_capacity: edgeCount, triangle_capacity: triangleCount });
    const status = frame.call('hmf_parameterize', hierarchy, index, frame.copy(values), values.length,
        frame.structure('hmf_parameterize_options', fields), out);
    if (status !== 0) throw frame.error(status);
    const result = frame.read('hmf_parameterization', out);
    const array = name => frame.result(arrays[name][0], rooms[name], arrays[name][1]);
    return {
        cornerUv: array('corner_uv'),
        transition: array('transition'),
        seam: array('seam'),
        cone: array('cone'),
        dilatation: array('dilatation'),
        differential: array('differential'),
        dilatationMean: result.dilatation_mean,
        dilatationMedian: result.dilatation_median,
        dilatationP99: result.dilatation_p99,
        flippedTriangles: result.flipped_triangles,
        degenerateTriangles: result.degenerate_triangles,
        seamEdgeCount: result.seam_edge_count,
        seamLength: result.seam_length,
        area: result.area,
        linearIterations: result.linear_iterations,
        seconds: result.seconds,
    };
}
