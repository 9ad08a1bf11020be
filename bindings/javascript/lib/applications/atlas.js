// hmf_atlas.
import { optionsOf, realNumber } from '../arguments.js';
import { option } from '../options.js';

export function atlas(foliation, options) {
    const given = optionsOf(options, 'options', ['margin', 'progress']);
    const fields = { margin: option(given, 'margin', realNumber) };
    return foliation.perform(given, (frame, address) => {
        const result = frame.result('hmf_atlas', address, frame.structure('hmf_atlas_options', fields));
        const { triangleCount, ...numbers } = frame.plain('hmf_chart_set', result);
        return {
            ...frame.arrays('hmf_chart_set', result, { corner_uv: 6 * triangleCount, triangle_chart: triangleCount }),
            ...numbers,
        };
    });
}
