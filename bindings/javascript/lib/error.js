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
