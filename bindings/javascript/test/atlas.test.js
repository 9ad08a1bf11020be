// Charts in the unit square against what the header promises.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../lib/index.js';
import { pretzel } from '../examples/shapes.js';

test('an atlas: all triangles in the square, with the area that is told', async () => {
    const hmf = await load(), { positions, triangles } = pretzel(2, 2);
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    const { cornerUv, triangleChart, chartCount, usedArea } = hierarchy.solve().atlas({ margin: 0.01 });
    assert.equal(triangleChart.length, triangles.length / 3);
    assert.equal(cornerUv.length, 2 * triangles.length);
    assert.ok(cornerUv.every(x => x >= 0 && x <= 1));
    assert.ok(triangleChart.every(chart => chart < chartCount));
    let area = 0;
    for (let t = 0; t < cornerUv.length; t += 6) {
        const [ax, ay, bx, by, cx, cy] = cornerUv.subarray(t, t + 6);
        area += ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2;
    }
    assert.ok(Math.abs(area - usedArea) < 1e-9);
    assert.throws(() => hierarchy.solve().atlas({ margin: 1 }), /margin/);
    hierarchy.dispose();
});
