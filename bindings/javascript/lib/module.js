// A loaded WebAssembly module: where its bytes come from, what it imports, and
// how its functions are called.
import { readText } from './memory.js';
import { HmfError, inWords } from './error.js';
import { callback } from './arguments.js';
import { constants } from '../dist/layout.js';

const WASI_SUCCESS = 0;

/** Bytes, module, address or response -> compiled module. */
async function compile(source) {
    source = await source;
    if (Object.prototype.toString.call(source) === '[object WebAssembly.Module]') return source;
    if (source === undefined) source = new URL('../dist/hmf.wasm', import.meta.url);
    if (typeof source === 'string') source = new URL(source, globalThis.document?.baseURI ?? globalThis.location?.href ?? import.meta.url);
    if (source instanceof URL) {
        // fetch of Node reads no file: addresses.
        if (source.protocol === 'file:') {
            // Not a literal, so that bundlers for browsers leave it alone.
            const files = 'node:fs/promises';
            const { readFile } = await import(/* webpackIgnore: true */ /* @vite-ignore */ files);
            source = await readFile(source);
        } else {
            source = await fetch(source);
        }
    }
    if (typeof Response !== 'undefined' && source instanceof Response) {
        if (!source.ok) throw new Error(`hmf.wasm could not be loaded: ${source.status} ${source.statusText} from ${source.url}. Pass its address, its bytes or a compiled module to load().`);
        source = await source.arrayBuffer(); // not compileStreaming: it needs a server that knows the type application/wasm
    }
    if (ArrayBuffer.isView(source) || Object.prototype.toString.call(source) === '[object ArrayBuffer]') return WebAssembly.compile(source);
    throw new TypeError('load() takes nothing, an address (string or URL), the bytes of hmf.wasm, a WebAssembly.Module or a Response.');
}

export class Module {
    /** The exception of a trap: no function may be called any more. */
    broken = null;
    /** The WebAssembly.Memory, and the addresses of the counted allocator as fields of the build options. */
    memory = null;
    allocators = null;
    /** Progress functions of the calls that run: one may call others with other objects. */
    #callbacks = new Map();
    #next = 1;
    #output = '';
    #exports;
    #bytes = null;
    #view = null;

    static async load(source) {
        const module = new Module();
        const instance = await WebAssembly.instantiate(await compile(source), module.#imports());
        module.#exports = instance.exports;
        module.memory = instance.exports.memory;
        if (typeof module.#exports.hmf_js_take !== 'function') throw new TypeError('This WebAssembly module is not the hmf.wasm of this package.');
        module.invoke('_initialize');
        module.allocators = { allocate: module.invoke('hmf_js_allocate_fn'), release: module.invoke('hmf_js_release_fn') };
        return module;
    }

    #imports() {
        return {
            hmf: { progress: (callback, fraction) => this.#progress(callback, fraction) },
            wasi_snapshot_preview1: {
                // The steady clock, for the seconds of reports and time limits.
                clock_time_get: (_clock, _precision, address) => {
                    this.view.setBigUint64(address >>> 0, BigInt(Math.round(performance.now() * 1e6)), true);
                    return WASI_SUCCESS;
                },
                // The C library writes only before it aborts; the text becomes part of the Error.
                fd_write: (_file, vectors, count, written) => {
                    let total = 0;
                    for (let i = 0; i < count; ++i) {
                        const at = (vectors >>> 0) + 8 * i;
                        const start = this.view.getUint32(at, true), length = this.view.getUint32(at + 4, true);
                        this.#output += readText(this, start, length);
                        total += length;
                    }
                    this.view.setUint32(written >>> 0, total, true);
                    return WASI_SUCCESS;
                },
                fd_close: () => WASI_SUCCESS,
                fd_seek: () => WASI_SUCCESS,
            },
        };
    }

    // Views of the memory, made again whenever it has grown.
    get bytes() {
        if (this.#bytes?.buffer !== this.memory.buffer) this.#bytes = new Uint8Array(this.memory.buffer);
        return this.#bytes;
    }

    get view() {
        if (this.#view?.buffer !== this.memory.buffer) this.#view = new DataView(this.memory.buffer);
        return this.#view;
    }

    /** Calls an export.  A trap leaves the memory in an unknown state: the module refuses all later calls. */
    invoke(name, ...parameters) {
        if (this.broken)
            throw new Error(`hmf stopped in an earlier call (${this.broken.message}) and cannot be used any more. Load it again with load().`, { cause: this.broken });
        try {
            return this.#exports[name](...parameters);
        } catch (cause) {
            this.broken = cause;
            const text = this.#output.trim();
            throw new Error(`hmf stopped in ${name}: ${cause.message}${text ? ` (${text})` : ''}. This is a defect of the library, please report it. Load it again with load().`, { cause });
        }
    }

    /**
     * Runs work(fields), with fields of hmf_control that make the library call
     * the given function, or null without one.
     */
    withProgress(progress, work) {
        if (progress === undefined) return work(null);
        const entry = { callback: callback(progress, 'progress'), failed: false, exception: undefined };
        const id = this.#next;
        this.#next = (this.#next + 1) >>> 0 || 1;
        this.#callbacks.set(id, entry);
        let result;
        try {
            result = work({ progress: this.invoke('hmf_js_progress_fn'), progress_user: id });
        } catch (error) {
            // The cancellation was our answer to the exception.
            throw entry.failed && !this.broken ? entry.exception : error;
        } finally {
            this.#callbacks.delete(id);
        }
        if (!entry.failed) return result;
        result?.discard?.(); // it threw in its last call, when the foliation was there
        throw entry.exception;
    }

    // An exception must not pass through the module: it would leave it half way.
    #progress(id, fraction) {
        const entry = this.#callbacks.get(id >>> 0);
        try {
            if (entry.failed) return constants.HMF_PROGRESS_CANCEL;
            const answer = entry.callback(fraction);
            if (answer === undefined || answer === 'continue') return constants.HMF_PROGRESS_CONTINUE;
            if (answer === 'cancel') return constants.HMF_PROGRESS_CANCEL;
            if (answer === 'finish') return constants.HMF_PROGRESS_FINISH;
            throw new TypeError(`progress returned ${String(answer)}; return nothing, 'continue', 'cancel' or 'finish'.`);
        } catch (exception) {
            entry.failed = true;
            entry.exception = exception;
            return constants.HMF_PROGRESS_CANCEL;
        }
    }

    exportNames() {
        return Object.keys(this.#exports);
    }

    statusText(status) {
        return readText(this, this.invoke('hmf_status_string', status) >>> 0);
    }

    error(status, element, index, advice) {
        return new HmfError(status, this.statusText(status), element, index, inWords(advice));
    }

    outOfMemory(size) {
        return this.error(constants.HMF_ERROR_MEMORY, constants.HMF_ELEMENT_NONE, 0,
            `The WebAssembly memory has no room for ${size} more bytes. Free hierarchies with dispose(), or use a smaller mesh.`);
    }
}
