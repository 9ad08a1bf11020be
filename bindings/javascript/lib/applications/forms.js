// hmf_harmonic_forms.
import { optionsOf } from '../arguments.js';

export function harmonicForms(hierarchy, options) {
    const given = optionsOf(options, 'options', ['level', 'progress']), level = hierarchy.levelIndex(given.level ?? 0);
    return hierarchy.perform(given, (frame, address) => {
        const result = frame.result('hmf_harmonic_forms', address, level);
        const { formCount, edgeCount, genus, ...numbers } = frame.plain('hmf_form_set', result);
        const forms = formCount * formCount, periods = genus * genus;
        return {
            formCount, edgeCount, genus, ...numbers,
            ...frame.arrays('hmf_form_set', result, {
                values: formCount * edgeCount, intersections: forms, inner_products: forms, conjugation: forms,
                period_real: periods, period_imaginary: periods,
            }),
        };
    });
}
