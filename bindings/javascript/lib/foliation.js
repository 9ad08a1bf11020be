// Foliation: one value for each edge of a level, and what can be asked of it.
import { namesOf } from './error.js';
import { optionsOf } from './arguments.js';
import { cylinders } from './cylinders.js';
import { PARAMETERIZE_OPTIONS, parameterize } from './parameterization.js';
import { QUAD_OPTIONS, quads } from './quads.js';
import { TRACE_OPTIONS, trace } from './trace.js';
import { OPTIMISE_OPTIONS, readReport, valuesWritten, writeOptions, writeReport } from './solve.js';

const singularityKinds = namesOf('HMF_SINGULAR_').byValue;

export class Foliation {
    constructor(hierarchy, level, values, report) {
        this.hierarchy = hierarchy;
        this.level = level;
        this.values = values;
        this.report = report;
        Object.freeze(this);
    }

    get #counts() {
        return this.hierarchy.levels[this.level];
    }

    interpolate(level) {
        this.hierarchy.levelIndex(level);
        return this.hierarchy.perform((frame, address) => {
            const count = this.hierarchy.levels[level].edgeCount;
            const out = frame.room(Float64Array, count);
            frame.call('hmf_interpolate', address, this.level, frame.copy(this.values), this.values.length, level, out, count);
            return new Foliation(this.hierarchy, level, frame.result(Float64Array, out, count), null);
        });
    }

    relax(options) {
        const given = optionsOf(options, 'options', OPTIMISE_OPTIONS);
        return this.hierarchy.perform((frame, address) => frame.module.withProgress(given.progress, fields => {
            const settings = writeOptions(frame, given, fields);
            const report = writeReport(frame, 1, given);
            const count = this.values.length, values = frame.copy(this.values);
            const status = frame.call('hmf_relax', address, this.level, settings, values, count, report);
            if (!valuesWritten(frame, report)) throw frame.error(status);
            return new Foliation(this.hierarchy, this.level, frame.result(Float64Array, values, count), readReport(frame, report, status));
        }));
    }

    energy() {
        return this.hierarchy.perform((frame, address) => {
            const out = frame.room(Float64Array, 1);
            frame.call('hmf_energy', address, this.level, frame.copy(this.values), this.values.length, out);
            return frame.result(Float64Array, out, 1)[0];
        });
    }

    residuals() {
        return this.hierarchy.perform((frame, address) => {
            const count = this.#counts.vertexCount;
            const out = frame.room(Float64Array, count);
            frame.call('hmf_residuals', address, this.level, frame.copy(this.values), this.values.length, out, count);
            return frame.result(Float64Array, out, count);
        });
    }

    singularities() {
        return this.hierarchy.perform((frame, address) => {
            const { vertexCount, triangleCount } = this.#counts;
            const values = frame.copy(this.values), countAt = frame.room(Uint32Array, 1);
            const vertexIndex = frame.room(Int32Array, vertexCount), triangleIndex = frame.room(Int32Array, triangleCount);
            const cluster = frame.room(Uint32Array, vertexCount);
            frame.call('hmf_singularities', address, this.level, values, this.values.length, vertexIndex, vertexCount,
                triangleIndex, triangleCount, cluster, vertexCount, 0, 0, countAt);
            const [count] = frame.result(Uint32Array, countAt, 1);
            const list = frame.structure('hmf_singularity', {}, count);
            frame.call('hmf_singularities', address, this.level, values, this.values.length, 0, 0, 0, 0, 0, 0, list, count, countAt);
            return {
                list: Array.from({ length: count }, (_, i) => {
                    const one = frame.read('hmf_singularity', list, i);
                    return { ...one, kind: singularityKinds.get(one.kind) ?? `kind ${one.kind}` };
                }),
                vertexIndex: frame.result(Int32Array, vertexIndex, vertexCount),
                triangleIndex: frame.result(Int32Array, triangleIndex, triangleCount),
                vertexCluster: frame.result(Uint32Array, cluster, vertexCount),
            };
        });
    }

    parameterize(options) {
        const given = optionsOf(options, 'options', PARAMETERIZE_OPTIONS);
        return this.hierarchy.perform((frame, address) => frame.module.withProgress(given.progress,
            fields => parameterize(frame, address, this.#counts, this.values, given, fields)));
    }

    trace(options) {
        const given = optionsOf(options, 'options', TRACE_OPTIONS);
        return this.hierarchy.perform((frame, address) => trace(frame, address, this.level, this.values, given));
    }

    cylinders(options) {
        const { loops } = optionsOf(options, 'options', ['loops']);
        return this.hierarchy.perform((frame, address) => cylinders(frame, address, this.level, this.values, loops));
    }

    quads(options) {
        const given = optionsOf(options, 'options', QUAD_OPTIONS);
        return this.hierarchy.perform((frame, address) => quads(frame, address, this.level, this.values, given));
    }
}
