// A module worker that builds hierarchies and solves, posts progress and can be
// stopped.  In a page of your own, import from 'foliations' instead.
//
// It takes
//     { type: 'open', mesh, positions, triangles, flag }
//                                                    mesh: a number of yours, in all answers;
//                                                    flag: SharedArrayBuffer of 4 bytes, or undefined
//     { type: 'loops', kind }                        'cut', 'handle', 'tunnel', ...: those to solve for
//     { type: 'solve', weights }                     one for each loop
//     { type: 'stop', how }                          'cancel' or 'finish'; only without a flag
// and posts, with mesh,
//     { type: 'progress', stage, fraction }
//     { type: 'opened', genus, levels, triangleEdges }
//     { type: 'loops', count }
//     { type: 'solved', values, report, singularities }
//     { type: 'stopped' }                            nothing was reached yet
//     { type: 'failed', message }
//
// A call is synchronous, so no message arrives while it runs.  With shared
// memory the progress function looks at the flag: 0 go on, 1 cancel, 2 finish.
// Without, the worker solves level by level and lets messages in between.
import { HmfError, load } from '../lib/index.js';

const library = load();
let hierarchy = null, loops = null, flag = null, asked = '', work = Promise.resolve();

const wishes = ['continue', 'cancel', 'finish'];
let lastPost = 0, mesh = 0;

const answer = message => postMessage({ ...message, mesh });

/** A progress function for the part of a job from one fraction to another. */
function progress(stage, from = 0, to = 1) {
    return fraction => {
        const now = performance.now();
        if (now - lastPost > 40 || fraction === 1) {
            lastPost = now;
            answer({ type: 'progress', stage, fraction: from + (to - from) * fraction });
        }
        return flag ? wishes[Atomics.load(flag, 0)] : 'continue';
    };
}

async function open({ mesh: number, positions, triangles, flag: shared }) {
    const hmf = await library;
    mesh = number;
    hierarchy?.dispose();
    hierarchy = null;
    flag = shared ? new Int32Array(shared) : null;
    asked = '';
    hierarchy = new hmf.Hierarchy(positions, triangles, { progress: progress('build') });
    answer({
        type: 'opened',
        genus: hierarchy.genus,
        levels: hierarchy.levels.map(level => level.vertexCount),
        triangleEdges: hierarchy.levels[0].triangleEdges(),
    });
}

function makeLoops({ kind }) {
    loops = hierarchy.loops({ kind });
    answer({ type: 'loops', count: loops.loops.length });
}

/** Lets waiting messages in. */
const pause = () => new Promise(resolve => setTimeout(resolve));

/** The loops start on the coarsest level; each finer one starts from the result before. */
async function solveByLevels(weighted) {
    const { levels } = hierarchy, total = levels.reduce((sum, level) => sum + level.edgeCount, 0);
    let foliation = null, done = 0;
    /** The next foliation, made of the last one, which is not needed any more. */
    const replace = next => {
        foliation?.dispose();
        foliation = next;
    };
    for (let index = levels.length - 1; index >= 0; --index) {
        await pause();
        if (asked === 'cancel') {
            replace(null);
            return null;
        }
        if (asked === 'finish' && foliation) {
            replace(foliation.interpolate(0));
            return foliation;
        }
        const next = done + levels[index].edgeCount, report = progress('solve', done / total, next / total);
        if (foliation) {
            replace(foliation.interpolate(index));
            replace(foliation.relax({ progress: report }));
        } else {
            foliation = hierarchy.solve({ loops: weighted, stopLevel: index, progress: report });
        }
        done = next;
    }
    return foliation;
}

async function solve({ weights }) {
    asked = '';
    const weighted = { ...loops, weights };
    const foliation = flag ? hierarchy.solve({ loops: weighted, progress: progress('solve') }) : await solveByLevels(weighted);
    if (!foliation) return answer({ type: 'stopped' });
    // Carried up from a coarser level, it has no report of its own.
    const report = foliation.report ?? { status: 'HMF_CANCELLED', energy: foliation.energy() };
    answer({ type: 'solved', values: foliation.values, report, singularities: foliation.singularities().list });
    foliation.dispose();
}

onmessage = ({ data }) => {
    if (data.type === 'stop') {
        asked = data.how;
        return;
    }
    // One job after the other.
    work = work.then(() => ({ open, loops: makeLoops, solve })[data.type](data)).catch(error => {
        if (error instanceof HmfError && error.statusName === 'HMF_CANCELLED') answer({ type: 'stopped' });
        else answer({ type: 'failed', message: error.message });
    });
};
