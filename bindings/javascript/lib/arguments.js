// Checks of arguments: each message says what was given and what to give.
// What only the library can judge (ranges, topology) is left to it.

export function described(value) {
    if (value === null || value === undefined) return String(value);
    if (ArrayBuffer.isView(value)) return value[Symbol.toStringTag] ?? 'DataView';
    if (Array.isArray(value)) return 'Array';
    if (typeof value === 'function') return 'a function';
    return typeof value === 'object' ? value.constructor?.name ?? 'object' : `${typeof value} ${String(value)}`;
}

/** The length of an array must be a multiple of group, or exactly count. */
function shaped(value, name, { group = 1, count } = {}) {
    if (count !== undefined && value.length !== count)
        throw new TypeError(`${name} has ${value.length} entries; give ${count}.`);
    if (value.length % group !== 0)
        throw new TypeError(`${name} has ${value.length} entries, not a multiple of ${group}; give ${group} for each element.`);
    return value;
}

/** A typed array of one of these kinds, of any realm, or any array whose entries pass a check. */
function arrayOf(kinds, what, check) {
    return (value, name, shape) => {
        if (ArrayBuffer.isView(value) && kinds.includes(value[Symbol.toStringTag])) return shaped(value, name, shape);
        if (value === null || typeof value !== 'object' || typeof value.length !== 'number')
            throw new TypeError(`${name} is ${described(value)}; give a typed array or an array of ${what}.`);
        for (let i = 0; i < value.length; ++i) check(value[i], `${name}[${i}]`);
        return shaped(value, name, shape);
    };
}

const whole = ['Uint32Array', 'Uint16Array', 'Uint8Array'];

/** Real numbers; Frame.copy converts them. */
export const numbers = arrayOf(['Float64Array', 'Float32Array', 'Int32Array', 'Int16Array', 'Int8Array', ...whole], 'numbers', realNumber);

/** Whole numbers below 2^32. */
export const indices = arrayOf(whole, 'indices', (index, name) => {
    if (!Number.isInteger(index) || index < 0 || index > 0xffffffff) throw new TypeError(`${name} is ${described(index)}; give an index from 0.`);
});

/** A whole number from 0 to 2^53 - 1. */
export function wholeNumber(value, name) {
    if (!Number.isSafeInteger(value) || value < 0) throw new TypeError(`${name} is ${described(value)}; give a whole number from 0.`);
    return value;
}

export function realNumber(value, name) {
    if (typeof value !== 'number') throw new TypeError(`${name} is ${described(value)}; give a number.`);
    return value;
}

export function callback(value, name) {
    if (typeof value !== 'function') throw new TypeError(`${name} is ${described(value)}; give a function.`);
    return value;
}

/** One of the names in a table of namesOf; its value. */
export function choice(value, name, table) {
    if (!table.byName.has(value))
        throw new TypeError(`${name} is ${described(value)}; give one of '${[...table.byName.keys()].join("', '")}'.`);
    return table.byName.get(value);
}

/** The options as an object that has only known keys. */
export function optionsOf(value, name, known) {
    if (value === undefined) return {};
    plainObject(value, name, `any of ${known.join(', ')}`);
    for (const key of Object.keys(value))
        if (!known.includes(key)) throw new TypeError(`${name} has no option '${key}'; there are ${known.join(', ')}.`);
    return value;
}

function plainObject(value, name, fields) {
    if (typeof value !== 'object' || value === null || ArrayBuffer.isView(value) || Array.isArray(value))
        throw new TypeError(`${name} is ${described(value)}; give an object with ${fields}.`);
    return value;
}
