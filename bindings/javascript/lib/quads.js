// Result of hmf_quads.
import { realNumber } from './arguments.js';

export const QUAD_OPTIONS = ['edgeLength'];

/** hmf_quads on a level: once to count, once to fill. */
export function quads(frame, hierarchy, level, values, options) {
    const fields = {};
    if (options.edgeLength !== undefined) fields.edge_length = realNumber(options.edgeLength, 'edgeLength');
    const settings = frame.structure('hmf_quad_options', fields), valuesAt = frame.copy(values), counts = frame.room(Uint32Array, 2);
    const call = (...arrays) => frame.call('hmf_quads', hierarchy, level, valuesAt, values.length, settings, ...arrays, counts, counts + 4);
    call(0, 0, 0, 0);
    const [vertexCount, quadCount] = frame.result(Uint32Array, counts, 2);
    const positions = frame.room(Float64Array, 3 * vertexCount), corners = frame.room(Uint32Array, 4 * quadCount);
    call(positions, vertexCount, corners, quadCount);
    return { positions: frame.result(Float64Array, positions, 3 * vertexCount), quads: frame.result(Uint32Array, corners, 4 * quadCount) };
}
