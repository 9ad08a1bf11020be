#!/bin/bash
# Tests of the tests: each defect of a table is put into a copy of the sources,
# and the test named beside it must fail.
#
#     tests/mutations.sh FOLDER [PATTERN]
#
# FOLDER is for the copy and its build, only lines that match PATTERN are done.
#
# Columns: file, sed expression, program, cases of it.  An expression that
# changes nothing is a failure: the table goes with the sources.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
pattern=${2:-.}
jobs=${JOBS:-$(nproc)}
tree=$folder/tree

table() {
    grep -v -e '^#' -e '^$' << 'END' | grep -E -- "$pattern"
# The certificate of the class, and the way back
src/leaves/class_certificate.cpp  s/if (found == wanted) continue/continue/  test_class  ClassCertificate.*
src/homotopy/curve_names.hpp  s/if (same(i, others, j)) return j;/if (i == j) return j;/  test_class  ClassCertificate.*
src/leaves/class_certificate.cpp  s/if (m != n) {/if (false) {/  test_class  ClassCertificate.*
src/leaves/class_certificate.cpp  s/if (taken.size() == n)/if (true)/  test_class  ClassCertificate.*
src/leaves/class_certificate.cpp  s/(taken\[d\] || cylinders.list\[d\].height != height_\[c\] \* finer)/taken[d]/  test_class  ClassCertificate.*
src/leaves/class_certificate.cpp  s/ taken\[d\] = 1;/ taken[d] = 0;/  test_class  ClassCertificate.*
src/leaves/class_certificate.cpp  s/const int64_t wanted = height_\[c\] \* finer/const int64_t wanted = height_[c]/  test_class  ClassCertificate.*
src/solve/class_watch.cpp  s/^    std::memcpy(f.value, values.data(), .*//  test_class  ClassGuard.*
src/solve/class_watch.cpp  s/careful.guarded = true/careful.guarded = false/  test_class  ClassGuard.*
src/solve/cascade.cpp  s/^        std::memcpy(f.value, values.data(), .*//  test_class  ClassGuard.*

# Marked vertices stay, and are no poles
src/foliation/whitehead.cpp  s/if (f.mesh.is_marked(v) || rings/if (rings/  test_marked  Marked.*-*RealSurfaces*
src/foliation/whitehead.cpp  s/if (f.mesh.is_marked(v)) return 0;.*//  test_marked  Marked.ResidualIsOfTheOthers
src/foliation/cluster.cpp  s/result.marked += mesh.is_marked(v)/result.marked += 0/  test_marked  Marked.*-*RealSurfaces*
src/foliation/cluster_move.cpp  s/part.closed_corners >= 2 || part.marked > 0/part.closed_corners >= 2/  test_marked  Marked.*-*RealSurfaces*
src/hierarchy/simplify.cpp  s/if (work.mesh.is_marked(v) || work.mesh.is_marked(w)) return place_on_mark.*//  test_marked  Marked.StayInPlace*
src/mesh/marked_vertices.cpp  s/if (mark)$/if (false)/  test_marked  Marked.Unusable*

# The interface: results, limits, values
src/api/shared_flat.cpp  s/if (!is_minimum(foliation)) return HMF_OK;//  test_parameterize  Parameterize.Refusals
src/api/shared_flat.cpp  s/else free_part(h, made);//  test_parameterize  Parameterize.IsShared*
src/api/shared_flat.cpp  s/^            free_part(h, made);//  test_resources  Shares/OfEachFunction.EveryAllocationMayFail/*
src/api/shared_flat.cpp  s/SharedFlat\* part = foliation.flat.load(.*/SharedFlat* part = nullptr;/  test_parameterize  Parameterize.IsShared*
src/api/result.cpp  s/h.allocator_user, bytes}/h.allocator_user, size}/  test_parameterize  Parameterize.IsShared*
src/api/result.cpp  s/return (bytes + 15) \/ 16 \* 16;/return bytes;/  test_parameterize  Parameterize.Arrays*
src/api/read_loop_set.cpp  s/ || w < 1e-100//  test_errors  OnTorus.LoopWeights
src/api/read_values.cpp  s/corner2 >= 0 \&\& corner2 % 2 == 0/corner2 % 2 == 0/  test_errors  OnTorus.ValueDefects
src/api/read_values.cpp  s/^            --unit_exponent;//  test_reuse  Reuse.*

# Solve
src/solve/cascade.cpp  s/status == HMF_LIMIT_TIME || call.finishing()/call.finishing()/  test_resources  ProgressOf.Nothing*
src/solve/cascade.cpp  s/if (work.call.out_of_time()) return HMF_LIMIT_TIME;//  test_resources  ProgressOf.Nothing*
src/mesh/weights.cpp  s/sums.set(ij, corners.cot_k)/sums.set(ij, corners.cot_i)/  test_levels  Levels.WeightsOfCoarseLevels
src/mesh/weights.cpp  s/: w > COARSE_WEIGHT_CAP ? COARSE_WEIGHT_CAP : w;/: w;/  test_hierarchy  Weights.*
src/mesh/weights.cpp  s/!(w > COARSE_WEIGHT_FLOOR) ? COARSE_WEIGHT_FLOOR/w < 0 ? COARSE_WEIGHT_FLOOR/  test_hierarchy  Weights.*
src/mesh/validate.cpp  s/if (position_stride > PTRDIFF_MAX \/ vertex_count)/if (false)/  test_errors  OnTorus.BuildOptions
src/api/read_values.cpp  s/if (range.largest < LEAST_VALUE)/if (false)/  test_errors  OnTorus.ValueDefects
src/api/entry.cpp  s/h ? h->memory.used() : 0)/0)/  test_resources  Shares/OfEachFunction.MemoryLimitIsKept/*

# Loops
src/loops/check_loops.cpp  s/static_cast<Long>(d), static_cast<Long>(c), word/static_cast<Long>(c), static_cast<Long>(d), word/  test_library_loops  DrawnLoops.*
src/loops/check_loops.cpp  s/else bad = middle;/else good = middle;/  test_library_loops  DrawnLoops.*

# What is made of the result
src/parameterize/parameterization.cpp  s/if (above > 16 + n \/ 20) break;//  test_parameterize  Parameterize.Many*
src/parameterize/seams.cpp  s/^ *u\[t\] += u\[t\] > limit .*//  test_newton_parts  Layout.*
src/quads/quad_sizes.cpp  s/return MOST_ROWS_NEEDED - 1/return MOST_ROWS_NEEDED - 2/  test_leaves  LeavesContract.NoTwoEdges*
src/parameterize/conjugate_form.cpp  s/return has_odd || missing(0) == 0 || turn_round(size, memory);/return true;/  test_marked  Marked.EvenZeros*
src/quads/surface_walk.cpp  s/for (int k = 0; k < 3; ++k) nearest/for (int k = 1; k < 3; ++k) nearest/  test_surface_walk  SurfaceWalk.*
src/quads/quad_rulers.hpp  s/constexpr double FLATTEST = 1e-12;/constexpr double FLATTEST = 0;/  test_quads  Quads.TrianglesThatAreFlatUpToRounding

# Components
src/mesh/components.cpp  s/^        met = low;//  test_components  Components.AreDividedWithTheirOrder
src/mesh/components.cpp  s/ + number\[i\]\] = static_cast<uint32_t>(i);/ + number[i]] = number[i];/  test_components  Components.AreDividedWithTheirOrder
src/mesh/components.cpp  s/vertex\[c + s\] >= vertex_count/vertex[c + s] > vertex_count/  test_components  Components.ErrorsOfTheCall
src/api/components_api.cpp  s/ELEMENT_TRIANGLE) c.index = .*/ELEMENT_TRIANGLE) {}/  test_components  Components.SayWhatEachIs
src/api/components_api.cpp  s/ELEMENT_VERTEX) c.index = .*/ELEMENT_VERTEX) {}/  test_components  Components.SayWhatEachIs
src/api/components_api.cpp  s/ || c.status == HMF_ERROR_MESH_GENUS) {/) {/  test_components  Components.SayWhatEachIs
src/api/components_api.cpp  s/first += c.marked_count;//  test_components  Components.MarksGoToTheirComponents
src/api/components_api.cpp  s/ = all_.vertex_number\[options_.marked_vertices\[n\]\];/ = options_.marked_vertices[n];/  test_components  Components.MarksGoToTheirComponents
src/api/components_api.cpp  s/all_.vertices\[c.first_vertex + v\]))/v))/  test_components  Components.MarksAreSuggestedForEach
src/api/components_api.cpp  s/position_stride), all_.vertices\[n\]),/position_stride), n),/  test_components  Components.AreSolvedAsIfAlone
src/api/components_api.cpp  s/block.array(set, set.part_positions, .*/set.part_positions = nullptr;/  test_components  Components.OneIsTheMesh
include/hmf/hmf.hpp  s/all.values\[edges\[e\]\] = own\[e\]/all.values[e] = own[e]/  test_hpp  Hpp.ComponentsAreSolvedInOneCall
include/hmf/hmf.hpp  s/done += share;//  test_hpp  Hpp.ComponentsAreSolvedInOneCall
include/hmf/hmf.hpp  s/build.marked_vertices = marked_vertices(k);/build.marked_vertices = {};/  test_hpp  Hpp.ComponentsAreSolvedInOneCall
include/hmf/hmf.hpp  s/elements.push_back(number\[element\])/elements.push_back(element)/  test_hpp  Hpp.LoopsGoToTheirComponents
include/hmf/hmf.hpp  s/parts\[on\].add(elements, whole.weights\[c\])/parts[on].add(elements)/  test_hpp  Hpp.LoopsGoToTheirComponents
include/hmf/hmf.hpp  s/(on != HMF_NONE \&\& k != on)/(false)/  test_hpp  Hpp.LoopsGoToTheirComponents

# Blocks of a pass do not depend on each other
src/hierarchy/simplify.cpp  s/ | work_.at_border\[mesh_.origin\[2 \* e + 1\]\];/;/  test_hierarchy  Hierarchy.BordersOfBlocksAreKnown
src/hierarchy/simplify.cpp  s/return (v ^ w) >> work_.block_shift != 0;/return false;/  test_parallel  Parallel.SameBitsOfTheBuild
src/hierarchy/simplify.cpp  s/^            mark_border(mesh_.origin\[record.il\]);//  test_hierarchy  Hierarchy.BordersOfBlocksAreKnown
src/foliation/cluster.cpp  s/if (!f.may_look(w, f.members.size())) return result;//  test_sweeps  SweepTask.*
src/foliation/whitehead.cpp  s/if (!f.may_look(mesh.origin\[g\], 0)) return NONE;//  test_sweeps  SweepTask.*
src/foliation/cluster.cpp  s/if (!f.may_look(vertex, 0)) return result;//  test_sweeps  SweepTask.Asks*
src/foliation/cluster_move.cpp  s/if (!f.may_look(w, f.pushed.size())) return false;//  test_sweeps  SweepTask.Takes*
src/hierarchy/simplify.cpp  s/work_.block_count + 1, \[/work_.block_count - 1, [/  test_hierarchy  Hierarchy.LargeMeshes*
src/hierarchy/delaunay.cpp  s/work.has_double_edges \&\& is_folded/false \&\& is_folded/  test_hierarchy  Hierarchy.DoublesAre*
src/api/result.cpp  s/call.memory.failure() ? nullptr : //  test_resources  Resources.NothingIs*
src/solve/to_minimum.cpp  s/unit \* unit) - 1;/unit * unit) - 2;/  test_leaves  Cylinders.OfValuesNear*
src/solve/sweep_matrix.cpp  s/const bool border = least < own\[i\] || /const bool border = /  test_signed_multigrid  SweepMatrix.*
src/solve/signed_aggregation.cpp  s/, a) : undecided;/, a) : undecided, a.of[i] = choice[i] != undecided ? choice[i] \/ 2 : a.of[i];/  test_signed_multigrid  SignedMultigrid.SameBitsWithThreads
src/base/parallel.hpp  s/work.count - 1 - last : first, slot/last : first, slot/  test_parallel  Parallel.SameBitsOfEveryFunction
src/base/parallel.hpp  s/if (first + last >= work.count) return;/if (first >= work.count || last >= work.count) return;/  test_parallel  Parallel.SlotsAreOwned

# Design, boundary, weights
src/design/marked_trial.cpp  s/if (loops.count() > 0) {/if (false) {/  test_design  Trials.ShareLoops
src/design/marked_trial.cpp  s/if (!loops.copy_from(loops_, outer_.memory)) return outer_.out_of_memory();//  test_design  Trials.ShareLoops
src/design/weight_search.cpp  s/^            area\[loop\] += share \* ends;//  test_design  EvenDesign.WeightsFollow*
src/api/solve_result.cpp  s/options.method != HMF_METHOD_PAPER \&\& make_symmetric/options.method == HMF_METHOD_NEWTON \&\& make_symmetric/  test_boundary  Boundary.MethodsAgree
src/mesh/intrinsic.cpp  s/: w > INTRINSIC_WEIGHT_CAP      ? INTRINSIC_WEIGHT_CAP/: w > INTRINSIC_WEIGHT_CAP ? w/  test_intrinsic  Mollify.WeightsAreKeptWithinBounds
src/mesh/intrinsic.cpp  s/const double w = 0.5 \* sum\[e\];/const double w = sum[e];/  test_intrinsic  Mollify.WeightsAreKeptWithinBounds
END
}

# The sources as they are; files that are as before keep their times, so that little is built again.
copy() {
    local part file
    rm -rf "$folder/new"
    mkdir -p "$tree" "$folder/new"
    (cd "$root" && tar cf - CMakeLists.txt include src bindings/readers tests) | (cd "$folder/new" && tar xf -)
    (cd "$folder/new" && find . -type f) | while read -r file; do
        cmp -s "$folder/new/$file" "$tree/$file" && continue
        mkdir -p "$(dirname "$tree/$file")"
        cp "$folder/new/$file" "$tree/$file"
    done
    (cd "$tree" && find . -type f) | while read -r file; do
        [ -e "$folder/new/$file" ] || rm "$tree/$file"
    done
    rm -rf "$folder/new"
}

build() { # program ...
    cmake --build "$folder/build" -j "$jobs" --target "$@" > "$folder/build.log" 2>&1
}

# To the first failure; a defect may also let a case run on and on, or wait.
run() { # program, cases
    (ulimit -t 60 && timeout 600 "$folder/build/tests/$1" --gtest_fail_fast --gtest_filter="$2") > "$folder/run.log" 2>&1
}

# The case that failed, or that was running when the program died or its time ended.
noticed() {
    local name
    name=$(sed -n 's/^\[  FAILED  \] \([^ ,]*[.][^ ,]*\).*/\1/p' "$folder/run.log" | head -1)
    echo "${name:-$(sed -n 's/^\[ RUN      \] //p' "$folder/run.log" | tail -1)}"
}

copy
cmake -S "$tree" -B "$folder/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" -DHMF_BUILD_TESTS=ON \
    -DHMF_BUILD_CLI=OFF -DHMF_INSTALL=OFF > "$folder/configure.log" 2>&1 || {
    echo "not ok mutations: cmake failed, see $folder/configure.log"
    exit 1
}
read -r -d '' -a programs < <(table | awk '{ print $(NF - 1) }' | sort -u)
if [ ${#programs[@]} -eq 0 ]; then
    echo "skip mutations (skipped: no line matches $pattern)"
    exit 0
fi
build "${programs[@]}" || {
    echo "not ok mutations: the build failed"
    tail -20 "$folder/build.log"
    exit 1
}

failed=0
report() { # ok or not ok, text
    echo "$1 $2"
    [ "$1" = ok ] || failed=1
}

# Without a defect the same cases pass.
while read -r program cases; do
    if run "$program" "$cases" && grep -q '^\[  PASSED  \] [1-9]' "$folder/run.log"; then report ok "$program $cases"
    else report "not ok" "$program $cases fails without a defect, or selects no test"; fi
done < <(table | awk '{ print $(NF - 1), $NF }' | sort -u)

while read -r line; do
    file=${line%% *}
    program=$(awk '{ print $(NF - 1) }' <<< "$line")
    cases=${line##* }
    change=$(sed "s/^[^ ]* *//; s/ *$program *[^ ]*$//" <<< "$line")
    cp -p "$tree/$file" "$folder/original"
    sed "$change" "$folder/original" > "$tree/$file"
    if cmp -s "$folder/original" "$tree/$file"; then report "not ok" "$file: '$change' changes nothing"
    elif ! build "$program"; then report "not ok" "$file: with '$change' it does not compile"
    elif run "$program" "$cases"; then report "not ok" "$file: '$change' survives $program $cases"
    else report ok "$file: '$change' is noticed by $(noticed)"; fi
    cp "$folder/original" "$tree/$file" # a new time: what was built of the defect is built again
done < <(table)
exit $failed
