// Sets of loops between JavaScript, { elementKind, level, loops, weights },
// and the flat arrays of hmf_loop_set.
import { namesOf } from './error.js';
import { choice, indices, numbers, optionsOf, wholeNumber } from './arguments.js';

const elementKinds = namesOf('HMF_LOOP_');
const loopKinds = namesOf('HMF_LOOPS_');

/** An hmf_loop_set in the memory of the call; 0 (NULL) for undefined. */
export function writeLoops(frame, set) {
    if (set === undefined) return 0;
    const given = optionsOf(set, 'loops', ['elementKind', 'level', 'loops', 'weights']);
    if (!Array.isArray(given.loops)) throw new TypeError('loops.loops is missing or not an array; give one array of indices for each loop.');
    const parts = given.loops.map((loop, i) => indices(loop, `loops.loops[${i}]`));
    const offsets = new BigUint64Array(parts.length + 1);
    let total = 0;
    parts.forEach((part, i) => { offsets[i + 1] = BigInt(total += part.length); });
    const elements = new Uint32Array(total);
    parts.forEach((part, i) => elements.set(part, Number(offsets[i])));
    const fields = {
        element_kind: choice(given.elementKind, 'loops.elementKind', elementKinds),
        level: wholeNumber(given.level ?? 0, 'loops.level'),
        count: parts.length,
        offsets: frame.copy(offsets),
        elements: frame.copy(elements),
    };
    if (given.weights !== undefined) {
        const weights = numbers(given.weights, 'loops.weights');
        if (weights.length !== parts.length) throw new TypeError(`loops.weights has ${weights.length} entries; give ${parts.length}, one for each loop.`);
        fields.weights = frame.copy(weights);
    }
    return frame.structure('hmf_loop_set', fields);
}

/** Loops that the library makes. */
export function makeLoops(frame, hierarchy, level, kind) {
    const value = choice(kind, 'kind', loopKinds);
    const counts = frame.room(Uint32Array, 2);
    frame.call('hmf_loops', hierarchy, level, value, 0, 0, 0, 0, counts, counts + 4);
    const [loopCount, elementCount] = frame.result(Uint32Array, counts, 2);
    const offsetsAt = frame.room(BigUint64Array, loopCount + 1), elementsAt = frame.room(Uint32Array, elementCount);
    frame.call('hmf_loops', hierarchy, level, value, offsetsAt, loopCount + 1, elementsAt, elementCount, counts, counts + 4);
    const offsets = frame.result(BigUint64Array, offsetsAt, loopCount + 1);
    const elements = frame.result(Uint32Array, elementsAt, elementCount);
    const loops = [];
    for (let i = 0; i < loopCount; ++i) loops.push(elements.slice(Number(offsets[i]), Number(offsets[i + 1])));
    return { elementKind: 'triangles', level, loops };
}

/** The level that the elements of a set lie on. */
export function levelOf(set, ifUndefined) {
    return set === undefined ? ifUndefined : set.level ?? 0;
}
