// Compiled by `tsc --strict`, run never: the types say what the library is.
// Each @ts-expect-error is a mistake that the types must catch.
import { HmfError, load } from "foliations";
import address from "foliations/hmf.wasm";
import type { Foliation, Hierarchy, Hmf, LoopSet, Report, Singularity } from "foliations";

export async function stripes(positions: Float64Array, triangles: Uint32Array): Promise<Float64Array> {
    const hmf: Hmf = await load();
    const bytes: Hmf = await load(address);
    const hierarchy: Hierarchy = new hmf.Hierarchy(positions, triangles, { collapse: "qslim", ratio: 0.5, progress: fraction => void fraction });
    const loops: LoopSet = hierarchy.loops({ kind: "cut", level: 0 });
    const foliation: Foliation = hierarchy.solve({
        loops: { ...loops, weights: [1, 2] },
        method: "newton",
        progress: fraction => (fraction > 0.5 ? "finish" : "continue"),
    });
    const report: Report | null = foliation.report;
    const last: number | null | undefined = report?.history.at(-1)?.residualMax;
    const zeros: Singularity[] = foliation.singularities().list.filter(singularity => singularity.index < 0);
    const coarse: Float64Array = foliation.interpolate(hierarchy.levels.length - 1).relax({ method: "whitehead" }).values;
    const numbers: number = foliation.energy() + hierarchy.genus + hmf.memory.inUse + zeros.length + (last ?? 0) + bytes.memoryEstimate(7, 14);

    const uv: Float64Array = foliation.parameterize({ seamEdges: [1, 2, 3], tolerance: 1e-3 }).cornerUv;

    const leaves: Float64Array[] = foliation.trace({ spacing: 0.1, through: { triangles: [0], barycentrics: [1, 0, 0] } }).map(line => line.points);

    const moduli: number[] = foliation.cylinders({ loops, progress: () => "cancel" }).list.map(cylinder => cylinder.modulus);

    const moved: Hierarchy = new hmf.Hierarchy(Float32Array.from(positions), [...triangles]);
    const next: Foliation = moved.solve({ start: foliation });
    const place: number[] | undefined = zeros[0]?.position;

    const marks: Uint32Array = hmf.suggestMarks(positions, triangles, { mollify: 1e-5 });
    const sphere: Hierarchy = new hmf.Hierarchy(positions, triangles, { markedVertices: marks });
    const { values: all, components } = hmf.solveComponents(positions, triangles, { markedVertices: marks, coarsest: 500 });
    const solved: number = components.filter(({ report }) => report !== null).length + all.length + hmf.components(positions, triangles).edgeCount;
    const proven: boolean = sphere.solve().report?.classState === "proven";

    const lost: number | undefined = sphere.solve().report?.stopped?.index;

    const corners: Uint32Array = foliation.quads({ edgeLength: 0.1 }).quads;

    // @ts-expect-error: positions are numbers
    new hmf.Hierarchy(new BigInt64Array(3), triangles);
    // @ts-expect-error: a number is no source
    await load(7);
    // @ts-expect-error: no such option
    hierarchy.solve({ tolerances: 1 });
    // @ts-expect-error: no such state
    sphere.solve().report?.classState === "certain";
    // @ts-expect-error: no such method
    hierarchy.solve({ method: "steepest" });
    // @ts-expect-error: no such answer
    hierarchy.solve({ progress: () => 1 });
    // @ts-expect-error: a foliation, not its values
    hierarchy.solve({ start: foliation.values });
    // @ts-expect-error: the report may be null
    foliation.report.energy;
    // @ts-expect-error: read only
    foliation.level = 1;
    // @ts-expect-error: loops say what their elements are
    hierarchy.initialize({ loops: [[1, 2, 3]] });

    next.dispose();
    sphere.dispose();
    hierarchy.dispose();
    return Float64Array.of(numbers, solved, ...coarse, ...uv, leaves.length, Number(proven), lost ?? 0, ...moduli, ...corners, ...(place ?? []));
}

export async function automatic(positions: Float64Array, triangles: Uint32Array): Promise<string> {
    const hmf = await load();
    try {
        using hierarchy = new hmf.Hierarchy(positions, triangles);
        return hierarchy.solve().report?.status ?? "";
    } catch (error) {
        if (!(error instanceof HmfError)) throw error;
        const where: string = error.element === null ? "" : `${error.element} ${error.index}`;
        return `${error.statusName} ${error.status} ${where} ${error.advice}`;
    }
}
