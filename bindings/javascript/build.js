// npm run build: dist/hmf.wasm, the core as WebAssembly, dist/layout.js, what
// hmf.h and applications.h say about functions, structures and constants, dist/options.d.ts,
// the types of options that are numbers, and a copy of LICENSE.
// node build.js types FILE: these types alone, which any clang can read.
//
// The layout is read from the syntax tree of clang and measured by a program
// that the same clang compiles for the same target, so neither can differ from
// the module.
//
// Each source is compiled by itself, as many at a time as there are processors (JOBS: another number).
// HMF_WASM_OBJECTS: a folder that keeps the objects, under the hash of all that they are made of.
//
// Compiler: WASI_SDK_PATH/bin/clang++ if that is set, else clang++ of the
// system with wasi-libc (on Debian: clang lld wasi-libc
// libclang-rt-14-dev-wasm32 libc++-14-dev-wasm32 libc++abi-14-dev-wasm32).
import { execFile, execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, renameSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { availableParallelism, tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';

const here = fileURLToPath(new URL('.', import.meta.url));
const root = join(here, '..', '..');
const include = join(root, 'include'), header = join(include, 'hmf', 'applications.h'); // with hmf.h in it
const compiler = process.env.WASI_SDK_PATH ? join(process.env.WASI_SDK_PATH, 'bin', 'clang++') : 'clang++';

const [command, file] = process.argv.slice(2);
const TARGET = [...(command === 'types' ? [] : ['--target=wasm32-wasi']), '-I', include];
// No contraction, as in the other builds of the core.  Bulk memory, saturating
// conversions and sign extension are in every browser since 2021; without the
// second each conversion from double to integer has a branch.
const CODE = ['-std=c++17', '-O3', '-DNDEBUG', '-ffp-contract=off', '-fno-exceptions', '-fno-rtti', '-fvisibility=hidden',
    '-mbulk-memory', '-mnontrapping-fptoint', '-msign-ext'];

function failure(error) {
    if (error.code === 'ENOENT')
        return new Error(`${compiler} is not there. Install clang, lld and wasi-libc (see the top of build.js), or set WASI_SDK_PATH.`);
    return new Error(`${compiler} failed:\n${error.stderr ?? error.message}`);
}

function compile(parameters) {
    try {
        return execFileSync(compiler, [...TARGET, ...parameters], { encoding: 'utf8', maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'pipe'] });
    } catch (error) {
        throw failure(error);
    }
}

/** Objects of the sources in a folder, some compiled at a time; those that are there are taken. */
async function compileEach(sources, headers, folder) {
    const common = createHash('sha256').update(JSON.stringify([compile(['--version']), TARGET[0], CODE]));
    for (const name of headers) common.update(name.slice(root.length)).update(readFileSync(name));
    const objects = sources.map(source =>
        join(folder, `${common.copy().update(source.slice(root.length)).update(readFileSync(source)).digest('hex')}.o`));
    const waiting = [...sources.keys()].filter(i => !existsSync(objects[i]));
    const run = promisify(execFile);
    const worker = async () => {
        for (let i; (i = waiting.shift()) !== undefined;) {
            const made = `${objects[i]}.${process.pid}`; // whole or not there
            await run(compiler, [...TARGET, ...CODE, '-c', sources[i], '-o', made], { maxBuffer: 1 << 28 }).catch(error => {
                waiting.length = 0;
                throw failure(error);
            });
            renameSync(made, objects[i]);
        }
    };
    await Promise.all(Array.from({ length: Number(process.env.JOBS) || availableParallelism() }, worker));
    return objects;
}

/** Functions, structures with typed fields, and constants of both headers. */
function readHeader() {
    const tree = JSON.parse(compile(['-x', 'c', '-fsyntax-only', '-Xclang', '-ast-dump=json', header]));
    const functions = [], structures = {};
    for (const node of tree.inner) {
        if (node.kind === 'FunctionDecl' && node.name.startsWith('hmf_')) functions.push(node.name);
        if (node.kind === 'RecordDecl' && node.completeDefinition && node.name?.startsWith('hmf_'))
            structures[node.name] = node.inner.filter(field => field.kind === 'FieldDecl').map(field => ({ name: field.name, type: fieldType(field) }));
    }
    const constants = [];
    for (const line of compile(['-x', 'c', '-E', '-dM', header]).split('\n')) {
        const found = /^#define (HMF_[A-Z0-9_]+) (\d+|0x[0-9a-f]+)u?$/.exec(line.trim());
        if (found) constants.push([found[1], Number(found[2])]);
    }
    for (const node of tree.inner.filter(({ kind, name }) => kind === 'EnumDecl' && name?.startsWith('hmf_')))
        for (const value of node.inner.filter(({ kind }) => kind === 'EnumConstantDecl')) constants.push([value.name, Number(value.inner[0].value)]);
    constants.sort((a, b) => (a[0] < b[0] ? -1 : 1));
    return { functions, structures, constants: Object.fromEntries(constants) };
}

function fieldType(field) {
    const type = field.type.desugaredQualType ?? field.type.qualType;
    const written = field.type.qualType;
    const simple = { uint32_t: 'u32', int32_t: 'i32', hmf_status: 'i32', uint64_t: 'u64', int64_t: 'i64', double: 'f64', size_t: 'pointer' }[written];
    if (simple) return simple;
    const row = /^(char|double)\[(\d+)\]$/.exec(type);
    if (row) return `${row[1] === 'char' ? 'text' : 'row'}${row[2]}`;
    const array = /^const (u?int\d+_t|double) \*$/.exec(written);
    if (array) return `${{ double: 'Float64', uint8_t: 'Uint8', int32_t: 'Int32', uint32_t: 'Uint32', uint64_t: 'BigUint64' }[array[1]]}Array`;
    if (type.includes('*')) return 'pointer';
    throw new Error(`build.js has no reading for the type ${written} of the field ${field.name}. Add it to fieldType and to lib/memory.js.`);
}

/** Sizes and offsets, measured by a program for the target. */
async function measure(structures) {
    const entries = Object.entries(structures);
    const numbers = entries.flatMap(([name, fields]) => [`sizeof(${name})`, ...fields.map(field => `offsetof(${name}, ${field.name})`)]);
    const folder = mkdtempSync(join(tmpdir(), 'hmf-layout-'));
    try {
        const source = join(folder, 'layout.c'), program = join(folder, 'layout.wasm');
        writeFileSync(source, `#include <stddef.h>\n#include "${header}"\n__attribute__((visibility("default"))) const unsigned layout[] = {${numbers.join(', ')}};\n`);
        compile(['-x', 'c', '-nostdlib', '-Wl,--no-entry', '-Wl,--export=layout', source, '-o', program]);
        const { instance } = await WebAssembly.instantiate(readFileSync(program));
        const measured = new Uint32Array(instance.exports.memory.buffer, instance.exports.layout.value, numbers.length);
        let next = 0;
        return Object.fromEntries(entries.map(([name, fields]) => {
            const size = measured[next++];
            return [name, { size, fields: Object.fromEntries(fields.map(field => [field.name, { offset: measured[next++], type: field.type }])) }];
        }));
    } finally {
        rmSync(folder, { recursive: true });
    }
}

// Numbers that are no options of JavaScript: arrays know their length.
const NO_OPTIONS = ['struct_size', 'reserved', 'position_stride', 'marked_count'];

/** The options of hmf_hierarchy_create and hmf_solve that are numbers: whatever is new in the header is an option at once. */
function numericOptions(structures) {
    const numbers = fields => fields.filter(({ name, type }) => ['f64', 'u64', 'u32'].includes(type) && !NO_OPTIONS.includes(name));
    return Object.fromEntries(['hmf_hierarchy_options', 'hmf_solve_options'].map(name => [name, numbers(structures[name]).map(field => field.name)]));
}

/** Their types, with the words of the header. */
function optionTypes(options) {
    const text = readFileSync(join(include, 'hmf', 'hmf.h'), 'utf8');
    const camel = name => name.replace(/_([a-z])/g, (_, letter) => letter.toUpperCase());
    const interfaces = Object.entries(options).map(([name, fields]) => {
        const body = text.slice(text.indexOf(`typedef struct ${name} {`), text.indexOf(`} ${name};`));
        const lines = fields.map(field => {
            const [, words = ''] = new RegExp(`\\b${field};\\s*/\\*([\\s\\S]*?)\\*/`).exec(body) ?? [];
            return `    /** ${words.trim().replace(/\s+/g, ' ')} */\n    ${camel(field)}?: number;\n`;
        });
        return `export interface ${name === 'hmf_hierarchy_options' ? 'BuildNumbers' : 'SolveNumbers'} {\n${lines.join('')}}\n`;
    });
    return `// Made by build.js from hmf.h; do not edit.\n${interfaces.join('\n')}`;
}

const { functions, structures, constants } = readHeader();
const options = numericOptions(structures);
if (command === 'types') {
    writeFileSync(file, optionTypes(options));
    process.exit();
}
const measured = await measure(structures);
mkdirSync(join(here, 'dist'), { recursive: true });
writeFileSync(join(here, 'dist', 'layout.js'), `// Made by build.js from hmf.h and applications.h; do not edit.
export const functions = ${JSON.stringify(functions, null, 4)};
export const structures = ${JSON.stringify(measured, null, 4)};
export const constants = ${JSON.stringify(constants, null, 4)};
export const options = ${JSON.stringify(options, null, 4)};
`);
writeFileSync(join(here, 'dist', 'options.d.ts'), optionTypes(options));

// npm takes the license only from the folder of the package.
copyFileSync(join(root, 'LICENSE'), join(here, 'LICENSE'));

const folders = ['core', 'applications'].flatMap(layer => readdirSync(join(root, 'src', layer)).map(name => join(root, 'src', layer, name)));
const files = folders.flatMap(folder => readdirSync(folder).map(name => join(folder, name)))
    .sort();
const sources = [...files.filter(name => name.endsWith('.cpp')), join(here, 'src', 'glue.cpp')];
const headers = [...files.filter(name => /\.h(pp)?$/.test(name)), ...readdirSync(join(include, 'hmf')).sort().map(name => join(include, 'hmf', name))];
const kept = process.env.HMF_WASM_OBJECTS, folder = kept ?? mkdtempSync(join(tmpdir(), 'hmf-objects-'));
const output = join(here, 'dist', 'hmf.wasm');
try {
    mkdirSync(folder, { recursive: true });
    const objects = await compileEach(sources, headers, folder);
    // The stack lies first, so that an overflow traps instead of overwriting data.  No -O: with it clang hands the module to
    // wasm-opt where binaryen is installed, which refuses instructions that it was not told of, and deletes the module.
    compile(['-mexec-model=reactor', ...objects,
        ...functions.map(name => `-Wl,--export=${name}`), '-Wl,--strip-all', '-Wl,--stack-first', '-Wl,-z,stack-size=1048576', '-o', output]);
} finally {
    if (!kept) rmSync(folder, { recursive: true });
}
console.log(`dist/hmf.wasm: ${statSync(output).size} bytes, ${functions.length} functions`);
