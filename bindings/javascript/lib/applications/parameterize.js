// hmf_parameterize.
import { indices, optionsOf, realNumber } from '../arguments.js';
import { option } from '../options.js';

export function parameterize(foliation, options) {
    const given = optionsOf(options, 'options', ['tolerance', 'seamEdges', 'progress']);
    return foliation.perform(given, (frame, address) => {
        const fields = { tolerance: option(given, 'tolerance', realNumber) };
        if (given.seamEdges !== undefined) {
            fields.seam_edge_count = indices(given.seamEdges, 'seamEdges').length;
            fields.seam_edges = frame.copy(Uint32Array, given.seamEdges);
        }
        const result = frame.result('hmf_parameterize', address, frame.structure('hmf_parameterize_options', fields));
        const { vertexCount, edgeCount, triangleCount, ...numbers } = frame.plain('hmf_parameterization', result);
        return {
            ...frame.arrays('hmf_parameterization', result, {
                corner_uv: 6 * triangleCount, transition: 3 * edgeCount, seam: edgeCount, cone: vertexCount,
                dilatation: triangleCount, differential: 2 * triangleCount,
            }),
            ...numbers,
        };
    });
}
