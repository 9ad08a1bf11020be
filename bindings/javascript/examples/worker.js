// A module worker that builds hierarchies and solves, posts progress and can be
// stopped.  In a page of your own, import from 'hmf' instead.
//
// It takes
//     { type: 'open', positions, triangles, flag }   flag: SharedArrayBuffer of 4 bytes, or undefined
//     { type: 'solve', kind, weights }               of loops of the library, and one weight for each
//     { type: 'stop', how }                          'cancel' or 'finish'; only without a flag
// and posts
//     { type: 'progress', stage, fraction }
//     { type: 'opened', genus, loopCount, levels, triangleEdges }
//     { type: 'solved', values, report, singularities }
//     { type: 'stopped' }                            nothing was reached yet
//     { type: 'failed', message }
//
// A call is synchronous, so no message arrives while it runs.  With shared
// memory the progress function looks at the flag: 0 go on, 1 cancel, 2 finish.
// Without, the worker solves level by level and lets messages in between.
import { HmfError, load } from '../lib/index.js';

const library = load();
let hierarchy = null, flag = null, asked = '', work = Promise.resolve();

const answers = ['continue', 'cancel', 'finish'];
let lastPost = 0;

/** A progress function for the part of a job from one fraction to another. */
function progress(stage, from = 0, to = 1) {
    return fraction => {
        const now = performance.now();
        if (now - lastPost > 40 || fraction === 1) {
            lastPost = now;
            postMessage({ type: 'progress', stage, fraction: from + (to - from) * fraction });
        }
        return flag ? answers[Atomics.load(flag, 0)] : 'continue';
    };
}

async function open({ positions, triangles, flag: shared }) {
    const hmf = await library;
    hierarchy?.dispose();
    hierarchy = null;
    flag = shared ? new Int32Array(shared) : null;
    asked = '';
    hierarchy = new hmf.Hierarchy(positions, triangles, { progress: progress('build') });
    postMessage({
        type: 'opened',
        genus: hierarchy.genus,
        loopCount: hierarchy.loops().loops.length,
        levels: hierarchy.levels.map(level => level.vertexCount),
        triangleEdges: hierarchy.levels[0].triangleEdges(),
    });
}

/** Lets waiting messages in. */
const pause = () => new Promise(resolve => setTimeout(resolve));

/** The loops start on the coarsest level; each finer one starts from the result before. */
async function solveByLevels(loops) {
    const { levels } = hierarchy, total = levels.reduce((sum, level) => sum + level.edgeCount, 0);
    let foliation = null, done = 0;
    for (let index = levels.length - 1; index >= 0; --index) {
        await pause();
        if (asked === 'cancel') return null;
        if (asked === 'finish' && foliation) return foliation.interpolate(0);
        const next = done + levels[index].edgeCount, report = progress('solve', done / total, next / total);
        foliation = foliation ? foliation.interpolate(index).relax({ progress: report }) : hierarchy.solve({ loops, stopLevel: index, progress: report });
        done = next;
    }
    return foliation;
}

async function solve({ kind, weights }) {
    if (!hierarchy) throw new Error('Open a mesh first.');
    asked = '';
    const loops = { ...hierarchy.loops({ kind }), weights };
    const foliation = flag ? hierarchy.solve({ loops, progress: progress('solve') }) : await solveByLevels(loops);
    if (!foliation) return postMessage({ type: 'stopped' });
    // Carried up from a coarser level, it has no report of its own.
    const report = foliation.report ?? { status: 'HMF_CANCELLED', energy: foliation.energy() };
    postMessage({ type: 'solved', values: foliation.values, report, singularities: foliation.singularities().list });
}

onmessage = ({ data }) => {
    if (data.type === 'stop') {
        asked = data.how;
        return;
    }
    // One job after the other.
    work = work.then(() => (data.type === 'open' ? open(data) : solve(data))).catch(error => {
        if (error instanceof HmfError && error.statusName === 'HMF_CANCELLED') postMessage({ type: 'stopped' });
        else postMessage({ type: 'failed', message: error.message });
    });
};
