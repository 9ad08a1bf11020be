// The memory of the module as one call sees it: blocks that live as long as
// the call, structures of the headers, copies of arrays in and out, results of the library.
import { constants, functions, structures } from '../dist/layout.js';

const decoder = new TextDecoder();

/** The text that ends with 0 at an address. */
export function readText(module, address, limit = 4096) {
    const bytes = module.bytes;
    let end = address;
    while (end < bytes.length && end < address + limit && bytes[end] !== 0) ++end;
    // A copy: a decoder refuses views of shared memory.
    return decoder.decode(bytes.slice(address, end));
}

const readers = {
    u32: (view, at) => view.getUint32(at, true),
    i32: (view, at) => view.getInt32(at, true),
    u64: (view, at) => Number(view.getBigUint64(at, true)),
    i64: (view, at) => Number(view.getBigInt64(at, true)),
    f64: (view, at) => view.getFloat64(at, true),
    pointer: (view, at) => view.getUint32(at, true),
};
const arrays = { Float64Array, Uint8Array, Int32Array, Uint32Array, BigUint64Array };
const writers = {
    u32: (view, at, value) => view.setUint32(at, value, true),
    i32: (view, at, value) => view.setInt32(at, value, true),
    u64: (view, at, value) => view.setBigUint64(at, BigInt(value), true),
    i64: (view, at, value) => view.setBigInt64(at, BigInt(value), true),
    f64: (view, at, value) => view.setFloat64(at, value, true),
    pointer: (view, at, value) => view.setUint32(at, value, true),
};

/** Fields of C alone. */
const internal = ['struct_size', 'reserved'];
export const camel = name => name.replace(/_([a-z])/g, (_, letter) => letter.toUpperCase());

/** An index, or null for HMF_NONE. */
export const orNull = index => (index === constants.HMF_NONE ? null : index);

/** Blocks of one call; close() gives them back, whatever happened. */
export class Frame {
    #module;
    #blocks = [];
    #results = [];
    #error;
    /** The hmf_control of the call; 0 (NULL) without a progress function. */
    control = 0;

    constructor(module) {
        this.#module = module;
    }

    get module() {
        return this.#module;
    }

    /** A block of bytes, aligned for every type. */
    take(size) {
        // size_t of the module has 32 bits; a larger number would wrap round.
        const address = size > 0xffffffff ? 0 : this.#module.invoke('hmf_js_take', size) >>> 0;
        if (address === 0) throw this.#module.outOfMemory(size);
        this.#blocks.push(address, size);
        return address;
    }

    close() {
        while (this.#results.length && !this.#module.broken) this.#module.invoke('hmf_free', this.#results.pop());
        while (this.#blocks.length && !this.#module.broken) {
            const size = this.#blocks.pop(), address = this.#blocks.pop();
            this.#module.invoke('hmf_js_give', address, size);
        }
    }

    /** A block with a copy of an array as typed array of a class. */
    copy(Type, array) {
        const address = this.room(Type, array.length);
        new Type(this.#module.memory.buffer, address, array.length).set(array);
        return address;
    }

    /** Room for count elements of a typed array. */
    room(Type, count) {
        return this.take(count * Type.BYTES_PER_ELEMENT);
    }

    /** A copy of what lies there, owned by JavaScript. */
    array(Type, address, count) {
        return new Type(this.#module.memory.buffer, address, count).slice();
    }

    /** A structure with its defaults and the given fields; several in a row with count. */
    structure(name, fields = {}, count = 1) {
        const { size } = structures[name];
        const address = this.take(size * count);
        this.#module.bytes.fill(0, address, address + size * count);
        if (functions.includes(`${name}_init`)) this.#module.invoke(`${name}_init`, address, size);
        else if (structures[name].fields.struct_size) this.write(name, address, { struct_size: size });
        this.write(name, address, fields);
        return address;
    }

    write(name, address, fields) {
        const view = this.#module.view;
        for (const [key, value] of Object.entries(fields)) {
            const { offset, type } = structures[name].fields[key];
            (writers[type] ?? writers.pointer)(view, address + offset, value);
        }
    }

    /** All fields of a structure; those that point to arrays are addresses. */
    read(name, address) {
        const view = this.#module.view, result = {};
        for (const [key, { offset, type }] of Object.entries(structures[name].fields)) {
            const at = address + offset;
            if (type.startsWith('text')) result[key] = readText(this.#module, at, Number(type.slice(4)));
            else if (type.startsWith('row')) result[key] = Array.from(this.array(Float64Array, at, Number(type.slice(3))));
            else result[key] = (readers[type] ?? readers.pointer)(view, at);
        }
        return result;
    }

    /** A structure as JavaScript has it: camelCase, and no pointers. */
    plain(name, address) {
        return Object.fromEntries(Object.entries(this.read(name, address))
            .filter(([key]) => !internal.includes(key) && !/Array$|^pointer$/.test(structures[name].fields[key].type))
            .map(([key, value]) => [camel(key), value]));
    }

    /** count structures in a row. */
    list(name, address, count) {
        return Array.from({ length: count }, (_, i) => this.plain(name, address + i * structures[name].size));
    }

    /** Copies of arrays of a structure, in camelCase; counts says how many entries each has. */
    arrays(name, address, counts) {
        const { fields } = structures[name], pointers = this.read(name, address);
        return Object.fromEntries(Object.entries(counts).map(([key, count]) =>
            [camel(key), count === 0 ? new arrays[fields[key].type]() : this.array(arrays[fields[key].type], pointers[key], count)]));
    }

    /**
     * A function of the headers with status and error.  Returns the status when
     * it is below 100 (success, a limit, cancelled); throws an HmfError otherwise.
     */
    call(name, ...parameters) {
        this.#error = this.structure('hmf_error');
        const status = this.#module.invoke(name, ...parameters, this.#error);
        if (status >= 100) throw this.error(status);
        return status;
    }

    /** The same for a call that gives nothing when it is cancelled. */
    finish(name, ...parameters) {
        const status = this.call(name, ...parameters);
        if (status !== 0) throw this.error(status);
    }

    /** Calls a function that makes an object; its address, and a status below 100. */
    make(name, ...parameters) {
        const out = this.copy(Uint32Array, [0]);
        const status = this.call(name, ...parameters, this.control, out);
        const address = this.#module.view.getUint32(out, true);
        if (address === 0) throw this.error(status);
        return { address, status };
    }

    /** Calls a function that makes a result; its address, which is valid until close(). */
    result(name, ...parameters) {
        const { address } = this.make(name, ...parameters);
        this.#results.push(address);
        return address;
    }

    /** The HmfError of a status of the last call. */
    error(status) {
        const { element, index, message } = this.read('hmf_error', this.#error);
        return this.#module.error(status, element, index, message);
    }
}
