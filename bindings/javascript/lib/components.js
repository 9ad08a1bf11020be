// Meshes of several components (hmf_components): each is built and solved on its own.
import { constants } from '../dist/layout.js';
import { HmfError, namesOf, statusName } from './error.js';
import { callback, described, numbers, optionsOf } from './arguments.js';
import { BUILD_OPTIONS, Hierarchy, suggestMarks, withMesh } from './hierarchy.js';
import { SOLVE_OPTIONS } from './solve.js';

const elements = namesOf('HMF_ELEMENT_').byValue;
// Share of the division in the progress of solveComponents, and of the build in that of a component.
const DIVIDE_SHARE = 0.1, BUILD_SHARE = 0.25;

export function components(module, positions, triangles, options) {
    return withMesh(module, positions, triangles, options, (frame, ...mesh) => {
        const set = frame.result('hmf_components', ...mesh);
        const { count, list, vertex_count, edge_count, triangle_count, used_vertex_count, marked_count } = frame.read('hmf_component_set', set);
        const { partPositions, partTriangles, partMarks, wholeVertices, wholeEdges, wholeTriangles, ...ofElements } = frame.arrays('hmf_component_set', set, {
            part_positions: 3 * used_vertex_count, part_triangles: 3 * triangle_count, part_marks: marked_count,
            whole_vertices: used_vertex_count, whole_edges: edge_count, whole_triangles: triangle_count,
            vertex_component: vertex_count, vertex_part: vertex_count, triangle_component: triangle_count, triangle_part: triangle_count,
        });
        const part = (array, first, size, width = 1) => array.slice(width * first, width * (first + size));
        return {
            ...ofElements,
            edgeCount: edge_count,
            components: frame.list('hmf_component', list, count).map(c => ({
                status: c.status,
                statusName: statusName(c.status),
                element: c.element ? elements.get(c.element) ?? null : null,
                index: c.index,
                genus: c.genus,
                boundaryCount: c.boundaryCount,
                positions: part(partPositions, c.firstVertex, c.vertexCount, 3),
                triangles: part(partTriangles, c.firstTriangle, c.triangleCount, 3),
                markedVertices: part(partMarks, c.firstMark, c.markedCount),
                wholeVertices: part(wholeVertices, c.firstVertex, c.vertexCount),
                wholeEdges: part(wholeEdges, c.firstEdge, c.edgeCount),
                wholeTriangles: part(wholeTriangles, c.firstTriangle, c.triangleCount),
            })),
        };
    });
}

/** Loops of the whole mesh: for each component those on it, in its numbers. */
function splitLoops(divided, set) {
    const given = optionsOf(set, 'loops', ['elementKind', 'level', 'loops', 'weights', 'arcs', 'arcSides']);
    if (!Array.isArray(given.loops)) throw new TypeError('loops.loops is missing or not an array; give one array of indices for each loop.');
    if ((given.level ?? 0) !== 0) throw new TypeError(`loops.level is ${given.level}; loops of several components are of level 0.`);
    const name = given.elementKind === 'triangles' ? 'triangle' : 'vertex';
    const component = divided[`${name}Component`], number = divided[`${name}Part`];
    const parts = divided.components.map(() => ({ elementKind: given.elementKind, loops: [], weights: [], arcs: [], arcSides: [] }));
    given.loops.forEach((loop, i) => {
        const on = new Set(Array.from(numbers(loop, `loops.loops[${i}]`), element => component[element] ?? constants.HMF_NONE));
        const [k] = on;
        if (on.size !== 1 || k === constants.HMF_NONE) throw new TypeError(`loops.loops[${i}] does not lie on one component; give a loop on one of them.`);
        parts[k].loops.push(Uint32Array.from(loop, element => number[element]));
        parts[k].weights.push(given.weights?.[i] ?? 1);
        parts[k].arcs.push(given.arcs?.[i] ?? 0);
        for (const end of [0, 1]) parts[k].arcSides.push(given.arcSides?.[2 * i + end] ?? constants.HMF_NONE);
    });
    return parts;
}

/** The report of a component, built, solved and given back; its values go to those of the whole mesh. */
function solveOne(module, component, number, loops, { build, solve, warn }, progress, values) {
    const share = (from, to) => (progress ? fraction => progress(from + (to - from) * fraction) : undefined);
    const hierarchy = new Hierarchy(module, component.positions, component.triangles,
        { ...build, markedVertices: component.markedVertices, warn: sentence => warn(`component ${number}: ${sentence}`), progress: share(0, BUILD_SHARE) });
    try {
        const foliation = hierarchy.solve({ ...solve, loops, progress: share(BUILD_SHARE, 1) });
        component.wholeEdges.forEach((edge, e) => { values[edge] = foliation.values[e]; });
        return foliation.report;
    } finally {
        hierarchy.dispose();
    }
}

export function solveComponents(module, positions, triangles, options) {
    const names = [...new Set([...BUILD_OPTIONS, ...SOLVE_OPTIONS, 'loops', 'warn'])].filter(name => name !== 'stopLevel');
    const given = optionsOf(options, 'options', names), { progress, loops, warn = sentence => console.warn(sentence) } = given;
    callback(warn, 'warn');
    if (progress !== undefined && typeof progress !== 'function') throw new TypeError(`progress is ${described(progress)}; give a function.`);
    const pick = wanted => Object.fromEntries(Object.entries(given).filter(([name]) => wanted.includes(name) && name !== 'progress' && name !== 'markedVertices'));
    const build = pick(BUILD_OPTIONS), solve = pick(SOLVE_OPTIONS);
    const suggests = given.markedVertices === undefined || given.markedVertices === 'suggest';
    const limits = Object.fromEntries(Object.entries(build).filter(([name]) => name === 'mollify' || name === 'memoryLimit'));
    const marks = suggests ? suggestMarks(module, positions, triangles, limits) : given.markedVertices;
    const divided = components(module, positions, triangles,
        { ...build, markedVertices: marks, progress: progress ? fraction => progress(DIVIDE_SHARE * fraction) : undefined });
    const kind = typeof loops === 'string' ? loops : undefined;
    const parts = loops === undefined || kind !== undefined ? undefined : splitLoops(divided, loops);
    const values = new Float64Array(divided.edgeCount);
    let done = DIVIDE_SHARE;
    const rows = divided.components.map((component, k) => {
        const begin = done, end = begin + (1 - DIVIDE_SHARE) * component.triangles.length / triangles.length;
        done = end;
        const none = (status, message) => ({ ...component, status, statusName: statusName(status), message, report: null });
        if (component.status !== 0) return none(component.status, module.statusText(component.status));
        if (parts && parts[k].loops.length === 0) return none(constants.HMF_ERROR_LOOP_COUNT, 'No loop lies on it.');
        try {
            const report = solveOne(module, component, k, kind ?? parts?.[k], { build, solve, warn }, progress && (fraction => progress(begin + (end - begin) * fraction)), values);
            const status = constants[report.status];
            return { ...component, status, statusName: report.status, message: status === 0 ? '' : module.statusText(status), report };
        } catch (error) {
            // What is wrong with one component, or its loops, is said in its row.
            if (!(error instanceof HmfError) || (error.status < 300 && error.status !== constants.HMF_ERROR_UNSUPPORTED)) throw error;
            return none(error.status, error.message);
        }
    });
    return { values, components: rows };
}
