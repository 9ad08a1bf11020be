// examples/page.html in headless Chromium: it solves in its worker, paints the
// stripes, can be stopped, and survives meshes that are refused.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import { serve } from '../examples/serve.js';
import { load } from '../lib/index.js';
import { pretzel } from '../examples/shapes.js';

const pictures = process.env.HMF_BINDING_WORK ?? join(tmpdir(), 'hmf-browser-pictures');
let profile, context, servers;

before(async () => {
    mkdirSync(pictures, { recursive: true });
    profile = mkdtempSync(join(tmpdir(), 'hmf-browser-'));
    context = await chromium.launchPersistentContext(profile, {
        executablePath: process.env.HMF_CHROMIUM ?? '/usr/bin/chromium',
        headless: true,
        viewport: { width: 1280, height: 800 },
        args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
    });
    servers = { isolated: await serve(), plain: await serve({ isolated: false }) };
});

after(async () => {
    await context?.close();
    for (const { server } of Object.values(servers ?? {})) server.close();
    rmSync(profile, { recursive: true, force: true });
});

/** A page that has solved its first surface; complaints of the page fail the test. */
async function opened(kind) {
    const page = await context.newPage(), complaints = [];
    page.on('pageerror', error => complaints.push(String(error)));
    page.on('console', message => { if (message.type() === 'error') complaints.push(message.text()); });
    page.setDefaultTimeout(60000);
    await page.goto(servers[kind].address);
    await solved(page);
    return { page, complaints };
}

const solved = page => page.waitForSelector('body[data-state=idle] #report td');
const table = page => page.$$eval('#report tr', rows => Object.fromEntries(rows.map(row => [row.cells[0].textContent, row.cells[1].textContent.replace(/\s/g, '')])));

for (const kind of ['isolated', 'plain']) {
    test(`the page solves and paints (${kind === 'isolated' ? 'shared memory' : 'messages'})`, async () => {
        const { page, complaints } = await opened(kind);
        assert.equal(await page.evaluate(() => globalThis.crossOriginIsolated), kind === 'isolated');
        // The same bits as here: the same energy, all digits that are shown.
        const hmf = await load(), { positions, triangles } = pretzel(3, 4);
        const hierarchy = new hmf.Hierarchy(positions, triangles), here = hierarchy.solve().report;
        const shown = await table(page);
        assert.equal(shown.vertices, String(positions.length / 3));
        assert.equal(shown.genus, '3');
        assert.equal(shown.energy, here.energy.toFixed(4));
        assert.equal(shown.zeros, '8');
        assert.equal(shown.poles, '0');
        assert.equal(shown.state, 'ok');
        assert.ok(Number(shown['largest residual']) < 1e-8);
        hierarchy.dispose();

        await page.waitForSelector('canvas[data-picture=stripes]');
        // Red, white and blue are all on the picture, red and white about alike.
        const [red, white, blue] = await page.$eval('canvas', canvas => {
            const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height), counts = [0, 0, 0];
            for (let i = 0; i < data.length; i += 4) {
                const [r, g, b] = data.subarray(i, i + 3);
                if (r > 2 * g && r > 2 * b) ++counts[0];
                else if (b > 1.4 * r && b > 1.2 * g) ++counts[2];
                else if (r >= b + 4) ++counts[1]; // the ground is bluish
            }
            return counts;
        });
        assert.ok(red > 50000 && white > 0.5 * red && white < 2 * red && blue > 100, `${red} red, ${white} white, ${blue} blue`);
        const file = join(pictures, `page-${kind}.png`);
        writeFileSync(file, await page.screenshot());
        console.log(`picture: ${file}`);

        // Other weights, another class.
        await page.$eval('#weights input', input => { input.value = 3; input.dispatchEvent(new Event('input')); input.dispatchEvent(new Event('change')); });
        await page.waitForSelector('body[data-state=idle]');
        assert.ok(Number((await table(page)).energy) > Number(shown.energy));
        await page.selectOption('#kind', 'tunnel');
        await page.waitForSelector('body[data-state=idle]');
        assert.notEqual((await table(page)).energy, shown.energy);
        assert.deepEqual(complaints, []);
        await page.close();
    });

    test(`stop gives the foliation reached so far (${kind})`, async () => {
        const { page, complaints } = await opened(kind);
        // At the moment when the worker has been asked to solve.
        await page.evaluate(() => new Promise(resolve => {
            new MutationObserver((_, observer) => {
                if (document.querySelectorAll('#weights input').length !== 3) return;
                observer.disconnect();
                document.getElementById('stop').click();
                resolve();
            }).observe(document.getElementById('weights'), { childList: true });
            const shape = document.getElementById('shape');
            shape.value = 'pretzel 3 5';
            shape.dispatchEvent(new Event('change'));
        }));
        await solved(page);
        assert.equal((await table(page)).state, 'cancelled');
        // Another surface before the first is through: only the last one is shown.
        for (const shape of ['pretzel 3 5', 'pretzel 2 4', 'torus']) await page.selectOption('#shape', shape);
        await solved(page);
        assert.deepEqual([(await table(page)).genus, (await table(page)).state], ['1', 'ok']);
        // It goes on afterwards.
        await page.click('#solve');
        await page.waitForFunction(() => [...document.querySelectorAll('#report td')].some(cell => cell.textContent === 'ok'));
        assert.deepEqual(complaints, []);
        await page.close();
    });
}

test('a mesh that is refused says why, and the page goes on', async () => {
    const { page, complaints } = await opened('isolated');
    const drop = text => page.evaluate(content => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([content], 'mesh.obj'));
        dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, cancelable: true }));
    }, text);
    await drop('v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 2 5\nf 2 1 5\n');
    await page.waitForFunction(() => /third one at the edge/.test(document.getElementById('message').textContent));
    await page.selectOption('#shape', 'torus');
    await solved(page);
    assert.equal((await table(page)).genus, '1');
    await page.waitForSelector('canvas[data-picture=stripes]');
    writeFileSync(join(pictures, 'page-torus.png'), await page.screenshot());
    assert.deepEqual(complaints, []);
    await page.close();
});
