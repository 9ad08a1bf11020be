// The page: a surface, a worker that solves, a canvas with the stripes.
import { pretzel, torus } from './shapes.js';
import { paint, potential, stripePeriod, vertexNormals } from './stripes.js';

const element = id => document.getElementById(id);
const canvas = document.querySelector('canvas'), main = document.querySelector('main');
const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });

let flag = null, number = 0, mesh = null, scene = null, opened = null;
let rotation = multiply(turn(0, -0.62), turn(2, 0.12)), zoom = 1;

// --- Surface ----------------------------------------------------------------

function makeShape(name) {
    if (name === 'torus') return torus(120, 50);
    const [, holes, refinements] = name.split(' ').map(Number);
    return pretzel(holes, refinements);
}

function readObj(text) {
    const positions = [], triangles = [];
    for (const line of text.split('\n')) {
        const [kind, ...words] = line.trim().split(/\s+/);
        if (kind === 'v') positions.push(...words.slice(0, 3).map(Number));
        if (kind === 'f') {
            const corners = words.map(word => parseInt(word, 10)).map(index => (index < 0 ? positions.length / 3 + index : index - 1));
            for (let k = 2; k < corners.length; ++k) triangles.push(corners[0], corners[k - 1], corners[k]);
        }
    }
    return { positions: Float64Array.from(positions), triangles: Uint32Array.from(triangles) };
}

function show(shape) {
    mesh = shape;
    const { positions, triangles } = mesh, low = [Infinity, Infinity, Infinity], high = low.map(x => -x);
    positions.forEach((x, i) => {
        low[i % 3] = Math.min(low[i % 3], x);
        high[i % 3] = Math.max(high[i % 3], x);
    });
    scene = {
        positions, triangles, normals: vertexNormals(positions, triangles), u: null, zeros: [],
        size: Math.hypot(...high.map((x, k) => x - low[k])), center: low.map((x, k) => (x + high[k]) / 2),
    };
    // As large as fits in the first view.
    const fit = [0, 1].map(row => positions.reduce((most, _, i) => i % 3 ? most
        : Math.max(most, Math.abs([0, 1, 2].reduce((sum, k) => sum + rotation[3 * row + k] * (positions[i + k] - scene.center[k]), 0))), 0));
    zoom = Math.min(main.clientWidth / fit[0], main.clientHeight / fit[1]) * 0.46 * scene.size / Math.min(main.clientWidth, main.clientHeight);
    element('report').replaceChildren();
    element('weights').replaceChildren();
    say('');
    stop('cancel');
    // Shared memory needs a page that is cross-origin isolated; without, messages do.
    flag = globalThis.crossOriginIsolated ? new Int32Array(new SharedArrayBuffer(4)) : null;
    opened = null;
    busy(true);
    worker.postMessage({ type: 'open', mesh: ++number, ...mesh, flag: flag?.buffer });
    draw();
}

// --- Worker -----------------------------------------------------------------

function say(text) {
    element('message').textContent = text;
}

function busy(yes) {
    element('solve').disabled = yes || !opened;
    element('stop').disabled = !yes;
    if (flag && yes) Atomics.store(flag, 0, 0);
    document.body.dataset.state = yes ? 'busy' : 'idle';
}

function solve() {
    busy(true);
    say('');
    worker.postMessage({ type: 'solve', weights: weights() });
}

/** 'finish' keeps what is reached, 'cancel' does not. */
function stop(how) {
    if (flag) Atomics.store(flag, 0, how === 'finish' ? 2 : 1);
    else worker.postMessage({ type: 'stop', how });
}

function askLoops() {
    busy(true);
    element('weights').replaceChildren();
    worker.postMessage({ type: 'loops', kind: element('kind').value });
}

const weights = () => [...element('weights').querySelectorAll('input')].map(input => Number(input.value));

function addWeights(count) {
    for (let i = 0; i < count; ++i) {
        const row = document.createElement('label');
        row.className = 'loop';
        row.innerHTML = `<span>loop ${i + 1}</span><input type="range" min="1" max="4" step="1" value="1"><span>1</span>`;
        row.querySelector('input').addEventListener('input', event => { row.lastElementChild.textContent = event.target.value; });
        row.querySelector('input').addEventListener('change', () => { if (!element('solve').disabled) solve(); });
        element('weights').append(row);
    }
}

function report({ report, singularities }) {
    const rows = [
        ['vertices', mesh.positions.length / 3], ['genus', opened.genus], ['levels', opened.levels.length],
        ['energy', report.energy.toFixed(4)], ['largest residual', report.residualMax?.toExponential(1)],
        ['zeros', singularities.reduce((sum, { index }) => sum - Math.min(0, index), 0)], ['poles', singularities.filter(({ index }) => index > 0).length],
        ['seconds', report.solveSeconds?.toFixed(2)], ['state', report.status.slice(4).toLowerCase().replaceAll('_', ' ')],
    ];
    element('report').replaceChildren(...rows.filter(([, value]) => value !== undefined).map(([name, value]) => {
        const row = document.createElement('tr');
        row.append(...[name, typeof value === 'number' ? value.toLocaleString('en').replaceAll(',', '\u202f') : value].map(text => Object.assign(document.createElement('td'), { textContent: text })));
        return row;
    }));
}

worker.onmessage = ({ data }) => {
    if (data.mesh !== number) return; // of a mesh that is gone
    if (data.type === 'progress') element('progress').value = data.fraction;
    if (data.type === 'opened') {
        opened = data;
        askLoops();
    }
    if (data.type === 'loops') {
        addWeights(data.count);
        solve();
    }
    if (data.type === 'solved') {
        scene.u = potential(mesh.triangles, opened.triangleEdges, data.values, data.singularities);
        scene.period = stripePeriod(scene);
        scene.zeros = data.singularities.filter(({ index }) => index < 0).map(({ position }) => position);
        report(data);
        element('progress').value = 1;
        busy(false);
        draw();
    }
    if (data.type === 'stopped') {
        busy(false);
        say('Stopped before there was a result.');
    }
    if (data.type === 'failed') {
        busy(false);
        say(data.message);
    }
};
worker.onerror = event => say(`The worker could not start: ${event.message ?? 'see the console'}`);

element('solve').addEventListener('click', solve);
element('stop').addEventListener('click', () => stop('finish'));
element('kind').addEventListener('change', () => { if (opened) askLoops(); });
element('shape').addEventListener('change', event => { if (event.target.value !== 'file') show(makeShape(event.target.value)); });

// --- Canvas -----------------------------------------------------------------

/** Rotation about axis 0 (x), 1 (y) or 2 (z). */
function turn(axis, angle) {
    const c = Math.cos(angle), s = Math.sin(angle);
    return [[1, 0, 0, 0, c, -s, 0, s, c], [c, 0, s, 0, 1, 0, -s, 0, c], [c, -s, 0, s, c, 0, 0, 0, 1]][axis];
}

function multiply(a, b) {
    return a.map((_, i) => a[i - (i % 3)] * b[i % 3] + a[i - (i % 3) + 1] * b[3 + (i % 3)] + a[i - (i % 3) + 2] * b[6 + (i % 3)]);
}

let pending = 0, settle = 0;

/** One coarse picture at once, a fine one when nothing moves any more. */
function draw() {
    pending ||= requestAnimationFrame(() => {
        pending = 0;
        picture(0.75);
        clearTimeout(settle);
        settle = setTimeout(() => picture(2 * devicePixelRatio), 150);
    });
}

function picture(sharpness) {
    const { clientWidth, clientHeight } = canvas;
    const image = new ImageData(Math.max(1, Math.round(clientWidth * sharpness)), Math.max(1, Math.round(clientHeight * sharpness)));
    paint(image, scene, rotation, zoom);
    // The browser scales it down: two samples by two make smooth edges.
    const large = new OffscreenCanvas(image.width, image.height);
    large.getContext('2d').putImageData(image, 0, 0);
    canvas.width = clientWidth * devicePixelRatio;
    canvas.height = clientHeight * devicePixelRatio;
    const context = canvas.getContext('2d');
    context.imageSmoothingQuality = 'high';
    context.drawImage(large, 0, 0, canvas.width, canvas.height);
    canvas.dataset.picture = scene.u && sharpness > 1 ? 'stripes' : 'plain';
}

canvas.addEventListener('pointerdown', event => canvas.setPointerCapture(event.pointerId));
canvas.addEventListener('pointermove', event => {
    if (!canvas.hasPointerCapture(event.pointerId)) return;
    rotation = multiply(multiply(turn(0, 0.008 * event.movementY), turn(1, 0.008 * event.movementX)), rotation);
    draw();
});
canvas.addEventListener('wheel', event => {
    event.preventDefault();
    zoom = Math.min(8, Math.max(0.3, zoom * Math.exp(-0.001 * event.deltaY)));
    draw();
}, { passive: false });
addEventListener('resize', draw);

addEventListener('dragover', event => { event.preventDefault(); main.classList.add('over'); });
addEventListener('dragleave', () => main.classList.remove('over'));
addEventListener('drop', async event => {
    event.preventDefault();
    main.classList.remove('over');
    const [file] = event.dataTransfer.files;
    if (!file) return;
    element('shape').value = 'file';
    show(readObj(await file.text()));
});

show(makeShape(element('shape').value));
