// Sets of loops between JavaScript, { elementKind, level, loops, weights, arcs },
// and the flat arrays of hmf_loop_set.
import { namesOf } from './error.js';
import { choice, indices, numbers, optionsOf, wholeNumber } from './arguments.js';

const elementKinds = namesOf('HMF_PATH_');
const loopKinds = namesOf('HMF_LOOPS_');

/** An hmf_loop_set in the memory of the call; 0 (NULL) for undefined. */
export function writeLoops(frame, set) {
    if (set === undefined) return 0;
    const given = optionsOf(set, 'loops', ['elementKind', 'level', 'loops', 'weights', 'arcs', 'arcSides']);
    if (!Array.isArray(given.loops)) throw new TypeError('loops.loops is missing or not an array; give one array of indices for each loop.');
    const parts = given.loops.map((loop, i) => indices(loop, `loops.loops[${i}]`)), offsets = [0n];
    let total = 0;
    for (const part of parts) offsets.push(BigInt(total += part.length));
    const elements = new Uint32Array(total);
    parts.forEach((part, i) => elements.set(part, Number(offsets[i])));
    const fields = {
        element_kind: choice(given.elementKind, 'loops.elementKind', elementKinds),
        level: wholeNumber(given.level ?? 0, 'loops.level'),
        count: parts.length,
        offsets: frame.copy(BigUint64Array, offsets),
        elements: frame.copy(Uint32Array, elements),
    };
    if (given.weights !== undefined) {
        const weights = numbers(given.weights, 'loops.weights');
        if (weights.length !== parts.length) throw new TypeError(`loops.weights has ${weights.length} entries; give ${parts.length}, one for each loop.`);
        fields.weights = frame.copy(Float64Array, weights);
    }
    if (given.arcs !== undefined) {
        const arcs = indices(given.arcs, 'loops.arcs');
        if (arcs.length !== parts.length) throw new TypeError(`loops.arcs has ${arcs.length} entries; give ${parts.length}, one for each loop.`);
        fields.arcs = frame.copy(Uint8Array, Uint8Array.from(arcs));
    }
    if (given.arcSides !== undefined) {
        const sides = indices(given.arcSides, 'loops.arcSides');
        if (sides.length !== 2 * parts.length) throw new TypeError(`loops.arcSides has ${sides.length} entries; give ${2 * parts.length}, two for each loop.`);
        fields.arc_sides = frame.copy(Uint32Array, sides);
    }
    return frame.structure('hmf_loop_set', fields);
}

/** A copy of loops, which no change of the caller's reaches; kinds, undefined and null as they are. */
export function keptLoops(set) {
    return set !== null && typeof set === 'object' ? { ...set, loops: Array.from(set.loops, loop => Uint32Array.from(loop)) } : set;
}

/** Loops of the library. */
export function readLoops(frame, address) {
    const { element_kind, level, count, weights, arcs, arc_sides } = frame.read('hmf_loop_set', address);
    const { offsets } = frame.arrays('hmf_loop_set', address, { offsets: count + 1 });
    const { elements } = frame.arrays('hmf_loop_set', address, { elements: Number(offsets[count]) });
    const loops = Array.from({ length: count }, (_, i) => elements.slice(Number(offsets[i]), Number(offsets[i + 1])));
    const set = { elementKind: elementKinds.byValue.get(element_kind), level, loops };
    if (weights !== 0) Object.assign(set, frame.arrays('hmf_loop_set', address, { weights: count }));
    if (arcs !== 0) Object.assign(set, frame.arrays('hmf_loop_set', address, { arcs: count }));
    if (arc_sides !== 0) Object.assign(set, frame.arrays('hmf_loop_set', address, { arc_sides: 2 * count }));
    return set;
}

/** Loops that the library makes. */
export function makeLoops(frame, hierarchy, level, kind) {
    return readLoops(frame, frame.result('hmf_loops', hierarchy, level, choice(kind, 'kind', loopKinds)));
}
