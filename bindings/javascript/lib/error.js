// HmfError: a status of the library that is not a result.
import { constants } from '../dist/layout.js';

/** Constants with a prefix as a two-way table: value -> 'lower-case' name and back. */
export function namesOf(prefix) {
    const byValue = new Map(), byName = new Map();
    for (const [constant, value] of Object.entries(constants)) {
        if (!constant.startsWith(prefix)) continue;
        const name = constant.slice(prefix.length).toLowerCase().replaceAll('_', '-');
        byValue.set(value, name);
        byName.set(name, value);
    }
    return { byValue, byName };
}

const statusNames = new Map(Object.entries(constants)
    .filter(([name]) => name === 'HMF_OK' || name === 'HMF_CANCELLED' || name.startsWith('HMF_LIMIT_') || name.startsWith('HMF_ERROR_'))
    .map(([name, value]) => [value, name]));

/** 'HMF_OK', 'HMF_ERROR_MESH_BOUNDARY', ... */
export function statusName(status) {
    return statusNames.get(status) ?? `HMF status ${status}`;
}

const elements = namesOf('HMF_ELEMENT_').byValue;

// What sentences of the C library call otherwise than this package; other sentences with its words are left out.
const words = [
    ['hmf_hierarchy_options is unusable. Set struct_size to its size and unused fields to 0; ratio', 'The options cannot be used: ratio'],
    [', position_stride fits into memory, allocate and release come together', ''],
    ['set mollify in the build options', 'give mollify: 1e-5'],
    ['HMF_METHOD_WHITEHEAD has none', "method: 'whitehead' has none"],
    ['Use HMF_LOOPS_CUT or HMF_LOOPS_PANTS', "Use the loops 'cut' or 'pants'"],
    ['use HMF_LOOPS_CUT or HMF_LOOPS_PANTS', "use the loops 'cut' or 'pants'"],
    ['report->class_state', 'report.classState'],
    ['Build each component of hmf_components on its own', 'Use solveComponents'],
    ['Use hmf_loops, or another mesh', 'Use other loops, or another mesh'],
    ['; hmf_singularities lists them', '; foliation.singularities() lists them'],
    ['Start from hmf_foliation_from_loops or a result of hmf_solve', 'Start from hierarchy.initialize() or a result of solve()'],
    ['; hmf_hierarchy_memory_estimate gives a sufficient value', '; memoryEstimate() gives a sufficient value'],
    ['with hmf_interpolate', 'with foliation.interpolate()'],
    ['with hmf_relax', 'with foliation.relax()'],
    ['Give one of them, the other NULL', 'Give one of them'],
];
/** For the tests: what is replaced. */
export const libraryWords = words.map(([library]) => library);
const foreign = /hmf_|HMF_|NULL|struct_size|sizeof|->|position_stride|element_kind|_count\b/;

/** A sentence of the library in the words of this package; '' where it has none. */
export function inWords(message) {
    for (const [library, own] of words) message = message.replaceAll(library, own);
    return message.split(/(?<=\.)\s+/).filter(part => part && !foreign.test(part)).join(' ')
        .replace(/\b[a-z]+(?:_[a-z]+)+\b/g, name => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase()));
}

export class HmfError extends Error {
    constructor(status, text, element, index, advice) {
        super(advice ? `${text}: ${advice}` : text);
        this.status = status;
        this.statusName = statusName(status);
        this.element = element ? elements.get(element) ?? null : null;
        this.index = index;
        this.advice = advice;
    }
}
Object.defineProperty(HmfError.prototype, 'name', { value: 'HmfError', configurable: true, writable: true });
