// hmf_trace.
import { namesOf } from '../error.js';
import { choice, indices, numbers, optionsOf, realNumber } from '../arguments.js';
import { orNull } from '../memory.js';
import { option } from '../options.js';

const kinds = namesOf('HMF_LINE_').byValue;
const families = namesOf('HMF_LEAVES_');
const ends = namesOf('HMF_END_').byValue;

function writeOptions(frame, options) {
    const fields = {};
    if (options.leaves !== undefined) fields.leaves = choice(options.leaves, 'leaves', families);
    if (options.critical !== undefined) fields.critical = options.critical ? 1 : 0;
    fields.spacing = option(options, 'spacing', realNumber);
    fields.length_limit = option(options, 'lengthLimit', realNumber);
    if (options.through !== undefined) {
        const given = optionsOf(options.through, 'through', ['triangles', 'barycentrics']);
        const triangles = indices(given.triangles, 'through.triangles'), barycentrics = numbers(given.barycentrics, 'through.barycentrics');
        if (barycentrics.length !== 3 * triangles.length)
            throw new TypeError(`through.barycentrics has ${barycentrics.length} entries; give ${3 * triangles.length}, three for each point.`);
        fields.point_count = triangles.length;
        fields.point_triangles = frame.copy(Uint32Array, triangles);
        fields.point_barycentrics = frame.copy(Float64Array, barycentrics);
    }
    return frame.structure('hmf_trace_options', fields);
}

export function trace(foliation, options) {
    const given = optionsOf(options, 'options', ['leaves', 'critical', 'spacing', 'lengthLimit', 'through', 'progress']);
    return foliation.perform(given, (frame, address) => {
        const result = frame.result('hmf_trace', address, writeOptions(frame, given));
        const { line_count, point_count, lines, compared_count, deviation } = frame.read('hmf_lines', result);
        const { offsets, points, pointEdges } = frame.arrays('hmf_lines', result, { offsets: line_count + 1, points: 3 * point_count, point_edges: point_count });
        const list = frame.list('hmf_line', lines, line_count).map((line, i) => {
            const from = Number(offsets[i]), to = Number(offsets[i + 1]);
            return {
                ...line,
                kind: kinds.get(line.kind) ?? `kind ${line.kind}`,
                closed: line.closed !== 0,
                begin: ends.get(line.begin) ?? `end ${line.begin}`,
                end: ends.get(line.end) ?? `end ${line.end}`,
                beginZero: orNull(line.beginZero),
                endZero: orNull(line.endZero),
                cylinder: orNull(line.cylinder),
                points: points.subarray(3 * from, 3 * to),
                edges: pointEdges.subarray(from, to),
            };
        });
        return Object.assign(list, { comparedCount: compared_count, deviation });
    });
}
