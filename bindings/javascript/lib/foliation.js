// Foliation: one value for each edge of a level, and what it is like.
import { namesOf } from './error.js';
import { optionsOf } from './arguments.js';
import { RELAX_OPTIONS, readReport, writeOptions } from './solve.js';

const kinds = namesOf('HMF_SINGULAR_').byValue;

/** Symbol.dispose, also where the engine has none yet. */
export const dispose = Symbol.dispose ?? Symbol.for('Symbol.dispose');

function readSingularities(frame, address) {
    const result = frame.result('hmf_singularities', address), { list, count, vertex_count, triangle_count } = frame.read('hmf_singularity_set', result);
    return {
        list: frame.list('hmf_singularity', list, count).map(one => ({ ...one, kind: kinds.get(one.kind) ?? `kind ${one.kind}` })),
        ...frame.arrays('hmf_singularity_set', result, { vertex_index: vertex_count, triangle_index: triangle_count, vertex_cluster: vertex_count }),
    };
}

/** Zeros, poles and the sum of indices of the surface itself. */
function surfaceCounts(frame, address) {
    const { control } = frame;
    frame.control = 0; // the call that made the foliation has reported its end
    const found = readSingularities(frame, address).list.map(({ index }) => index), sum = indices => indices.reduce((all, index) => all + index, 0);
    frame.control = control;
    return { zeros: sum(found.filter(index => index < 0).map(index => -index)), poles: sum(found.filter(index => index > 0)), indexSum: sum(found) };
}

/** Internal: what a foliation belongs to: loops, or a kind of loops of the library; null: unknown. */
export const classOf = new WeakMap();

export class Foliation {
    #address;

    /** Internal: of a call that made it; { address, status } of Frame.make, and an entry of classOf. */
    constructor(hierarchy, frame, { address, status }, belongs = null) {
        classOf.set(this, belongs);
        this.#address = address;
        hierarchy.adopt(this, address);
        const count = frame.room(Uint32Array, 1), values = frame.module.invoke('hmf_foliation_values', address, count);
        this.hierarchy = hierarchy;
        this.level = frame.module.invoke('hmf_foliation_level', address);
        this.unit = frame.module.invoke('hmf_foliation_unit', address);
        this.values = frame.array(Float64Array, values, frame.array(Uint32Array, count, 1)[0]);
        const report = readReport(frame, address, status, hierarchy.boundaryCount);
        // The library counts on the closed double.
        this.report = report && report.boundaries > 0 ? { ...report, ...surfaceCounts(frame, address) } : report;
        Object.freeze(this);
    }

    get loops() {
        const known = classOf.get(this);
        if (typeof known === 'string') classOf.set(this, this.hierarchy.loops({ kind: known }));
        return classOf.get(this);
    }

    get disposed() {
        return this.#address === 0 || this.hierarchy.disposed;
    }

    get memoryBytes() {
        return this.perform({}, (frame, address) => Number(BigInt.asUintN(64, frame.module.invoke('hmf_foliation_memory', address))));
    }

    dispose() {
        this.hierarchy.refuseWhenBusy();
        this.discard();
    }

    /** Internal: frees it, also during a call. */
    discard() {
        if (!this.disposed) this.hierarchy.abandon(this, this.#address);
        this.#address = 0;
    }

    [dispose]() {
        this.dispose();
    }

    /** Internal: runs work(frame, address) and frees the memory of the frame. */
    perform(options, work) {
        return this.hierarchy.perform(options, frame => {
            if (this.#address === 0) throw new Error('This foliation has been disposed of. Make it again, with hierarchy.solve(), say.');
            return work(frame, this.#address);
        });
    }

    /** The same for a call whose options are progress alone. */
    #ask(options, work) {
        return this.perform(optionsOf(options, 'options', ['progress']), work);
    }

    interpolate(level, options) {
        this.hierarchy.levelIndex(level);
        return this.#ask(options, (frame, address) => new Foliation(this.hierarchy, frame, frame.make('hmf_interpolate', address, level), classOf.get(this)));
    }

    relax(options) {
        const given = optionsOf(options, 'options', RELAX_OPTIONS);
        return this.perform(given, (frame, address) => new Foliation(this.hierarchy, frame, frame.make('hmf_relax', address, writeOptions(frame, given)), classOf.get(this)));
    }

    energy(options) {
        return this.#ask(options, (frame, address) => {
            const out = frame.room(Float64Array, 1);
            frame.finish('hmf_energy', address, frame.control, out);
            return frame.array(Float64Array, out, 1)[0];
        });
    }

    residuals(options) {
        return this.#ask(options, (frame, address) => {
            const result = frame.result('hmf_residuals', address), { vertex_count } = frame.read('hmf_residual_set', result);
            return frame.arrays('hmf_residual_set', result, { values: vertex_count }).values;
        });
    }

    conformalScale(options) {
        return this.#ask(options, (frame, address) => {
            const result = frame.result('hmf_conformal_scale', address), { triangle_count } = frame.read('hmf_scale', result);
            return frame.arrays('hmf_scale', result, { log_scale: triangle_count }).logScale;
        });
    }

    unevenness(options) {
        return this.#ask(options, (frame, address) => frame.read('hmf_scale', frame.result('hmf_conformal_scale', address)).unevenness);
    }

    singularities(options) {
        return this.#ask(options, readSingularities);
    }
}
