// hmf_cylinders.
import { optionsOf } from '../arguments.js';
import { readLoops, writeLoops } from '../loops.js';
import { orNull } from '../memory.js';

export function cylinders(foliation, options) {
    const given = optionsOf(options, 'options', ['loops', 'progress']);
    const loops = given.loops === undefined ? foliation.loops : given.loops;
    return foliation.perform(given, (frame, address) => {
        const result = frame.result('hmf_cylinders', address, writeLoops(frame, loops ?? undefined));
        const { count, list, leaves, area_error } = frame.read('hmf_cylinder_set', result);
        const { twists, cornerOffsets } = frame.arrays('hmf_cylinder_set', result, { twists: count, corner_offsets: 2 * count + 1 });
        const corners = Number(cornerOffsets[2 * count]);
        return {
            list: frame.list('hmf_cylinder', list, count).map(one => ({ ...one, loop: orNull(one.loop) })),
            leaves: readLoops(frame, leaves),
            areaError: area_error,
            twists,
            cornerOffsets,
            ...frame.arrays('hmf_cylinder_set', result, { corner_vertices: corners, corner_places: corners }),
        };
    });
}
