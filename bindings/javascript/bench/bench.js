// npm run bench [-- MESH.obj ...]: WebAssembly against native code, and what
// the binding itself takes.
//
// Processor seconds, the least of the repetitions (HMF_REPETITIONS, default 5).
// The native program is the same core with c++ -O3.  Without a mesh: a torus of
// 100 000 vertices.  "binding" is the time of solve() outside of hmf_solve:
// copies, options, report.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { load } from '../lib/index.js';
import { torus } from '../examples/shapes.js';

const root = fileURLToPath(new URL('../../..', import.meta.url));
const repetitions = Number(process.env.HMF_REPETITIONS ?? 5);

function readObj(path) {
    const positions = [], triangles = [];
    for (const line of readFileSync(path, 'utf8').split('\n')) {
        const [kind, ...words] = line.trim().split(/\s+/);
        if (kind === 'v') positions.push(Number(words[0]), Number(words[1]), Number(words[2]));
        if (kind === 'f') triangles.push(...words.slice(0, 3).map(word => parseInt(word, 10) - 1));
    }
    return { name: basename(path, '.obj'), positions: Float64Array.from(positions), triangles: Uint32Array.from(triangles) };
}

function native(folder) {
    const program = join(folder, 'native');
    const folders = ['core', 'applications'].flatMap(layer => readdirSync(join(root, 'src', layer)).map(name => join(root, 'src', layer, name)));
    const sources = folders.flatMap(folder => readdirSync(folder).filter(name => name.endsWith('.cpp')).map(name => join(folder, name)));
    execFileSync(process.env.CXX ?? 'c++', ['-std=c++17', '-O3', '-DNDEBUG', '-ffp-contract=off', '-fno-exceptions', '-fno-rtti', '-I', join(root, 'include'),
        ...sources, fileURLToPath(new URL('native.cpp', import.meta.url)), '-o', program]);
    return mesh => {
        const file = join(folder, 'mesh'), counts = BigUint64Array.of(BigInt(mesh.positions.length / 3), BigInt(mesh.triangles.length / 3));
        writeFileSync(file, Buffer.concat([counts, mesh.positions, mesh.triangles].map(array => new Uint8Array(array.buffer, array.byteOffset, array.byteLength))));
        return JSON.parse(execFileSync(program, [file, String(repetitions)], { encoding: 'utf8' }));
    };
}

function processorSeconds() {
    const { user, system } = process.cpuUsage();
    return (user + system) / 1e6;
}

function webAssembly(hmf, mesh) {
    const module = hmf._module, invoke = module.invoke;
    let inside = 0;
    module.invoke = function (name, ...parameters) {
        if (name !== 'hmf_solve') return invoke.call(module, name, ...parameters);
        const start = performance.now();
        try { return invoke.call(module, name, ...parameters); } finally { inside = performance.now() - start; }
    };
    const best = { build: Infinity, solve: Infinity, binding: Infinity };
    for (let i = 0; i < repetitions; ++i) {
        const start = processorSeconds();
        const hierarchy = new hmf.Hierarchy(mesh.positions, mesh.triangles);
        const built = processorSeconds(), wall = performance.now();
        const foliation = hierarchy.solve();
        const outside = performance.now() - wall - inside;
        best.build = Math.min(best.build, built - start);
        best.solve = Math.min(best.solve, processorSeconds() - built);
        best.binding = Math.min(best.binding, outside / 1000);
        best.value = foliation.values[0];
        if (i === 0) best.first = processorSeconds() - start;
        hierarchy.dispose();
    }
    module.invoke = invoke;
    return best;
}

const folder = mkdtempSync(join(tmpdir(), 'hmf-bench-'));
try {
    const measure = native(folder);
    const meshes = process.argv.length > 2 ? process.argv.slice(2).map(readObj) : [{ name: 'torus', ...torus(400, 250) }];
    const hmf = await load();
    console.log('shape | vertices | native build, solve [s] | wasm build, solve [s] | ratio | first run [s] | binding [% of solve] | same bits');
    console.log('---|--:|--:|--:|--:|--:|--:|---');
    for (const mesh of meshes) {
        const n = measure(mesh), w = webAssembly(hmf, mesh);
        console.log([mesh.name, mesh.positions.length / 3, `${n.build.toFixed(3)}, ${n.solve.toFixed(3)}`, `${w.build.toFixed(3)}, ${w.solve.toFixed(3)}`,
            ((w.build + w.solve) / (n.build + n.solve)).toFixed(2), w.first.toFixed(2), ((100 * w.binding) / w.solve).toFixed(2),
            n.value === w.value ? 'yes' : 'NO'].join(' | '));
    }
} finally {
    rmSync(folder, { recursive: true });
}
