// The binding against hmf.h and applications.h: whatever is new or different there fails here.
// dist/layout.js is made by the build; these tests read the headers themselves.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { test } from 'node:test';
import { constants, functions, structures } from '../dist/layout.js';
import { load } from '../lib/index.js';

const read = path => readFileSync(new URL(path, import.meta.url), 'utf8');
const header = ['hmf', 'applications'].map(name => read(`../../../include/hmf/${name}.h`)).join('\n').replace(/\/\*[\s\S]*?\*\//g, ' ');
const sources = readdirSync(new URL('../lib/', import.meta.url), { recursive: true }).filter(name => name.endsWith('.js')).map(name => read(`../lib/${name}`)).join('\n');
const types = read('../lib/index.d.ts') + read('../dist/options.d.ts');

const camel = name => name.replace(/_([a-z])/g, (_, letter) => letter.toUpperCase());

test('every function of the headers is exported and used', async () => {
    const declared = [...header.matchAll(/HMF_API [^;(]*?\b(hmf_[a-z0-9_]+)\s*\(/g)].map(match => match[1]);
    assert.ok(declared.length >= 30);
    assert.deepEqual([...functions].sort(), [...declared].sort(), 'the build is out of date: npm run build');
    const exported = (await load())._module.exportNames();
    const unused = declared.filter(name => !name.endsWith('_init') && !sources.includes(`'${name}'`)); // structures call theirs by name
    assert.deepEqual(unused, [], 'functions of hmf.h that JavaScript does not offer');
    assert.deepEqual(declared.filter(name => !exported.includes(name)), []);
});

test('every structure of the headers has its fields in order, and JavaScript knows them', () => {
    const declared = [...header.matchAll(/typedef struct (hmf_[a-z_]+)\s*\{([^}]*)\}/g)];
    assert.deepEqual(declared.map(([, name]) => name).sort(), Object.keys(structures).sort(), 'the build is out of date: npm run build');
    // Of C alone (a module has one thread); arrays of JavaScript know their length.
    const internal = ['struct_size', 'allocate', 'release', 'allocator_user', 'position_stride', 'progress_user', 'reserved', 'workers', 'parallel_for', 'parallel_user'];
    const otherwise = ['hmf_report.level_count', 'hmf_report.history_count', 'hmf_error.message', 'hmf_loop_set.count', 'hmf_loop_set.offsets', 'hmf_loop_set.elements',
        'hmf_trace_options.point_count', 'hmf_trace_options.point_triangles', 'hmf_trace_options.point_barycentrics', 'hmf_lines.line_count', 'hmf_hierarchy_info.level_count', 'hmf_scale.log_scale',
        'hmf_lines.point_count', 'hmf_lines.lines', 'hmf_lines.offsets', 'hmf_lines.point_edges', 'hmf_singularity_set.count', 'hmf_cylinder_set.count', 'hmf_quad_mesh.quad_count',
        'hmf_hierarchy_options.marked_count', 'hmf_mark_set.marked_count', 'hmf_design.marked_count',
        // A component has its parts of these arrays.
        ...['count', 'used_vertex_count', 'marked_count', 'list', 'part_positions', 'part_triangles', 'part_marks'].map(field => `hmf_component_set.${field}`),
        ...['vertex', 'edge', 'triangle', 'mark'].map(name => `hmf_component.first_${name}`), 'hmf_component.marked_count'];
    for (const [, name, body] of declared) {
        const fields = body.split(/[;,]/).map(field => /([a-z_0-9]+)(\[\d+\])?\s*$/.exec(field.trim())?.[1]).filter(Boolean);
        assert.deepEqual(Object.keys(structures[name].fields), fields, name);
        let end = 0;
        for (const { offset } of Object.values(structures[name].fields)) {
            assert.ok(offset >= end, `${name} is in order`);
            end = offset + 1;
        }
        assert.ok(end <= structures[name].size);
        for (const field of fields) {
            if (internal.includes(field) || otherwise.includes(`${name}.${field}`)) continue;
            assert.match(types, new RegExp(`\\b${camel(field)}\\b`), `${name}.${field} is missing in index.d.ts`);
        }
    }
});

test('every constant of the headers has its value, and the types list its name', () => {
    const declared = [...header.matchAll(/\b(HMF_[A-Z0-9_]+)(?: =)? (\d+|0x[0-9a-f]+)u?\b/g)].map(([, name, value]) => [name, Number(value)]);
    assert.deepEqual(constants, Object.fromEntries(declared.sort(([a], [b]) => (a < b ? -1 : 1))), 'the build is out of date: npm run build');
    const prefixes = ['HMF_COLLAPSE_', 'HMF_METHOD_', 'HMF_PATH_', 'HMF_LOOPS_', 'HMF_SINGULAR_', 'HMF_ELEMENT_', 'HMF_PROGRESS_', 'HMF_LINE_', 'HMF_END_', 'HMF_LEAVES_', 'HMF_CLASS_', 'HMF_HISTORY_'];
    for (const [name] of declared) {
        if (/^HMF_(VERSION|ERROR|LIMIT)_|^HMF_(OK|CANCELLED|NONE|ELEMENT_NONE)$/.test(name)) continue;
        const prefix = prefixes.find(start => name.startsWith(start));
        assert.ok(prefix, `${name} belongs to no group that JavaScript knows`);
        const value = name.slice(prefix.length).toLowerCase().replaceAll('_', '-');
        assert.ok(types.includes(`"${value}"`), `"${value}" of ${name} is missing in index.d.ts`);
    }
});

test('a status of each kind has its name and text', async () => {
    const hmf = await load();
    for (const [name, value] of Object.entries(constants)) {
        if (!/^HMF_(OK|CANCELLED|ERROR_\w+|LIMIT_\w+)$/.test(name)) continue;
        assert.equal(hmf.statusName(value), name);
        assert.doesNotMatch(hmf.statusText(value), /unknown/i);
    }
});

test('files import without circles, and what hmf.h has without what applications.h has', () => {
    const lib = new URL('../lib/', import.meta.url), imports = url => [...readFileSync(url, 'utf8').matchAll(/from '(\.[^']+)'/g)].map(([, path]) => new URL(path, url).href);
    const visit = (url, above) => {
        assert.ok(!above.includes(url), [...above, url].join(' -> '));
        for (const next of imports(new URL(url))) visit(next, [...above, url]);
    };
    visit(new URL('index.js', lib).href, []);
    for (const name of readdirSync(lib).filter(file => file.endsWith('.js') && file !== 'index.js'))
        assert.deepEqual(imports(new URL(name, lib)).filter(url => url.includes('/applications/')), [], name);
});

test('the package has the version of the header', async () => {
    const part = name => constants[`HMF_VERSION_${name}`];
    const version = `${part('MAJOR')}.${part('MINOR')}.${part('PATCH')}`;
    assert.equal(JSON.parse(read('../package.json')).version, version);
    assert.equal((await load()).version, version);
});
