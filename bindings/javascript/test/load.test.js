// Where the module may come from, and where it may run.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { test } from 'node:test';
import { Worker } from 'node:worker_threads';
import { load } from '../lib/index.js';
import { smallTorus } from './meshes.js';

const address = new URL('../dist/hmf.wasm', import.meta.url);

function solves(hmf) {
    const { positions, triangles } = smallTorus();
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    const { values } = hierarchy.solve();
    hierarchy.dispose();
    return values;
}

test('from the package, an address, bytes, a module, a response, a promise', async () => {
    const expected = solves(await load()), bytes = await readFile(address);
    const sources = [address, address.href, bytes, new Uint8Array(bytes), bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length),
        await WebAssembly.compile(bytes), new Response(bytes), Promise.resolve(bytes), WebAssembly.compile(bytes)];
    for (const source of sources) assert.deepEqual(solves(await load(source)), expected);
});

test('over http, whatever type the server says', async () => {
    const bytes = await readFile(address);
    const server = createServer((request, response) => {
        response.writeHead(request.url === '/hmf.wasm' ? 200 : 404, { 'content-type': 'application/octet-stream' });
        response.end(request.url === '/hmf.wasm' ? bytes : 'nothing here');
    });
    await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
    const base = `http://127.0.0.1:${server.address().port}`;
    try {
        assert.deepEqual(solves(await load(`${base}/hmf.wasm`)), solves(await load()));
        await assert.rejects(load(`${base}/elsewhere.wasm`), /could not be loaded: 404.*load\(\)/);
    } finally {
        server.close();
    }
});

test('what is no module', async () => {
    await assert.rejects(load(7), /TypeError|load\(\) takes nothing, an address/);
    await assert.rejects(load(null), TypeError);
    await assert.rejects(load(new Uint8Array(8)), WebAssembly.CompileError);
    const empty = Uint8Array.of(0, 0x61, 0x73, 0x6d, 1, 0, 0, 0);
    await assert.rejects(load(empty), /not the hmf.wasm of this package/);
    await assert.rejects(load(Promise.reject(new Error('offline'))), /offline/);
});

test('instances do not share memory', async () => {
    const [one, two] = [await load(), await load()], { positions, triangles } = smallTorus();
    const hierarchy = new one.Hierarchy(positions, triangles);
    assert.ok(one.memory.inUse > 0);
    assert.equal(two.memory.inUse, 0);
    hierarchy.dispose();
});

const workerSource = `
    import { parentPort, workerData } from 'node:worker_threads';
    const { load } = await import(workerData.library);
    const { torus } = await import(workerData.shapes);
    const { positions, triangles } = torus(100, 60);
    const flag = new Int32Array(workerData.flag);
    const hmf = await load(workerData.module);
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    let told = false;
    const foliation = hierarchy.solve({ progress: fraction => {
        if (!told) parentPort.postMessage({ fraction });
        told = true;
        Atomics.wait(flag, 0, 0, 10000);
        return Atomics.load(flag, 0) ? 'finish' : 'continue';
    } });
    parentPort.postMessage({ status: foliation.report.status, edges: foliation.values.length });
`;

test('in a worker thread, with a module compiled here, ended through shared memory', async () => {
    const flag = new Int32Array(new SharedArrayBuffer(4));
    const worker = new Worker(new URL(`data:text/javascript,${encodeURIComponent(workerSource)}`), {
        workerData: {
            flag: flag.buffer,
            module: await WebAssembly.compile(await readFile(address)),
            library: new URL('../lib/index.js', import.meta.url).href,
            shapes: new URL('../examples/shapes.js', import.meta.url).href,
        },
    });
    const result = await new Promise((resolve, reject) => {
        worker.on('error', reject);
        worker.on('message', message => {
            if (message.status) return resolve(message);
            Atomics.store(flag, 0, 1);
            Atomics.notify(flag, 0);
        });
    });
    assert.deepEqual(result, { status: 'HMF_CANCELLED', edges: 3 * 100 * 60 });
});
