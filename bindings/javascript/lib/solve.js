// Options and report of hmf_solve and hmf_relax.
import { namesOf, statusName } from './error.js';
import { choice } from './arguments.js';
import { optionFields, optionNames } from './options.js';

const methods = namesOf('HMF_METHOD_');
const classStates = namesOf('HMF_CLASS_').byValue;
const historyKinds = ['interpolation', 'sweep', 'linear-solve'];

export const SOLVE_OPTIONS = ['method', ...optionNames('hmf_solve_options'), 'progress'];
export const RELAX_OPTIONS = SOLVE_OPTIONS.filter(name => name !== 'stopLevel');

/** An hmf_solve_options. */
export function writeOptions(frame, options, more = {}) {
    const fields = { ...optionFields('hmf_solve_options', options), ...more };
    if (options.method !== undefined) fields.method = choice(options.method, 'method', methods);
    return frame.structure('hmf_solve_options', fields);
}

/** The report of a foliation; null where neither hmf_solve nor hmf_relax made it. */
export function readReport(frame, foliation, status, boundaries) {
    const address = frame.module.invoke('hmf_foliation_report', foliation);
    if (address === 0) return null;
    const { level_count, history_count, levels, history } = frame.read('hmf_report', address);
    const { levelCount, historyCount, ...report } = frame.plain('hmf_report', address);
    const { element, index, advice } = frame.error(status);
    return {
        ...report,
        boundaries,
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
