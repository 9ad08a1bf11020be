// Options and report of hmf_solve and hmf_relax.
import { namesOf, statusName } from './error.js';
import { choice, realNumber, wholeNumber } from './arguments.js';

const methods = namesOf('HMF_METHOD_');
const classStates = namesOf('HMF_CLASS_').byValue;
const historyKinds = ['interpolation', 'sweep', 'linear-solve'];

export const OPTIMIZE_OPTIONS = ['method', 'tolerance', 'residualTolerance', 'timeLimit', 'iterationLimit', 'progress'];

/** An hmf_solve_options. */
export function writeOptions(frame, options, more = {}) {
    const fields = { ...more };
    if (options.method !== undefined) fields.method = choice(options.method, 'method', methods);
    if (options.tolerance !== undefined) fields.tolerance = realNumber(options.tolerance, 'tolerance');
    if (options.residualTolerance !== undefined)
        fields.residual_tolerance = realNumber(options.residualTolerance, 'residualTolerance');
    if (options.timeLimit !== undefined) fields.time_limit = realNumber(options.timeLimit, 'timeLimit');
    if (options.iterationLimit !== undefined) fields.iteration_limit = wholeNumber(options.iterationLimit, 'iterationLimit');
    return frame.structure('hmf_solve_options', fields);
}

/** The report of a foliation; null where neither hmf_solve nor hmf_relax made it. */
export function readReport(frame, foliation, status) {
    const address = frame.module.invoke('hmf_foliation_report', foliation);
    if (address === 0) return null;
    const { level_count, history_count, levels, history } = frame.read('hmf_report', address);
    const { levelCount, historyCount, ...report } = frame.plain('hmf_report', address);
    const { element, index, advice } = frame.error(status);
    return {
        ...report,
        status: statusName(status),
        stopped: status === 0 ? null : { element, index, advice },
        method: methods.byValue.get(report.method) ?? `method ${report.method}`,
        converged: report.converged !== 0,
        classState: classStates.get(report.classState) ?? `class ${report.classState}`,
        levels: frame.list('hmf_level_report', levels, level_count),
        history: frame.list('hmf_history_entry', history, history_count).map(entry => ({
            ...entry,
            residualMax: entry.residualMax < 0 ? null : entry.residualMax,
            kind: historyKinds[entry.kind] ?? `kind ${entry.kind}`,
        })),
    };
}
