// hmf_quads.
import { optionsOf, realNumber, wholeNumber } from '../arguments.js';
import { option } from '../options.js';

export function quads(foliation, options) {
    const given = optionsOf(options, 'options', ['edgeLength', 'count', 'merge', 'keepPoles', 'relax', 'progress']);
    const fields = {
        merge: given.merge ? 1 : 0, keep_poles: given.keepPoles ? 1 : 0,
        count: option(given, 'count', wholeNumber), relax: option(given, 'relax', wholeNumber), edge_length: option(given, 'edgeLength', realNumber),
    };
    return foliation.perform(given, (frame, address) => {
        const result = frame.result('hmf_quads', address, frame.structure('hmf_quad_options', fields));
        const made = frame.read('hmf_quad_mesh', result);
        const arrays = frame.arrays('hmf_quad_mesh', result, { positions: 3 * made.vertex_count, quads: 4 * made.quad_count });
        return {
            ...arrays,
            irregularCount: made.irregular_count,
            invertedCount: made.inverted_count,
            edgeLength: made.edge_length,
            areaRatio: made.area_ratio,
            distance: made.distance,
        };
    });
}
