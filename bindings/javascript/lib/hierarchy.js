// Hierarchy: a mesh with its coarser levels (hmf_build and what reads it).
import { Frame } from './memory.js';
import { Foliation } from './foliation.js';
import { namesOf } from './error.js';
import { callback, choice, optionsOf, realNumber, typedArray, wholeNumber } from './arguments.js';
import { levelOf, makeLoops, writeLoops } from './loops.js';
import { OPTIMISE_OPTIONS, readReport, valuesWritten, writeInitial, writeOptions, writeReport } from './solve.js';

const BUILD_OPTIONS = ['collapse', 'ratio', 'coarsest', 'mollify', 'memoryLimit', 'progress'];
const collapses = namesOf('HMF_COLLAPSE_');

/** Symbol.dispose, also where the engine has none yet. */
const dispose = Symbol.dispose ?? Symbol.for('Symbol.dispose');

// A safety net for hierarchies that nobody disposed of.
const forgotten = new FinalizationRegistry(({ module, address }) => {
    if (!module.broken) module.invoke('hmf_destroy', address);
});

function writeBuildOptions(frame, options, more = {}) {
    const fields = { ...frame.module.allocators, ...more };
    if (options.collapse !== undefined) fields.collapse = choice(options.collapse, 'collapse', collapses);
    if (options.ratio !== undefined) fields.ratio = realNumber(options.ratio, 'ratio');
    if (options.coarsest !== undefined) fields.coarsest = wholeNumber(options.coarsest, 'coarsest');
    if (options.mollify !== undefined) fields.mollify = realNumber(options.mollify, 'mollify');
    if (options.memoryLimit !== undefined) fields.memory_limit = wholeNumber(options.memoryLimit, 'memoryLimit');
    if (options.progress !== undefined) callback(options.progress, 'progress');
    return frame.structure('hmf_build_options', fields);
}

export function memoryEstimate(module, vertexCount, triangleCount, options) {
    wholeNumber(vertexCount, 'vertexCount');
    wholeNumber(triangleCount, 'triangleCount');
    // size_t of the module has 32 bits; larger meshes are unusable, as the library says with 0.
    if (vertexCount > 0xffffffff || triangleCount > 0xffffffff) return 0;
    const frame = new Frame(module);
    try {
        const address = writeBuildOptions(frame, optionsOf(options, 'options', BUILD_OPTIONS));
        return Number(BigInt.asUintN(64, module.invoke('hmf_memory_estimate', vertexCount, triangleCount, address)));
    } finally {
        frame.close();
    }
}

export class Hierarchy {
    #module;
    #address = 0;
    #busy = false;
    #levels;

    constructor(module, positions, triangles, options) {
        typedArray(positions, Float64Array, 'positions', { group: 3 });
        typedArray(triangles, Uint32Array, 'triangles', { group: 3 });
        const given = optionsOf(options, 'options', BUILD_OPTIONS);
        this.#module = module;
        const frame = new Frame(module);
        try {
            const out = frame.room(Uint32Array, 1);
            module.withProgress(given.progress, fields => {
                const address = writeBuildOptions(frame, given, fields);
                const status = frame.call('hmf_build', frame.copy(positions), positions.length / 3, 0,
                    frame.copy(triangles), triangles.length / 3, address, out);
                if (status !== 0) throw frame.error(status);
                this.#address = frame.result(Uint32Array, out, 1)[0];
                // Registered here: the callback may have thrown in its last call.
                forgotten.register(this, { module, address: this.#address }, this);
            });
            const count = module.invoke('hmf_level_count', this.#address);
            this.#levels = Object.freeze(Array.from({ length: count }, (_, index) => new Level(this, index, this.#counts(frame, index))));
            this.genus = module.invoke('hmf_genus', this.#address);
            Object.defineProperty(this, 'genus', { writable: false });
        } catch (error) {
            this.dispose();
            throw error;
        } finally {
            frame.close();
        }
    }

    #counts(frame, index) {
        const out = frame.structure('hmf_level_info');
        frame.call('hmf_level_counts', this.#address, index, out);
        return frame.read('hmf_level_info', out);
    }

    get levels() {
        return this.#levels;
    }

    get memoryBytes() {
        return this.perform((frame, address) => Number(BigInt.asUintN(64, frame.module.invoke('hmf_hierarchy_memory', address))));
    }

    get disposed() {
        return this.#address === 0;
    }

    dispose() {
        if (this.#address === 0) return;
        this.#refuseWhenBusy();
        forgotten.unregister(this);
        const address = this.#address;
        this.#address = 0;
        if (!this.#module.broken) this.#module.invoke('hmf_destroy', address);
    }

    [dispose]() {
        this.dispose();
    }

    #refuseWhenBusy() {
        if (this.#busy) throw new Error('This hierarchy is in use by the call whose progress callback is running. Use it after that call.');
    }

    /** Internal: runs work(frame, address) and gives back what it took. */
    perform(work) {
        this.#refuseWhenBusy();
        if (this.#address === 0) throw new Error('This hierarchy has been disposed of. Build it again with new Hierarchy(positions, triangles).');
        const frame = new Frame(this.#module);
        this.#busy = true;
        try {
            return work(frame, this.#address);
        } finally {
            this.#busy = false;
            frame.close();
        }
    }

    /** Internal: the index of a level, checked. */
    levelIndex(level, name = 'level') {
        wholeNumber(level, name);
        if (level >= this.#levels.length) throw new TypeError(`${name} is ${level}; give a number below ${this.#levels.length}, the number of levels.`);
        return level;
    }

    loops(options) {
        const { kind = 'cut', level = this.#levels.length - 1 } = optionsOf(options, 'options', ['kind', 'level']);
        return this.perform((frame, address) => makeLoops(frame, address, this.levelIndex(level), kind));
    }

    initialize(loops) {
        return this.perform((frame, address) => {
            const set = writeLoops(frame, loops);
            const level = this.levelIndex(levelOf(loops, this.#levels.length - 1), 'loops.level');
            const count = this.#levels[level].edgeCount;
            const values = frame.room(Float64Array, count);
            frame.call('hmf_initialize', address, set, values, count);
            return new Foliation(this, level, frame.result(Float64Array, values, count), null);
        });
    }

    solve(options) {
        const given = optionsOf(options, 'options', [...OPTIMISE_OPTIONS, 'loops', 'initial', 'stopLevel']);
        const level = this.levelIndex(given.stopLevel ?? 0, 'stopLevel');
        return this.perform((frame, address) => frame.module.withProgress(given.progress, fields => {
            const set = writeLoops(frame, given.loops);
            const settings = writeOptions(frame, given, { ...fields, ...writeInitial(frame, given.initial), stop_level: level });
            const report = writeReport(frame, this.#levels.length, given);
            const count = this.#levels[level].edgeCount;
            const values = frame.room(Float64Array, count);
            const status = frame.call('hmf_solve', address, set, settings, values, count, report);
            if (!valuesWritten(frame, report)) throw frame.error(status);
            return new Foliation(this, level, frame.result(Float64Array, values, count), readReport(frame, report, status));
        }));
    }

    foliation(values, level = 0) {
        this.levelIndex(level);
        typedArray(values, Float64Array, 'values', { count: this.#levels[level].edgeCount });
        return new Foliation(this, level, values.slice(), null);
    }
}

/** One level: its counts, and its arrays as fresh copies. */
export class Level {
    #hierarchy;

    constructor(hierarchy, index, counts) {
        this.#hierarchy = hierarchy;
        this.index = index;
        this.vertexCount = counts.vertex_count;
        this.edgeCount = counts.edge_count;
        this.triangleCount = counts.triangle_count;
        this.nonDelaunayCount = counts.non_delaunay_count;
        Object.freeze(this);
    }

    #array(name, Type, count) {
        return this.#hierarchy.perform((frame, address) => {
            const room = frame.room(Type, count);
            frame.call(name, address, this.index, room, count);
            return frame.result(Type, room, count);
        });
    }

    edgeVertices() {
        return this.#array('hmf_level_edge_vertices', Uint32Array, 2 * this.edgeCount);
    }

    triangleEdges() {
        return this.#array('hmf_level_triangle_edges', Uint32Array, 3 * this.triangleCount);
    }

    triangleVertices() {
        return this.#array('hmf_level_triangle_vertices', Uint32Array, 3 * this.triangleCount);
    }

    weights() {
        return this.#array('hmf_level_weights', Float64Array, this.edgeCount);
    }

    positions() {
        return this.#array('hmf_level_positions', Float64Array, 3 * this.vertexCount);
    }
}
