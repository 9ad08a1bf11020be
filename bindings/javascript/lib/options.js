// Options that are numbers: fields of a structure of the headers, in camelCase.
import { constants, options, structures } from '../dist/layout.js';
import { realNumber, wholeNumber } from './arguments.js';
import { HmfError } from './error.js';
import { camel } from './memory.js';

export const optionNames = name => options[name].map(camel);

// The library takes 0 for "the default", which here is to leave the option out.
const ranges = {
    ratio: '[0.05, 0.95]', mollify: '[0, 0.1]', coarsest: '[1, inf)', memoryLimit: '[1, inf)',
    tolerance: '(0, 1)', energyTolerance: '(0, 1)', timeLimit: '[0, inf)', iterationLimit: '[1, inf)', stepLimit: '[1, inf)',
    solveLimit: '[1, inf)', margin: '(0, 0.0625]', edgeLength: '(0, inf)', count: '[1, inf)', spacing: '(0, inf)', lengthLimit: '(0, inf)',
};
const shortest = 1e-9; // seconds; the library takes a limit of 0 for none

function checkRange(value, name) {
    const range = ranges[name];
    if (range === undefined) return;
    const [low, high] = range.slice(1, -1).split(',').map(word => (word.trim() === 'inf' ? Infinity : Number(word)));
    const above = range[0] === '(' ? value > low : value >= low, below = range.endsWith(')') ? value < high : value <= high;
    if (!above || !below)
        throw new HmfError(constants.HMF_ERROR_OPTIONS, 'an option is out of range', constants.HMF_ELEMENT_OPTION, 0,
            `${name}: ${value} is not in ${range}. Leave it out for the default.`);
}

/** One that is given, checked; others are left to the library. */
export function option(given, name, check) {
    const value = given[name] === undefined ? undefined : check(given[name], name);
    if (value !== undefined) checkRange(value, name);
    return value ?? 0;
}

/** The fields of those that are given, checked. */
export function optionFields(name, given) {
    const fields = {};
    for (const field of options[name]) {
        const key = camel(field);
        if (given[key] === undefined) continue;
        fields[field] = option(given, key, structures[name].fields[field].type === 'f64' ? realNumber : wholeNumber);
        if (key === 'timeLimit') fields[field] = Math.max(given[key], shortest);
    }
    return fields;
}
