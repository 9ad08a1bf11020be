// Result of hmf_cylinders.
import { constants } from '../dist/layout.js';
import { writeLoops } from './loops.js';

/** hmf_cylinders on a level: once to count, once to fill. */
export function cylinders(frame, hierarchy, level, values, loops) {
    const set = writeLoops(frame, loops), valuesAt = frame.copy(values), counts = frame.room(Uint32Array, 2);
    const call = (...arrays) => frame.call('hmf_cylinders', hierarchy, level, valuesAt, values.length, set, ...arrays, counts, counts + 4);
    call(0, 0, 0, 0, 0, 0);
    const [count, triangleCount] = frame.result(Uint32Array, counts, 2);
    const list = frame.structure('hmf_cylinder', {}, count), offsetsAt = frame.room(BigUint64Array, count + 1), trianglesAt = frame.room(Uint32Array, triangleCount);
    call(list, count, offsetsAt, count + 1, trianglesAt, triangleCount);
    const offsets = frame.result(BigUint64Array, offsetsAt, count + 1), triangles = frame.result(Uint32Array, trianglesAt, triangleCount);
    return Array.from({ length: count }, (_, i) => {
        const { loop, height, circumference, modulus, area } = frame.read('hmf_cylinder', list, i);
        return {
            loop: loop === constants.HMF_NONE ? null : loop,
            height, circumference, modulus, area,
            leaf: triangles.slice(Number(offsets[i]), Number(offsets[i + 1])),
        };
    });
}
