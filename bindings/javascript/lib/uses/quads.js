// hmf_quads.
import { optionsOf, realNumber } from '../arguments.js';

export function quads(foliation, options) {
    const given = optionsOf(options, 'options', ['edgeLength', 'progress']), fields = {};
    if (given.edgeLength !== undefined) fields.edge_length = realNumber(given.edgeLength, 'edgeLength');
    return foliation.perform(given, (frame, address) => {
        const result = frame.result('hmf_quads', address, frame.structure('hmf_quad_options', fields));
        const { vertex_count, quad_count } = frame.read('hmf_quad_mesh', result);
        return frame.arrays('hmf_quad_mesh', result, { positions: 3 * vertex_count, quads: 4 * quad_count });
    });
}
