// Options and report of hmf_solve and hmf_relax.
import { namesOf, statusName } from './error.js';
import { callback, choice, plainObject, realNumber, typedArray, wholeNumber } from './arguments.js';

const methods = namesOf('HMF_METHOD_');
const historyKinds = ['interpolation', 'sweep', 'linear-solve'];

export const OPTIMISE_OPTIONS = ['method', 'tolerance', 'timeLimit', 'iterationLimit', 'historyCapacity', 'progress'];

/** An hmf_solve_options without the callback; ready to be completed by withProgress. */
export function writeOptions(frame, options, more = {}) {
    const fields = { ...more };
    if (options.method !== undefined) fields.method = choice(options.method, 'method', methods);
    if (options.tolerance !== undefined) fields.tolerance = realNumber(options.tolerance, 'tolerance');
    if (options.timeLimit !== undefined) fields.time_limit = realNumber(options.timeLimit, 'timeLimit');
    if (options.iterationLimit !== undefined) fields.iteration_limit = wholeNumber(options.iterationLimit, 'iterationLimit');
    if (options.progress !== undefined) callback(options.progress, 'progress');
    return frame.structure('hmf_solve_options', fields);
}

/** The fields of hmf_solve_options for a foliation to start from. */
export function writeInitial(frame, initial) {
    if (initial === undefined) return {};
    plainObject(initial, 'initial', 'values and level, such as a Foliation');
    const values = typedArray(initial.values, Float64Array, 'initial.values');
    return { initial_values: frame.copy(values), initial_count: values.length, initial_level: wholeNumber(initial.level, 'initial.level') };
}

/** An hmf_report with room for the levels and for some history. */
export function writeReport(frame, levelCount, options) {
    const historyCapacity = wholeNumber(options.historyCapacity ?? 1000, 'historyCapacity');
    return frame.structure('hmf_report', {
        levels: frame.structure('hmf_level_report', {}, levelCount),
        level_capacity: levelCount,
        history: frame.structure('hmf_history_entry', {}, historyCapacity),
        history_capacity: historyCapacity,
    });
}

export function readReport(frame, address, status) {
    const report = frame.read('hmf_report', address);
    const levels = [], history = [];
    for (let i = 0; i < Math.min(report.level_count, report.level_capacity); ++i) {
        const level = frame.read('hmf_level_report', report.levels, i);
        levels.push({
            vertices: level.vertices,
            edges: level.edges,
            nld: level.nld,
            iterations: level.iterations,
            linearSolves: level.linear_solves,
            optimizeSeconds: level.optimize_seconds,
            interpolateSeconds: level.interpolate_seconds,
        });
    }
    for (let i = 0; i < Math.min(report.history_count, report.history_capacity); ++i) {
        const entry = frame.read('hmf_history_entry', report.history, i);
        history.push({
            seconds: entry.seconds,
            energy: entry.energy,
            residualMax: entry.residual_max < 0 ? null : entry.residual_max,
            level: entry.level,
            kind: historyKinds[entry.kind] ?? `kind ${entry.kind}`,
        });
    }
    return {
        status: statusName(status),
        method: methods.byValue.get(report.method) ?? `method ${report.method}`,
        converged: report.converged !== 0,
        energy: report.energy,
        residualMax: report.residual_max,
        residualMean: report.residual_mean,
        poles: report.poles,
        zeros: report.zeros,
        indexSum: report.index_sum,
        badFlips: report.bad_flips,
        badFlipsLeft: report.bad_flips_left,
        solveSeconds: report.solve_seconds,
        peakMemoryBytes: report.peak_memory_bytes,
        levels,
        history,
        historyCount: report.history_count,
    };
}

/** Whether a status below 100 left a foliation behind. */
export function valuesWritten(frame, address) {
    return frame.read('hmf_report', address).values_written !== 0;
}
