// The memory of the module as one call sees it: blocks that live as long as
// the call, structures of hmf.h, copies of typed arrays in and out.
import { structures } from '../dist/layout.js';

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
const writers = {
    u32: (view, at, value) => view.setUint32(at, value, true),
    i32: (view, at, value) => view.setInt32(at, value, true),
    u64: (view, at, value) => view.setBigUint64(at, BigInt(value), true),
    i64: (view, at, value) => view.setBigInt64(at, BigInt(value), true),
    f64: (view, at, value) => view.setFloat64(at, value, true),
    pointer: (view, at, value) => view.setUint32(at, value, true),
};

/** Blocks of one call; close() gives them back, whatever happened. */
export class Frame {
    #module;
    #blocks = [];

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
        while (this.#blocks.length && !this.#module.broken) {
            const size = this.#blocks.pop(), address = this.#blocks.pop();
            this.#module.invoke('hmf_js_give', address, size);
        }
    }

    /** A block with a copy of a typed array. */
    copy(array) {
        const address = this.take(array.byteLength);
        new array.constructor(this.#module.memory.buffer, address, array.length).set(array);
        return address;
    }

    /** Room for count elements of a typed array. */
    room(Type, count) {
        return this.take(count * Type.BYTES_PER_ELEMENT);
    }

    /** A copy of what lies in such a block, owned by JavaScript. */
    result(Type, address, count) {
        return new Type(this.#module.memory.buffer, address, count).slice();
    }

    /** A structure, zero but for struct_size and the given fields; several in a row with count. */
    structure(name, fields = {}, count = 1) {
        const { size } = structures[name];
        const address = this.take(size * count);
        this.#module.bytes.fill(0, address, address + size * count);
        if (structures[name].fields.struct_size) this.write(name, address, { struct_size: size });
        this.write(name, address, fields);
        return address;
    }

    write(name, address, fields) {
        const view = this.#module.view;
        for (const [key, value] of Object.entries(fields)) {
            const { offset, type } = structures[name].fields[key];
            writers[type](view, address + offset, value);
        }
    }

    /** All fields of a structure; index counts structures in a row. */
    read(name, address, index = 0) {
        const { size, fields } = structures[name];
        const view = this.#module.view, start = address + index * size;
        const result = {};
        for (const [key, { offset, type }] of Object.entries(fields))
            result[key] = type.startsWith('text') ? readText(this.#module, start + offset, Number(type.slice(4))) : readers[type](view, start + offset);
        return result;
    }

    /**
     * A function of hmf.h with status and error.  Returns the status when it
     * is below 100 (success, a limit, cancelled); throws an HmfError otherwise.
     */
    call(name, ...parameters) {
        const error = this.structure('hmf_error');
        const status = this.#module.invoke(name, ...parameters, error);
        if (status >= 100) throw this.error(status, error);
        this.lastError = error;
        return status;
    }

    /** The HmfError of a status of the last call. */
    error(status, address = this.lastError) {
        const { element, index, message } = this.read('hmf_error', address);
        return this.#module.error(status, element, index, message);
    }
}
