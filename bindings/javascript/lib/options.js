// Options that are numbers: fields of a structure of the headers, in camelCase.
import { options, structures } from '../dist/layout.js';
import { realNumber, wholeNumber } from './arguments.js';
import { camel } from './memory.js';

export const optionNames = name => options[name].map(camel);

/** The fields of those that are given, checked. */
export function optionFields(name, given) {
    const fields = {};
    for (const field of options[name]) {
        const key = camel(field), check = structures[name].fields[field].type === 'f64' ? realNumber : wholeNumber;
        if (given[key] !== undefined) fields[field] = check(given[key], key);
    }
    return fields;
}
