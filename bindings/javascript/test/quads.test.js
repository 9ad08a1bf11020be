// Quad meshes against what the header promises.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { load } from '../lib/index.js';
import { pretzel, torus } from '../examples/shapes.js';

let hmf;
before(async () => { hmf = await load(); });

/** Checks that the mesh is closed, oriented and has the genus; returns the number of edges at each vertex. */
function check({ positions, quads }, genus) {
    const vertexCount = positions.length / 3, sides = new Set(), degree = new Uint32Array(vertexCount);
    for (let q = 0; q < quads.length; q += 4) {
        for (let s = 0; s < 4; ++s) {
            const a = quads[q + s], b = quads[q + ((s + 1) % 4)];
            assert.ok(a < vertexCount && a !== b && !sides.has(`${a},${b}`));
            sides.add(`${a},${b}`);
            ++degree[a];
        }
    }
    for (const side of sides) assert.ok(sides.has(side.split(',').reverse().join()), 'closed and oriented');
    assert.equal(vertexCount - sides.size / 2 + quads.length / 4, 2 - 2 * genus);
    return degree;
}

test('a torus: every vertex has four edges', () => {
    const { positions, triangles } = torus(48, 24), hierarchy = new hmf.Hierarchy(positions, triangles);
    const coarse = hierarchy.solve().quads({ edgeLength: 0.5 }), fine = hierarchy.solve().quads({ edgeLength: 0.25 });
    for (const mesh of [coarse, fine]) assert.ok(check(mesh, 1).every(degree => degree === 4));
    assert.ok(fine.quads.length > 3 * coarse.quads.length && fine.quads.length < 5 * coarse.quads.length);
    hierarchy.dispose();
});

test('genus 3: zeros come first and have the edges of their order', () => {
    const { positions, triangles } = pretzel(3, 3), hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve();
    const zeros = foliation.singularities().list.map(({ index }) => -index), degree = check(foliation.quads(), 3);
    degree.forEach((edges, v) => assert.equal(edges, v < zeros.length ? 2 * zeros[v] + 4 : 4));
    assert.throws(() => foliation.quads({ edgeLength: -1 }), error => error.name === 'HmfError' && error.statusName === 'HMF_ERROR_OPTIONS');
    assert.throws(() => foliation.quads({ edgeLength: '1' }), /edgeLength is string 1/);
    assert.throws(() => foliation.quads({ size: 1 }), /no option 'size'/);
    hierarchy.dispose();
    assert.equal(hmf.memory.inUse, 0);
});
