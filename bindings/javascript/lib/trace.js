// Options and result of hmf_trace.
import { constants } from '../dist/layout.js';
import { namesOf } from './error.js';
import { choice, indices, numbers, optionsOf, realNumber } from './arguments.js';

export const TRACE_OPTIONS = ['leaves', 'critical', 'spacing', 'lengthLimit', 'through'];

const kinds = namesOf('HMF_LINE_').byValue;
const families = namesOf('HMF_LEAVES_');
const ends = namesOf('HMF_END_').byValue;
const orNull = index => (index === constants.HMF_NONE ? null : index);

function writeOptions(frame, options) {
    const fields = {};
    if (options.leaves !== undefined) fields.leaves = choice(options.leaves, 'leaves', families);
    if (options.critical !== undefined) fields.critical = options.critical ? 1 : 0;
    if (options.spacing !== undefined) fields.spacing = realNumber(options.spacing, 'spacing');
    if (options.lengthLimit !== undefined) fields.length_limit = realNumber(options.lengthLimit, 'lengthLimit');
    if (options.through !== undefined) {
        const given = optionsOf(options.through, 'through', ['triangles', 'barycentrics']);
        const triangles = indices(given.triangles, 'through.triangles'), barycentrics = numbers(given.barycentrics, 'through.barycentrics');
        if (barycentrics.length !== 3 * triangles.length)
            throw new TypeError(`through.barycentrics has ${barycentrics.length} entries; give ${3 * triangles.length}, three for each point.`);
        fields.point_count = triangles.length;
        fields.point_triangles = frame.copy(triangles);
        fields.point_barycentrics = frame.copy(barycentrics);
    }
    return frame.structure('hmf_trace_options', fields);
}

/** hmf_trace on a level: once to count, once to fill. */
export function trace(frame, hierarchy, level, values, options) {
    const settings = writeOptions(frame, options), valuesAt = frame.copy(values), counts = frame.room(Uint32Array, 2);
    const call = (...arrays) => frame.call('hmf_trace', hierarchy, level, valuesAt, values.length, settings, ...arrays, counts, counts + 4);
    call(0, 0, 0, 0, 0, 0, 0);
    const [lineCount, pointCount] = frame.result(Uint32Array, counts, 2);
    const linesAt = frame.structure('hmf_line', {}, lineCount), offsetsAt = frame.room(BigUint64Array, lineCount + 1);
    const pointsAt = frame.room(Float64Array, 3 * pointCount), edgesAt = frame.room(Uint32Array, pointCount);
    call(linesAt, lineCount, offsetsAt, lineCount + 1, pointsAt, edgesAt, pointCount);
    const offsets = frame.result(BigUint64Array, offsetsAt, lineCount + 1);
    const points = frame.result(Float64Array, pointsAt, 3 * pointCount), edges = frame.result(Uint32Array, edgesAt, pointCount);
    return Array.from({ length: lineCount }, (_, i) => {
        const line = frame.read('hmf_line', linesAt, i), from = Number(offsets[i]), to = Number(offsets[i + 1]);
        return {
            kind: kinds.get(line.kind) ?? `kind ${line.kind}`,
            closed: line.closed !== 0,
            begin: ends.get(line.begin) ?? `end ${line.begin}`,
            end: ends.get(line.end) ?? `end ${line.end}`,
            beginZero: orNull(line.begin_zero),
            endZero: orNull(line.end_zero),
            cylinder: orNull(line.cylinder),
            source: line.source,
            height: line.height,
            length: line.length,
            points: points.subarray(3 * from, 3 * to),
            edges: edges.subarray(from, to),
        };
    });
}
