// The first steps of README.md, word by word in a clean copy, and the package
// that `npm pack` makes, in a project of its own.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { delimiter, join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../../..', import.meta.url));
const readme = readFileSync(new URL('../README.md', import.meta.url), 'utf8');
const steps = readme.slice(readme.indexOf('## First steps'), readme.indexOf('## What there is'));
const blocks = [...steps.matchAll(/^```(\w+)\n([\s\S]*?)^```$/gm)].map(([, language, text]) => ({ language, text }));
// npm tells the programs it starts about itself; a newcomer's shell has none of that.
const environment = Object.fromEntries(Object.entries(process.env).filter(([name]) => !/^npm_|^NODE_/i.test(name)));

let folder;
before(() => {
    folder = mkdtempSync(join(tmpdir(), 'hmf-readme-'));
    // An optimizer of binaryen that clang finds, and that refuses the module.
    mkdirSync(join(folder, 'tools'));
    writeFileSync(join(folder, 'tools', 'wasm-opt'), '#!/bin/sh\nexit 1\n', { mode: 0o755 });
    environment.PATH = join(folder, 'tools') + delimiter + environment.PATH;
});
after(() => rmSync(folder, { recursive: true, force: true }));

const shell = (text, cwd) => execFileSync('sh', ['-e', '-c', text], { cwd, env: environment, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });

test('the first steps do what README.md says', () => {
    assert.deepEqual(blocks.map(block => block.language), ['sh', 'js', 'sh', 'text']);
    const [install, example, run, output] = blocks.map(block => block.text);
    const lines = example.split('\n').filter(line => line.trim() && !line.startsWith('//'));
    assert.ok(lines.length <= 15, `${lines.length} lines`);
    const clone = join(folder, 'clone');
    for (const part of ['LICENSE', 'include', 'src', 'bindings/javascript'])
        cpSync(join(root, part), join(clone, part), { recursive: true, filter: path => !/[/\\](node_modules|dist)$/.test(path) });
    shell(install, clone);
    const here = join(clone, 'bindings', 'javascript');
    writeFileSync(join(here, 'example.js'), example);
    assert.equal(shell(run, here), output);
    const bytes = readFileSync(join(here, 'dist', 'hmf.wasm')), megabytes = size => `${(size / 1e6).toFixed(1)} MB`;
    assert.ok(readme.replace(/\s+/g, ' ').includes(`\`hmf.wasm\` has ${megabytes(bytes.length)}, ${megabytes(gzipSync(bytes).length)} where`), `${bytes.length} bytes`);
});

test('the calls that README.md lists exist', () => {
    const part = readme.slice(readme.indexOf('## What there is'), readme.indexOf('## In the browser')), [, calls] = /^```js\n([\s\S]*?)^```$/m.exec(part);
    const here = join(folder, 'clone', 'bindings', 'javascript');
    writeFileSync(join(here, 'calls.js'), `import { load } from 'foliations';
import { pretzel } from './examples/shapes.js';
const { positions, triangles } = pretzel(3, 3);
${calls}
if (!(foliation.report.energy > 0) || hierarchy.levels.length < 2) throw new Error('not solved');
`);
    shell('node calls.js', here);
});

test('npm pack makes a package with everything in it', () => {
    const [, example, , output] = blocks.map(block => block.text);
    const here = join(folder, 'clone', 'bindings', 'javascript');
    rmSync(join(here, 'dist'), { recursive: true });
    const [{ filename, files }] = JSON.parse(shell('npm pack --json --silent', here).replace(/^[^[]*/, ''));
    const paths = files.map(file => file.path);
    for (const needed of ['package.json', 'README.md', 'LICENSE', 'dist/hmf.wasm', 'dist/layout.js', 'dist/options.d.ts', 'lib/index.js', 'lib/index.d.ts'])
        assert.ok(paths.includes(needed), `${needed} is in the package`);
    for (const path of paths) assert.doesNotMatch(path, /^(test|bench|src|node_modules)\//);
    const project = join(folder, 'project');
    mkdirSync(project);
    writeFileSync(join(project, 'package.json'), '{ "name": "project", "private": true, "type": "module" }');
    shell(`npm install --offline --no-audit --no-fund ${JSON.stringify(join(here, filename))}`, project);
    writeFileSync(join(project, 'example.js'), example);
    assert.equal(shell('node example.js', project), output);
    assert.deepEqual(readdirSync(join(project, 'node_modules')).filter(name => !name.startsWith('.')), ['foliations']);
});
