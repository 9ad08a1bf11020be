// The C library hmf in JavaScript: load() gives the library, an object with the class
// Hierarchy; everything else hangs on that.
import { Module } from './module.js';
import { Hierarchy, evenDesign, memoryEstimate, suggestMarks } from './hierarchy.js';
import { components, solveComponents } from './components.js';
import { Foliation } from './foliation.js';
import { cylinders } from './applications/cylinders.js';
import { harmonicForms } from './applications/forms.js';
import { parameterize } from './applications/parameterize.js';
import { quads } from './applications/quads.js';
import { atlas } from './applications/atlas.js';
import { trace } from './applications/trace.js';
import { wholeNumber } from './arguments.js';
import { statusName } from './error.js';

export { HmfError } from './error.js';

// Methods for applications.h, apart from those for hmf.h.
const attach = (prototype, uses) => {
    for (const [name, use] of Object.entries(uses))
        Object.defineProperty(prototype, name, { value: function (options) { return use(this, options); }, configurable: true, writable: true });
};
attach(Foliation.prototype, { parameterize, trace, cylinders, quads, atlas });
attach(Hierarchy.prototype, { harmonicForms });

export async function load(source) {
    const module = await Module.load(source);
    const number = module.invoke('hmf_version');
    return Object.freeze({
        version: `${Math.floor(number / 10000)}.${Math.floor(number / 100) % 100}.${number % 100}`,

        Hierarchy: class extends Hierarchy {
            static { Object.defineProperty(this, 'name', { value: 'Hierarchy' }); }

            constructor(positions, triangles, options) {
                super(module, positions, triangles, options);
            }
        },

        memoryEstimate: (vertexCount, triangleCount, options) => memoryEstimate(module, vertexCount, triangleCount, options),
        components: (positions, triangles, options) => components(module, positions, triangles, options),
        solveComponents: (positions, triangles, options) => solveComponents(module, positions, triangles, options),
        suggestMarks: (positions, triangles, options) => suggestMarks(module, positions, triangles, options),
        evenDesign: (positions, triangles, options) => evenDesign(module, positions, triangles, options),
        statusText: status => module.statusText(wholeNumber(status, 'status')),
        statusName,

        get memory() {
            return { inUse: module.invoke('hmf_js_bytes_in_use') >>> 0, size: module.memory.buffer.byteLength };
        },

        /** Internal, for the tests. */
        _module: module,
    });
}
