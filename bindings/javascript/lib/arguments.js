// Checks of arguments: each message says what was given and what to give.
// What only the library can judge (ranges, topology) is left to it.

function described(value) {
    if (value === null || value === undefined) return String(value);
    if (ArrayBuffer.isView(value)) return value[Symbol.toStringTag] ?? 'DataView';
    if (Array.isArray(value)) return 'Array';
    if (typeof value === 'function') return 'a function';
    return typeof value === 'object' ? value.constructor?.name ?? 'object' : `${typeof value} ${String(value)}`;
}

/** A typed array of one class, of any realm; its length a multiple of group or exactly count. */
export function typedArray(value, Type, name, { group = 1, count } = {}) {
    if (!ArrayBuffer.isView(value) || value[Symbol.toStringTag] !== Type.name)
        throw new TypeError(`${name} is ${described(value)}; give a ${Type.name}, for example ${Type.name}.from(${name}).`);
    if (count !== undefined && value.length !== count)
        throw new TypeError(`${name} has ${value.length} entries; give ${count}.`);
    if (value.length % group !== 0)
        throw new TypeError(`${name} has ${value.length} entries, not a multiple of ${group}; give ${group} for each element.`);
    return value;
}

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

/** An object whose fields are checked one by one; more of them are allowed. */
export function plainObject(value, name, fields) {
    if (typeof value !== 'object' || value === null || ArrayBuffer.isView(value) || Array.isArray(value))
        throw new TypeError(`${name} is ${described(value)}; give an object with ${fields}.`);
    return value;
}

/** Whole numbers below 2^32 in a typed array or an ordinary one. */
export function indices(value, name) {
    if (ArrayBuffer.isView(value) && value[Symbol.toStringTag] === 'Uint32Array') return value;
    if (value === null || typeof value !== 'object' || typeof value.length !== 'number')
        throw new TypeError(`${name} is ${described(value)}; give an array of indices.`);
    return Uint32Array.from(value, (index, i) => {
        if (!Number.isInteger(index) || index < 0 || index > 0xffffffff)
            throw new TypeError(`${name}[${i}] is ${described(index)}; give an index from 0.`);
        return index;
    });
}

export function numbers(value, name) {
    if (ArrayBuffer.isView(value) && value[Symbol.toStringTag] === 'Float64Array') return value;
    if (value === null || typeof value !== 'object' || typeof value.length !== 'number')
        throw new TypeError(`${name} is ${described(value)}; give an array of numbers.`);
    return Float64Array.from(value, (number, i) => realNumber(number, `${name}[${i}]`));
}
