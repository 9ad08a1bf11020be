// What a user meets first: holes, vertices that nothing uses, sentences in the words of JavaScript, types of all members.
import assert from 'node:assert/strict';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { before, test } from 'node:test';
import { HmfError, load } from '../lib/index.js';
import { inWords, libraryWords } from '../lib/error.js';
import { Foliation } from '../lib/foliation.js';
import { Hierarchy } from '../lib/hierarchy.js';
import { pretzel } from '../examples/shapes.js';
import { octahedron, smallTorus, twoTori } from './meshes.js';

let hmf;
before(async () => { hmf = await load(); });

test('a hole is said, and refused where the mesh has to be closed', () => {
    const { positions, triangles } = pretzel(2, 2), said = [], warn = sentence => said.push(sentence);
    const whole = new hmf.Hierarchy(positions, triangles, { closed: true, warn });
    assert.deepEqual([whole.boundaries(), whole.warnings, said, whole.solve().report.boundaries], [[], [], [], 0]);
    const open = triangles.slice(3), hierarchy = new hmf.Hierarchy(positions, open, { warn });
    const [curve, ...others] = hierarchy.boundaries();
    assert.deepEqual([[...curve].sort(), others], [[...triangles.slice(0, 3)].sort(), []]);
    assert.match(said[0], /^1 boundary looks like a hole by accident, the smallest with 3 edges; .*closed: true/);
    assert.deepEqual([hierarchy.warnings, said.length], [said, 1]);
    const foliation = hierarchy.solve(), { report } = foliation;
    assert.equal(report.boundaries, 1);
    const orders = foliation.singularities().list.filter(({ index }) => index < 0).reduce((sum, { index }) => sum - index, 0);
    assert.deepEqual([report.zeros, report.indexSum], [orders, -orders]);
    assert.throws(() => new hmf.Hierarchy(positions, open, { closed: true, warn }),
        error => error instanceof HmfError && error.statusName === 'HMF_ERROR_MESH_BOUNDARY' && error.element === 'vertex'
            && curve.includes(error.index) && /has 1 boundary, the first with 3 edges/.test(error.message));
    for (const one of [whole, hierarchy]) one.dispose();
});

test('holes of components are said with their number', () => {
    const { positions, triangles } = twoTori(), said = [];
    const { components } = hmf.solveComponents(positions, triangles.slice(3), { warn: sentence => said.push(sentence) });
    assert.deepEqual(components.map(({ report }) => report.boundaries), [1, 0]);
    assert.match(said.join(), /^component 0: 1 boundary looks like a hole/);
});

test('vertices without a triangle are dropped with a note', () => {
    const { positions, triangles } = octahedron(), said = [], warn = sentence => said.push(sentence);
    const alone = new hmf.Hierarchy(positions, triangles), bare = alone.solve().values;
    assert.equal(alone.keptVertices, null);
    const more = Float64Array.of(9, 9, 9, ...positions), moved = triangles.map(v => v + 1);
    const hierarchy = new hmf.Hierarchy(more, moved, { warn });
    assert.deepEqual(hierarchy.keptVertices, Uint32Array.of(1, 2, 3, 4, 5, 6));
    assert.deepEqual(hierarchy.levels[0].positions(), positions);
    assert.deepEqual(hierarchy.solve().values, bare);
    assert.match(said.join(), /^dropped 1 vertex without a triangle/);
    const marked = new hmf.Hierarchy(more, moved, { warn, markedVertices: [1, 2, 3, 4] });
    assert.deepEqual(marked.markedVertices, Uint32Array.of(0, 1, 2, 3));
    assert.throws(() => new hmf.Hierarchy(more, moved, { warn, markedVertices: [0, 1, 2, 3] }), /markedVertices has 0, which belongs to no triangle/);
    for (const one of [alone, hierarchy, marked]) one.dispose();
});

test('zero is zero, or refused', () => {
    const { positions, triangles } = pretzel(2, 2), hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve();
    assert.equal(hierarchy.solve({ timeLimit: 0 }).report.status, 'HMF_LIMIT_TIME');
    for (const work of [() => hierarchy.solve({ tolerance: 0 }), () => hierarchy.solve({ iterationLimit: 0 }), () => foliation.quads({ count: 0 }), () => foliation.quads({ edgeLength: 0 }), () => foliation.trace({ spacing: 0 }), () => foliation.trace({ lengthLimit: 0 }),
        () => foliation.atlas({ margin: 0 }), () => foliation.parameterize({ tolerance: 0 }), () => hmf.evenDesign(positions, triangles, { solveLimit: 0 }), () => new hmf.Hierarchy(positions, triangles, { ratio: 2 })])
        assert.throws(work, error => error.statusName === 'HMF_ERROR_OPTIONS' && /(\w+): \S+ is not in [[(]/.test(error.message));
    hierarchy.dispose();
});

/** The texts in quotes of each call that fails: what the library can say. */
function messages(folder) {
    return readdirSync(folder, { recursive: true }).filter(name => /\.[ch]pp$/.test(name)).flatMap(name =>
        [...readFileSync(`${folder}/${name}`, 'utf8').matchAll(/\bfail\((?:[^;"]|"(?:[^"\\]|\\.)*")*/g)]
            .map(([call]) => [...call.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map(([, text]) => text).join('')).filter(text => text));
}

const sources = new URL('../../../src', import.meta.url).pathname;
test('every error of the library is in words of JavaScript', { skip: !existsSync(sources) && 'the sources of the library are not here' }, () => {
    const all = messages(sources);
    assert.ok(all.length > 100, `${all.length} messages`);
    for (const message of all) assert.doesNotMatch(inWords(message), /hmf_|HMF_|NULL|struct_size|->|[a-z]_[a-z]|build options|optimis/, message);
    const unused = libraryWords.filter(words => !all.some(message => message.includes(words)));
    assert.deepEqual(unused, [], 'words that no error of the library has');
});

test('index.d.ts has all members of hierarchies and foliations', () => {
    const types = readFileSync(new URL('../lib/index.d.ts', import.meta.url), 'utf8');
    const internal = ['constructor', 'adopt', 'abandon', 'refuseWhenBusy', 'perform', 'levelIndex', 'discard'];
    const { positions, triangles } = smallTorus(), hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve();
    for (const [name, one, { prototype }] of [['Hierarchy', hierarchy, Hierarchy], ['Foliation', foliation, Foliation]]) {
        const start = types.indexOf(`export interface ${name} extends`), body = types.slice(start, types.indexOf('\n}', start));
        const missing = [...Object.keys(one), ...Object.getOwnPropertyNames(prototype)].filter(member => !internal.includes(member) && !new RegExp(`\\b${member}[(:]`).test(body));
        assert.deepEqual(missing, [], name);
    }
    hierarchy.dispose();
});
