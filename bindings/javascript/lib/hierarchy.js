// Hierarchy: a mesh with its coarser levels (hmf_hierarchy_create and what reads it).
import { Frame, camel } from './memory.js';
import { Foliation, classOf, dispose } from './foliation.js';
import { boundaryCurves, holeWarning, notClosed, withoutUnused } from './boundaries.js';
import { namesOf } from './error.js';
import { callback, choice, described, indices, numbers, optionsOf, wholeNumber } from './arguments.js';
import { keptLoops, makeLoops, readLoops, writeLoops } from './loops.js';
import { option, optionFields, optionNames } from './options.js';
import { loopsThrough } from './picked.js';
import { SOLVE_OPTIONS, writeOptions } from './solve.js';

export const BUILD_OPTIONS = ['collapse', ...optionNames('hmf_hierarchy_options'), 'markedVertices', 'progress'];
const HIERARCHY_OPTIONS = [...BUILD_OPTIONS, 'closed', 'warn'];
const collapses = namesOf('HMF_COLLAPSE_');

const pickOf = (object, names) => Object.fromEntries(Object.entries(object).filter(([name]) => names.includes(name)));

/** A hierarchy and its foliations in the memory of the module. */
class Held {
    foliations = new Set();

    constructor(module, address) {
        this.module = module;
        this.address = address;
    }

    free(foliation) {
        if (this.foliations.delete(foliation) && !this.module.broken) this.module.invoke('hmf_foliation_destroy', foliation);
    }

    freeAll() {
        for (const foliation of this.foliations) this.free(foliation);
        if (this.address !== 0 && !this.module.broken) this.module.invoke('hmf_hierarchy_destroy', this.address);
        this.address = 0;
    }
}

// A safety net for what nobody disposed of.
const forgotten = new FinalizationRegistry(({ held, foliation }) => (foliation === undefined ? held.freeAll() : held.free(foliation)));

function writeBuildOptions(frame, options) {
    const fields = { ...frame.module.allocators, ...optionFields('hmf_hierarchy_options', options) };
    if (options.collapse !== undefined) fields.collapse = choice(options.collapse, 'collapse', collapses);
    if (options.markedVertices !== undefined) {
        fields.marked_count = indices(options.markedVertices, 'markedVertices').length;
        fields.marked_vertices = frame.copy(Uint32Array, options.markedVertices);
    }
    return frame.structure('hmf_hierarchy_options', fields);
}

/** Positions, triangles and options of a build, checked; work(frame, ...parameters) gives them to hmf_hierarchy_create and its like. */
export function withMesh(module, positions, triangles, options, work) {
    numbers(positions, 'positions', { group: 3 });
    indices(triangles, 'triangles', { group: 3 });
    const given = optionsOf(options, 'options', BUILD_OPTIONS);
    return withFrame(module, given, frame => {
        const settings = writeBuildOptions(frame, given), points = frame.copy(Float64Array, positions), corners = frame.copy(Uint32Array, triangles);
        return work(frame, points, positions.length / 3, corners, triangles.length / 3, settings);
    });
}

/** Runs work(frame) with the progress function of options, and frees the memory of the frame. */
function withFrame(module, options, work) {
    const frame = new Frame(module);
    try {
        return module.withProgress(options.progress, fields => {
            if (fields) frame.control = frame.structure('hmf_control', fields);
            return work(frame);
        });
    } finally {
        frame.close();
    }
}

export function memoryEstimate(module, vertexCount, triangleCount, options) {
    wholeNumber(vertexCount, 'vertexCount');
    wholeNumber(triangleCount, 'triangleCount');
    // size_t of the module has 32 bits; larger meshes are unusable, as the library says with 0.
    if (vertexCount > 0xffffffff || triangleCount > 0xffffffff) return 0;
    const { progress, ...given } = optionsOf(options, 'options', BUILD_OPTIONS);
    return withFrame(module, {}, frame =>
        Number(BigInt.asUintN(64, module.invoke('hmf_hierarchy_memory_estimate', vertexCount, triangleCount, writeBuildOptions(frame, given)))));
}

export function suggestMarks(module, positions, triangles, options) {
    return withMesh(module, positions, triangles, options, (frame, ...mesh) => {
        const result = frame.result('hmf_suggest_marks', ...mesh);
        return frame.arrays('hmf_mark_set', result, { marked_vertices: frame.read('hmf_mark_set', result).marked_count }).markedVertices;
    });
}

export function evenDesign(module, positions, triangles, options) {
    const { noPoles, solveLimit, ...build } = optionsOf(options, 'options', [...BUILD_OPTIONS, 'noPoles', 'solveLimit']);
    const limit = option({ solveLimit }, 'solveLimit', wholeNumber);
    return withMesh(module, positions, triangles, build, (frame, points, pointCount, corners, cornerCount, settings) => {
        const fields = { build: settings, no_poles: noPoles ? 1 : 0, solve_limit: limit };
        const result = frame.result('hmf_even_design', points, pointCount, corners, cornerCount, frame.structure('hmf_design_options', fields));
        const { marked_count, loops, unevenness, unevenness_before, solves } = frame.read('hmf_design', result);
        return {
            markedVertices: frame.arrays('hmf_design', result, { marked_vertices: marked_count }).markedVertices,
            loops: readLoops(frame, loops), unevenness, unevennessBefore: unevenness_before, solves,
        };
    });
}

export class Hierarchy {
    #held;
    #busy = false;
    #info;
    #levels;
    #marks;
    #kept = null;

    constructor(module, positions, triangles, options) {
        this.#held = new Held(module, 0);
        forgotten.register(this, { held: this.#held }, this);
        try {
            const { closed, warn = sentence => console.warn(sentence), ...build } = optionsOf(options, 'options', HIERARCHY_OPTIONS);
            callback(warn, 'warn');
            if (typeof build.markedVertices === 'string' && build.markedVertices !== 'suggest')
                throw new TypeError(`markedVertices is '${build.markedVertices}'; give 'suggest', or vertices.`);
            const warnings = this.#buildUsed(positions, triangles, build);
            const constant = fields => Object.entries(fields).forEach(([name, value]) => Object.defineProperty(this, name, { value, enumerable: true }));
            constant({ boundaryCount: this.#info.boundary_count, genus: this.#info.genus });
            if (this.boundaryCount > 0) {
                const curves = boundaryCurves(this.#levels[0]);
                if (closed) throw notClosed(module, curves);
                const sentence = holeWarning(curves, this.#levels[0].positions());
                if (sentence) warnings.push(sentence);
            }
            constant({ keptVertices: this.#kept, warnings: Object.freeze(warnings) });
            warnings.forEach(sentence => warn(sentence));
        } catch (error) {
            this.dispose();
            throw error;
        }
    }

    /** Builds without vertices that no triangle has; sentences about those. */
    #buildUsed(positions, triangles, build) {
        try {
            this.#buildMarked(positions, triangles, build);
            return [];
        } catch (error) {
            if (error?.statusName !== 'HMF_ERROR_MESH_UNUSED_VERTEX') throw error;
        }
        const used = withoutUnused(positions, triangles), { markedVertices } = build;
        const marks = typeof markedVertices !== 'object' ? markedVertices : Array.from(markedVertices, vertex => {
            if (used.number.has(vertex)) return used.number.get(vertex);
            throw new TypeError(`markedVertices has ${vertex}, which belongs to no triangle.`);
        });
        this.#buildMarked(used.positions, used.triangles, { ...build, markedVertices: marks });
        this.#kept = used.kept;
        return [used.note];
    }

    /** Builds; a sphere or disk needs marked vertices: those of the library, unless it was told others. */
    #buildMarked(positions, triangles, { markedVertices, ...others }) {
        const module = this.#held.module;
        const suggested = () => suggestMarks(module, positions, triangles, pickOf(others, ['mollify', 'memoryLimit']));
        const build = marks => withMesh(module, positions, triangles, { ...others, markedVertices: marks }, (frame, ...mesh) => {
            const { address } = frame.make('hmf_hierarchy_create', ...mesh);
            this.#held.address = address;
            this.#info = frame.read('hmf_hierarchy_info', this.#held.module.invoke('hmf_hierarchy_describe', address));
            const counts = frame.list('hmf_level_info', this.#info.levels, this.#info.level_count);
            this.#levels = Object.freeze(counts.map((own, index) => new Level(this, index, own)));
            this.#marks = Uint32Array.from(marks ?? []);
        });
        try {
            build(markedVertices === 'suggest' ? suggested() : markedVertices);
        } catch (error) {
            if (markedVertices !== undefined || error?.statusName !== 'HMF_ERROR_MESH_GENUS') throw error;
            const marks = suggested();
            if (marks.length === 0) throw error;
            build(marks);
        }
    }

    /** The marked vertices that were given or suggested. */
    get markedVertices() {
        return this.#marks.slice();
    }

    get levels() {
        return this.#levels;
    }

    boundaries() {
        return boundaryCurves(this.#levels[0]);
    }

    get memoryBytes() {
        return this.perform({}, () => this.#info.memory_bytes);
    }

    get disposed() {
        return this.#held.address === 0;
    }

    dispose() {
        this.refuseWhenBusy();
        forgotten.unregister(this);
        this.#held.freeAll();
    }

    [dispose]() {
        this.dispose();
    }

    /** Internal. */
    refuseWhenBusy() {
        if (this.#busy) throw new Error('This hierarchy is in use by the call whose progress callback is running. Use it after that call.');
    }

    /** Internal: runs work(frame, address) and frees the memory of the frame; options may have a progress function. */
    perform(options, work) {
        this.refuseWhenBusy();
        if (this.disposed) throw new Error('This hierarchy has been disposed of. Build it again with new Hierarchy(positions, triangles).');
        this.#busy = true;
        try {
            return withFrame(this.#held.module, options, frame => work(frame, this.#held.address));
        } finally {
            this.#busy = false;
        }
    }

    /** Internal: registers a foliation of this hierarchy, which is freed with the hierarchy at the latest. */
    adopt(foliation, address) {
        this.#held.foliations.add(address);
        forgotten.register(foliation, { held: this.#held, foliation: address }, foliation);
    }

    /** Internal: frees it. */
    abandon(foliation, address) {
        forgotten.unregister(foliation);
        this.#held.free(address);
    }

    /** Internal: the index of a level, checked. */
    levelIndex(level, name = 'level') {
        wholeNumber(level, name);
        if (level >= this.#levels.length) throw new TypeError(`${name} is ${level}; give a number below ${this.#levels.length}, the number of levels.`);
        return level;
    }

    #foliation(options, belongs, make) {
        return this.perform(options, (frame, address) => new Foliation(this, frame, make(frame, address), keptLoops(belongs)));
    }

    loops(options) {
        const given = optionsOf(options, 'options', ['kind', 'level', 'progress']), { kind = 'cut', level = 0 } = given;
        this.levelIndex(level);
        return this.perform(given, (frame, address) => makeLoops(frame, address, level, kind));
    }

    loopsThrough(picked, options) {
        return loopsThrough(this, picked, options);
    }

    /** Loops, and what a foliation of them belongs to; of a kind: on level 0, or on the coarsest level, where they are found fastest. */
    #chosen(loops, isFine) {
        const set = typeof loops !== 'string' ? loops : loops === 'even' ? this.#evenLoops() : this.loops({ kind: loops, level: isFine ? 0 : this.#levels.length - 1 });
        return { set, belongs: typeof loops === 'string' && loops !== 'even' ? loops : set };
    }

    initialize(loops = 'cut', options) {
        const { set, belongs } = this.#chosen(loops, this.boundaryCount > 0);
        return this.#foliation(optionsOf(options, 'options', ['progress']), belongs, (frame, address) => {
            const written = writeLoops(frame, set ?? {});
            this.levelIndex(set.level ?? 0, 'loops.level');
            return frame.make('hmf_foliation_from_loops', address, written);
        });
    }

    solve(options) {
        const given = optionsOf(options, 'options', [...SOLVE_OPTIONS, 'loops', 'start']), { start, stopLevel: stop = 0 } = given;
        // Negative ones are counted from the coarsest.
        const level = this.levelIndex(stop < 0 && stop >= -this.#levels.length ? this.#levels.length + stop : stop, 'stopLevel');
        if (start !== undefined && !(start instanceof Foliation)) throw new TypeError(`start is ${described(start)}; give a Foliation.`);
        const { set, belongs } = this.#chosen(given.loops, this.boundaryCount > 0 || given.method === 'single-level');
        const known = belongs ?? (start === undefined ? 'cut' : classOf.get(start));
        const solve = address => this.#foliation(given, known, (frame, hierarchy) => {
            const loops = writeLoops(frame, set), settings = writeOptions(frame, { ...given, stopLevel: level }, { start: address });
            if (loops === 0 && address === 0) return frame.make('hmf_solve_cut_system', hierarchy, settings);
            return frame.make('hmf_solve', hierarchy, loops, settings);
        });
        if (start === undefined) return solve(0);
        // Not inside of perform: it may be of this hierarchy.  A callback must not dispose of it.
        if (start.hierarchy === this) return solve(start.perform({}, (_, address) => address));
        return start.perform({}, (frame, address) => {
            if (frame.module !== this.#held.module) throw new TypeError('start is of another load(). Give a Foliation of the same one.');
            return solve(address);
        });
    }

    /** Loops and weights of the even design with these marked vertices. */
    #evenLoops() {
        const mesh = this.#levels[0], marks = this.#marks;
        return evenDesign(this.#held.module, mesh.positions(), mesh.triangleVertices(), { ...(marks.length ? { markedVertices: marks } : {}), noPoles: true }).loops;
    }

    foliation(values, options) {
        const given = optionsOf(typeof options === 'number' ? { level: options } : options, 'options', ['level', 'progress']), { level = 0 } = given;
        this.levelIndex(level);
        numbers(values, 'values', { count: this.#levels[level].edgeCount });
        return this.#foliation(given, null, (frame, address) => frame.make('hmf_foliation_from_values', address, level, frame.copy(Float64Array, values), values.length));
    }
}

/** One level: its counts, and its arrays as fresh copies. */
export class Level {
    #hierarchy;

    constructor(hierarchy, index, counts) {
        this.#hierarchy = hierarchy;
        Object.assign(this, { index, ...counts });
        Object.freeze(this);
    }

    #array(name, count) {
        return this.#hierarchy.perform({}, (frame, address) => {
            const mesh = frame.result('hmf_level', address, this.index);
            return frame.arrays('hmf_level_mesh', mesh, { [name]: count })[camel(name)];
        });
    }

    edgeVertices() {
        return this.#array('edge_vertices', 2 * this.edgeCount);
    }

    triangleEdges() {
        return this.#array('triangle_edges', 3 * this.triangleCount);
    }

    triangleVertices() {
        return this.#array('triangle_vertices', 3 * this.triangleCount);
    }

    weights() {
        return this.#array('weights', this.edgeCount);
    }

    positions() {
        return this.#array('positions', 3 * this.vertexCount);
    }
}
