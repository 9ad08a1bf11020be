// Edge collapses of one level ([W] 4.1): the shortest edge goes first, to its
// midpoint, as long as the link condition holds.
//
// The queue is lazy. A collapse changes the length of a dozen edges, but their entries are not updated. An edge that
// became longer is put back when it is taken; one that became shorter is collapsed later than in the exact order. This
// matters only within one level, because each level starts with a new queue. A heap would keep the exact order at the
// cost of a dozen updates for each collapse.
//
// The first round keeps the mesh well shaped (no vertex of high degree, no inverted triangle). If it does not reach the
// target, the next round requires only the link condition.
//
// A marked vertex is the end that stays, and keeps its place; an edge between
// two of them is never collapsed.
//
// A large mesh is cut into blocks of vertices.  A collapse touches the two stars
// of its edge: if both lie in one block, that block alone performs it. For each length, all blocks collapse their edges
// in parallel; then the edges that cross a border are collapsed one by one:
//
//     +-----------+-----------+        o-o inside of its block
//     |  o-o      |      o-o  |        x-x touches a vertex with a
//     |        x--+--x        |            neighbor in another block
//     +-----------+-----------+
//
// Collapses of different blocks commute, so the log has those of one block after
// those of another.
#include "simplify.hpp"

#include "../base/prefetch.hpp"
#include "../base/sort_few.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr uint32_t MAX_DEGREE = 32;
// The sum for both ends of an edge, in a round that is not strict.
constexpr uint32_t MAX_TESTED_DEGREE = 512;

struct Placement {
    double position[3];
    double cost;
};

double squared_distance(const double* a, const double* b) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

void cross_product(const double* u, const double* v, double* n) {
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
}

double dot_product(const double* u, const double* v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

// Does a triangle of v with two consecutive neighbors turn by more than about
// 80 degrees if v moves to p?  others: a bit for each of the neighbors but the
// first and the last, by the lowest bits of its number.
bool turns_over(const WorkMesh& work, uint32_t v_number, const uint32_t* neighbor, uint32_t count, const double* p,
                uint64_t& others) {
    // Two of everything: before and after.
    const double* v = work.at(v_number);
    const double apex[3][2] = {{v[0], p[0]}, {v[1], p[1]}, {v[2], p[2]}};
    const double* a = work.at(neighbor[0]);
    uint64_t latest = 0;
    others = 0;
    for (uint32_t n = 1; n < count; ++n) {
        const double* b = work.at(neighbor[n]);
        const double x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
        double normal[3][2], square[2];
        for (int w = 0; w < 2; ++w) {
            const double to_x = apex[0][w] - a[0], to_y = apex[1][w] - a[1], to_z = apex[2][w] - a[2];
            normal[0][w] = y * to_z - z * to_y;
            normal[1][w] = z * to_x - x * to_z;
            normal[2][w] = x * to_y - y * to_x;
            square[w] = normal[0][w] * normal[0][w] + normal[1][w] * normal[1][w] + normal[2][w] * normal[2][w];
        }
        const double d = normal[0][0] * normal[0][1] + normal[1][0] * normal[1][1] + normal[2][0] * normal[2][1];
        if (!(d > 0) || d * d < 0.03 * square[0] * square[1]) return true;
        a = b;
        others |= latest;
        latest = uint64_t{1} << neighbor[n] % 64;
    }
    return false;
}

void add(Quadric& to, const Quadric& q) {
    for (int n = 0; n < 6; ++n) to.a[n] += q.a[n];
    for (int n = 0; n < 3; ++n) to.b[n] += q.b[n];
    to.c += q.c;
}

double value(const Quadric& q, const double* x) {
    const double* a = q.a;
    const double ax = a[0] * x[0] + a[1] * x[1] + a[2] * x[2], ay = a[1] * x[0] + a[3] * x[1] + a[4] * x[2];
    const double az = a[2] * x[0] + a[4] * x[1] + a[5] * x[2];
    const double sum = x[0] * ax + x[1] * ay + x[2] * az - 2 * dot_product(q.b, x) + q.c;
    return sum > 0 ? sum : 0;
}

// The minimum of the quadric by Cramer's rule; false if it is not a point.
bool minimum(const Quadric& q, double* x) {
    const double* a = q.a;
    const double r0[3] = {a[0], a[1], a[2]}, r1[3] = {a[1], a[3], a[4]}, r2[3] = {a[2], a[4], a[5]};
    double c0[3], c1[3], c2[3];
    cross_product(r1, r2, c0);
    cross_product(r2, r0, c1);
    cross_product(r0, r1, c2);
    const double determinant = dot_product(r0, c0), trace = a[0] + a[3] + a[5];
    if (!(determinant > 1e-12 * trace * trace * trace)) return false;
    for (int n = 0; n < 3; ++n) x[n] = (q.b[0] * c0[n] + q.b[1] * c1[n] + q.b[2] * c2[n]) / determinant;
    return true;
}

// Where the merged vertex of v and w goes by their quadrics, and what it costs.
Placement place_on_planes(const WorkMesh& work, uint32_t v, uint32_t w) {
    Placement result;
    const double *i = work.at(v), *j = work.at(w);
    Quadric q = work.quadrics[v];
    add(q, work.quadrics[w]);
    double best[3];
    const bool is_point = minimum(q, best);
    for (int c = 0; c < 3; ++c) result.position[c] = is_point ? best[c] + work.center[c] : 0.5 * (i[c] + j[c]);
    for (int c = 0; c < 3; ++c) best[c] = result.position[c] - work.center[c];
    result.cost = value(q, best);
    return result;
}

// A marked vertex stays where it is.
Placement place_on_mark(const WorkMesh& work, int32_t strategy, uint32_t v, uint32_t w) {
    Placement result;
    const double *i = work.at(v), *j = work.at(w), *mark = work.mesh.is_marked(v) ? i : j;
    for (int c = 0; c < 3; ++c) result.position[c] = mark[c];
    result.cost = squared_distance(i, j);
    if (strategy != HMF_COLLAPSE_QSLIM) return result;
    Quadric q = work.quadrics[v];
    add(q, work.quadrics[w]);
    double place[3];
    for (int c = 0; c < 3; ++c) place[c] = mark[c] - work.center[c];
    result.cost = value(q, place);
    return result;
}

// Where the merged vertex of an edge goes, and what the collapse costs.
inline Placement place(const WorkMesh& work, int32_t strategy, uint32_t h) {
    const uint32_t v = work.mesh.origin[h], w = work.mesh.target(h);
    if (work.mesh.is_marked(v) || work.mesh.is_marked(w)) return place_on_mark(work, strategy, v, w);
    if (strategy == HMF_COLLAPSE_QSLIM) return place_on_planes(work, v, w);
    Placement result;
    const double *i = work.at(v), *j = work.at(w);
    result.cost = squared_distance(i, j);
    for (int c = 0; c < 3; ++c) result.position[c] = strategy == HMF_COLLAPSE_ENDPOINT ? i[c] : 0.5 * (i[c] + j[c]);
    return result;
}

// Runs ahead of the edges that are taken from a list and prefetches their data. A list is complete when its first edge
// is taken.
class Scout {
public:
    void step(const WorkMesh& work, const BucketQueue& queue, uint32_t list) {
        if (list != list_) {
            list_ = list;
            far_ = near_ = queue.first(list);
            for (uint32_t n = 0; n < 2 * DISTANCE && far_ != NONE; ++n) {
                far_ = work.link[far_];
                if (n >= DISTANCE) near_ = work.link[near_];
            }
        }
        if (far_ != NONE) {
            prefetch(&work.mesh.origin[2 * far_]);
            prefetch(&work.mesh.face[2 * far_]);
            far_ = work.link[far_];
        }
        if (near_ != NONE) {
            prefetch(&work.mesh.next[2 * near_]);
            for (uint32_t side = 0; side < 2; ++side) {
                const uint32_t v = work.mesh.origin[2 * near_ + side];
                prefetch(work.at(v));
                prefetch(&work.degree[v]);
            }
            near_ = work.link[near_];
        }
    }

private:
    static constexpr uint32_t DISTANCE = 8;
    uint32_t list_ = NONE, far_ = NONE, near_ = NONE;
};

// The half-edge of an edge whose origin is kept by a collapse: a marked end, or the end with more neighbors, so that
// fewer half-edges are renamed.
uint32_t directed(const WorkMesh& work, uint32_t edge) {
    const uint32_t h = 2 * edge;
    if (work.mesh.is_marked(work.mesh.origin[h])) return h;
    if (work.mesh.is_marked(work.mesh.target(h))) return twin(h);
    return work.degree[work.mesh.target(h)] > work.degree[work.mesh.origin[h]] ? twin(h) : h;
}

// Conditions of a strict round: the link condition, moderate degrees, and no inverted triangle.
bool keeps_shape(WorkMesh& work, uint32_t h, const double* p) {
    const Mesh& mesh = work.mesh;
    const uint32_t i = mesh.origin[h], j = mesh.target(h), degree_i = work.degree[i], degree_j = work.degree[j];
    if (degree_i + degree_j > MAX_DEGREE + 4) return false;
    // Clockwise: j, l .. k around i, and i, k .. l around j.  One loop for both,
    // since each end of a loop is mispredicted; the smaller star comes round again.
    uint32_t round_i[MAX_DEGREE + 4], round_j[MAX_DEGREE + 4];
    const uint32_t longer = std::max(degree_j, degree_i);
    for (uint32_t n = 0, g = h, f = twin(h); n < longer; ++n) {
        round_i[n] = mesh.target(g);
        round_j[n] = mesh.target(f);
        g = mesh.rotate_cw(g);
        f = mesh.rotate_cw(f);
    }
    uint64_t others_i, others_j;
    if (turns_over(work, i, round_i + 1, degree_i - 1, p, others_i)
        || turns_over(work, j, round_j + 1, degree_j - 1, p, others_j))
        return false;
    // A second edge from i to j would be left with one end.
    if (work.has_double_edges) others_i |= uint64_t{1} << i % 64;
    // Without a common bit, k and l are the only common neighbors.
    return mesh.target(mesh.next[h]) != mesh.target(mesh.next[twin(h)])
        && ((others_i & others_j) == 0 || can_collapse(mesh, h, work.marks.data()));
}

void apply(WorkMesh& work, uint32_t h, const Placement& placement, bool with_quadrics, Collapse& record) {
    Mesh& mesh = work.mesh;
    const uint32_t i = mesh.origin[h], j = mesh.target(h);
    record = collapse(mesh, h);
    work.degree[i] += work.degree[j] - 4;
    --work.degree[mesh.origin[record.ki]];
    --work.degree[mesh.target(record.il)];
    for (int c = 0; c < 3; ++c) work.at(i)[c] = placement.position[c];
    if (with_quadrics) add(work.quadrics[i], work.quadrics[j]);
    const uint32_t removed[3] = {record.h, record.jk, record.lj};
    for (const uint32_t gone : removed) mesh.face[gone] = mesh.face[twin(gone)] = NONE;
    mesh.out[j] = NONE;
}

} // namespace

Done BucketQueue::allocate(Memory& memory) { return head_.allocate_filled(memory, BUCKETS, NONE); }

uint32_t BucketQueue::bucket(double cost) {
    uint64_t bits;
    std::memcpy(&bits, &cost, sizeof bits); // ordered like the costs: exponent, then 1 bit of the mantissa
    const uint64_t at = bits >> 51;
    return at < BUCKETS ? static_cast<uint32_t>(at) : BUCKETS - 1;
}

bool BucketQueue::empty() {
    while (low_ <= high_ && head_[low_] == NONE) ++low_;
    return low_ > high_;
}

void BucketQueue::clear() {
    for (; low_ <= high_; ++low_) head_[low_] = NONE;
    low_ = BUCKETS;
    high_ = 0;
}

Done WorkMesh::allocate(Memory& memory, const Mesh& all, bool with_quadrics) {
    mesh = all;
    vertex_end = all.vertex_count;
    edge_end = all.edge_count;
    face_end = all.face_count;
    find_blocks();
    // Coarser levels may have more blocks than this one, or none.
    const uint32_t most = std::min(MOST_BLOCKS, (vertex_end >> SMALLEST_BLOCK_SHIFT) + 1);
    for (uint32_t k = 0; k <= (block_count > 0 ? most : 0); ++k)
        if (!queue[k].allocate(memory)) return false;
    return degree.allocate(memory, vertex_end) && link.allocate(memory, std::max(vertex_end, edge_end))
        && marks.allocate_filled(memory, vertex_end, 0) && at_border.allocate(memory, vertex_end)
        && bucket.allocate(memory, edge_end) && (!with_quadrics || quadrics.allocate(memory, vertex_end));
}

// A small mesh has none: all its edges are in the last queue.
void WorkMesh::find_blocks() {
    block_shift = SMALLEST_BLOCK_SHIFT;
    while (vertex_end >> block_shift >= MOST_BLOCKS) ++block_shift;
    block_count = vertex_end >> (SMALLEST_BLOCK_SHIFT + 1) == 0 ? 0 : ((vertex_end - 1) >> block_shift) + 1;
}

void initial_quadrics(WorkMesh& work) {
    const Mesh& mesh = work.mesh;
    for (int c = 0; c < 3; ++c) work.center[c] = work.position[c];
    for (Quadric& q : work.quadrics) q = Quadric{};
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        // One third of the triangle's area for each of its corners.
        const double* corner = work.at(mesh.origin[h]);
        const double *a = work.at(mesh.target(h)), *b = work.at(mesh.origin[mesh.prev(h)]);
        double p[3], u[3], v[3], n[3];
        for (int c = 0; c < 3; ++c) {
            p[c] = corner[c] - work.center[c];
            u[c] = a[c] - corner[c];
            v[c] = b[c] - corner[c];
        }
        cross_product(u, v, n);
        const double square = dot_product(n, n), size = std::sqrt(square);
        if (!(size > 0)) continue;
        const double w = size / 6, d = dot_product(n, p) / size;
        for (int c = 0; c < 3; ++c) n[c] /= size;
        // A little of the distance to the vertex itself: a minimum exists on
        // flat parts too, and short edges go first there.
        const double own = 1e-3 * w;
        const Quadric q = {{w * n[0] * n[0] + own, w * n[0] * n[1], w * n[0] * n[2], w * n[1] * n[1] + own,
                            w * n[1] * n[2], w * n[2] * n[2] + own},
                           {w * d * n[0] + own * p[0], w * d * n[1] + own * p[1], w * d * n[2] + own * p[2]},
                           w * d * d + own * dot_product(p, p)};
        add(work.quadrics[mesh.origin[h]], q);
    }
}

namespace {

// One level.
class Collapser {
public:
    Collapser(WorkMesh& work, int32_t strategy, uint32_t edge_target, uint32_t vertex_minimum, Collapse* log,
              size_t& log_count, Array<CollapseRun>& runs, uint32_t* scratch, Call& call, double from, double to) :
        work_(work),
        mesh_(work.mesh), strategy_(strategy), edge_target_(edge_target), vertex_minimum_(vertex_minimum), log_(log),
        log_count_(log_count), runs_(runs), list_(scratch), call_(call), from_(from), to_(to),
        edges_before_(work.mesh.edge_count) {}

    hmf_status run() {
        work_.find_blocks();
        // Each round but the last two collapses something.
        while (left() > 0) {
            const uint32_t edges_at_round = mesh_.edge_count;
            if (!fill_queues() || !drain_queues()) return call_.stopped();
            for (uint32_t k = 0; k <= work_.block_count; ++k) work_.queue[k].clear();
            if (mesh_.edge_count == edges_at_round) {
                if (!strict_) break;
                strict_ = false;
            } else if (edges_at_round - mesh_.edge_count < edges_at_round / 64) {
                strict_ = false; // not enough for another strict round
            }
        }
        return HMF_OK;
    }

private:
    // How many collapses there should still be.
    uint32_t left() const {
        if (mesh_.edge_count <= edge_target_ || mesh_.vertex_count <= vertex_minimum_) return 0;
        return std::min((mesh_.edge_count - edge_target_ + 2) / 3, mesh_.vertex_count - vertex_minimum_);
    }

    BucketQueue& border_queue() { return work_.queue[work_.block_count]; }
    bool touches_border(uint32_t e) const {
        return work_.at_border[mesh_.origin[2 * e]] | work_.at_border[mesh_.origin[2 * e + 1]];
    }
    bool is_in_two_blocks(uint32_t v, uint32_t w) const { return (v ^ w) >> work_.block_shift != 0; }

    Done fill_queues() {
        mark_borders();
        if (work_.block_count > 0 && call_.parallel.slots() > 1) return fill_in_blocks();
        // Backwards: lists give the latest first, so each is taken in order.
        for (uint32_t e = work_.edge_end; e-- > 0;) {
            if (e % 16384 == 0 && !call_.tick(from_)) return false;
            if (!work_.removed(e)) work_.queue[queue_of(e)].put(e, bucket_of(e), work_.link);
        }
        return true;
    }
    uint32_t queue_of(uint32_t e) const {
        return touches_border(e) ? work_.block_count : mesh_.origin[2 * e] >> work_.block_shift;
    }
    uint32_t bucket_of(uint32_t e) const { return BucketQueue::bucket(place(work_, strategy_, 2 * e).cost); }

    void mark_borders() {
        const Parallel& parallel = call_.parallel;
        const uint8_t all = work_.block_count == 0;
        parallel.for_blocks(work_.vertex_end,
                            [&](size_t begin, size_t end) { std::memset(&work_.at_border[begin], all, end - begin); });
        if (all) return;
        // Edges between two blocks, listed where they are.
        const size_t size = Parallel::pass_block(work_.edge_end);
        uint32_t listed[Parallel::MOST_PARTS];
        parallel.for_blocks(work_.edge_end, size, [&](size_t begin, size_t end) {
            const uint32_t *const origin = mesh_.origin, shift = work_.block_shift;
            uint32_t* const list = &work_.link[begin];
            uint32_t count = 0;
            for (uint32_t e = static_cast<uint32_t>(begin); e < end; ++e) { // removed ones have their origins
                list[count] = e;
                count += (origin[2 * e] ^ origin[2 * e + 1]) >> shift != 0;
            }
            listed[begin / size] = count;
        });
        for (size_t begin = 0; begin < work_.edge_end; begin += size)
            for (uint32_t n = 0; n < listed[begin / size]; ++n) {
                const uint32_t e = work_.link[begin + n];
                if (!work_.removed(e))
                    work_.at_border[mesh_.origin[2 * e]] = work_.at_border[mesh_.origin[2 * e + 1]] = 1;
            }
    }

    // Sorted by queue; then each queue takes its own, all at the same time, in the same order.
    Done fill_in_blocks() {
        constexpr uint32_t none = WorkMesh::MOST_BLOCKS + 1; // of removed edges
        uint32_t begin_of[none + 2];
        const auto find_queues = [&](size_t begin, size_t end) {
            for (uint32_t e = static_cast<uint32_t>(begin); e < end; ++e) {
                work_.link[e] = none;
                if (work_.removed(e)) continue;
                work_.link[e] = queue_of(e);
                work_.bucket[e] = static_cast<uint16_t>(bucket_of(e));
            }
        };
        if (!call_.pass(work_.edge_end, from_, find_queues)
            || !sort_by_few(
                work_.edge_end, none + 1, [&](uint32_t e) { return work_.link[e]; }, list_, begin_of, call_.parallel,
                call_.memory))
            return false;
        call_.parallel.for_each(work_.block_count + 1, [&](uint32_t k, uint32_t) {
            for (uint32_t n = begin_of[k + 1]; n-- > begin_of[k];)
                work_.queue[k].put(list_[n], work_.bucket[list_[n]], work_.link);
        });
        return true;
    }

    // List by list, the shortest edges first.
    Done drain_queues() {
        for (uint32_t now = 0; left() > 0 && find_lowest(now);) {
            const double done = static_cast<double>(edges_before_ - mesh_.edge_count);
            if (!call_.tick(from_ + (to_ - from_) * done / static_cast<double>(edges_before_ - edge_target_)))
                return false;
            // The last few where they come first.
            if (work_.block_count > 0 && left() >= 4 * work_.block_count) {
                if (!collapse_in_blocks(now)) return false;
            } else {
                for (uint32_t k = 0; k < work_.block_count; ++k) collapse_in_block(k, now);
            }
            if (!collapse_at_borders(now) || !end_run()) return false;
        }
        return true;
    }

    bool find_lowest(uint32_t& now) {
        now = NONE;
        for (uint32_t k = 0; k <= work_.block_count; ++k)
            if (!work_.queue[k].empty()) now = std::min(now, work_.queue[k].lowest());
        return now != NONE;
    }

    // What became of an edge: dropped because it is gone, longer by now or not fit.
    enum class Fate : uint8_t { dropped, collapsed, handed_over };

    Fate take(BucketQueue& queue, uint32_t now, bool in_block, Collapse& record) {
        const uint32_t e = queue.take(work_.link);
        if (work_.removed(e)) return Fate::dropped;
        if (in_block && touches_border(e)) {
            queue.set_aside(e, work_.link);
            return Fate::handed_over;
        }
        const uint32_t h = directed(work_, e);
        if (mesh_.is_marked(mesh_.target(h))) return Fate::dropped; // both ends
        const Placement placement = place(work_, strategy_, h);
        const uint32_t bucket = BucketQueue::bucket(placement.cost);
        if (bucket > now) {
            queue.put(e, bucket, work_.link);
            return Fate::dropped;
        }
        if (strict_ ? !keeps_shape(work_, h, placement.position) : !is_possible(h)) return Fate::dropped;
        apply(work_, h, placement, strategy_ == HMF_COLLAPSE_QSLIM, record);
        return Fate::collapsed;
    }

    // The link condition, where it is tested in bounded time: edges at a vertex of higher degree stay until
    // collapses around it have lowered its degree.
    bool is_possible(uint32_t h) {
        return work_.degree[mesh_.origin[h]] + work_.degree[mesh_.target(h)] <= MAX_TESTED_DEGREE
            && can_collapse(mesh_, h, work_.marks.data());
    }

    // At most `most` collapses of a block.  Returns how many.
    uint32_t collapse_some(uint32_t block, uint32_t now, uint32_t most, Collapse* record) {
        BucketQueue& queue = work_.queue[block];
        Scout scout;
        uint32_t count = 0;
        while (count < most && !queue.empty() && queue.lowest() <= now) {
            scout.step(work_, queue, queue.lowest());
            count += take(queue, now, true, record[count]) == Fate::collapsed;
        }
        return count;
    }

    // What is in the log and in no run becomes one, as a part of the last one if that stands alone.
    Done end_run() {
        const uint32_t end = static_cast<uint32_t>(log_count_);
        if (end == in_runs_) return true;
        in_runs_ = end;
        if (last_stands_alone_) {
            runs_.back().end = end;
            return true;
        }
        last_stands_alone_ = true;
        return runs_.push({end, static_cast<uint32_t>(runs_.size())});
    }
    // A run for each block, unless there are too few collapses for that.
    Done end_runs(const uint32_t* end) {
        if (log_count_ - in_runs_ < WorkMesh::LEAST_GROUP) return end_run();
        const uint32_t group = static_cast<uint32_t>(runs_.size());
        for (uint32_t k = 0; k < work_.block_count; ++k) {
            if (end[k] == in_runs_) continue;
            in_runs_ = end[k];
            if (!runs_.push({end[k], group})) return false;
        }
        last_stands_alone_ = false;
        return true;
    }

    void count_collapses(uint32_t count) {
        log_count_ += count;
        mesh_.vertex_count -= count;
        mesh_.edge_count -= 3 * count;
        mesh_.face_count -= 2 * count;
    }

    void collapse_in_block(uint32_t block, uint32_t now) {
        count_collapses(collapse_some(block, now, left(), log_ + log_count_));
    }

    // Each block gets an equal share of the remaining collapses, in a part of the log of its own.
    Done collapse_in_blocks(uint32_t now) {
        const uint32_t share = left() / work_.block_count;
        uint32_t count[WorkMesh::MOST_BLOCKS], end[WorkMesh::MOST_BLOCKS];
        Collapse* const log = log_ + log_count_;
        call_.parallel.for_each(work_.block_count, [&](uint32_t block, uint32_t) {
            count[block] = collapse_some(block, now, share, log + size_t{block} * share);
        });
        for (uint32_t block = 0; block < work_.block_count; ++block) {
            std::memmove(log_ + log_count_, log + size_t{block} * share, count[block] * sizeof(Collapse));
            count_collapses(count[block]);
            end[block] = static_cast<uint32_t>(log_count_);
        }
        return end_runs(end);
    }

    Done collapse_at_borders(uint32_t now) {
        for (uint32_t k = 0; k < work_.block_count; ++k)
            for (uint32_t e = work_.queue[k].take_aside(work_.link); e != NONE;
                 e = work_.queue[k].take_aside(work_.link))
                border_queue().put(e, now, work_.link);
        BucketQueue& queue = border_queue();
        Scout scout;
        while (left() > 0 && !queue.empty() && queue.lowest() <= now) {
            scout.step(work_, queue, queue.lowest());
            if (++steps_ % 8192 == 0 && !call_.tick(from_)) return false;
            Collapse& record = log_[log_count_];
            if (take(queue, now, false, record) != Fate::collapsed) continue;
            count_collapses(1);
            if (work_.block_count > 0) mark_border(mesh_.origin[record.il]);
        }
        return true;
    }

    // The vertex has new neighbors, which may lie in other blocks.
    void mark_border(uint32_t v) {
        for (const uint32_t h : mesh_.around(v)) {
            const uint32_t w = mesh_.target(h);
            if (is_in_two_blocks(v, w)) work_.at_border[v] = work_.at_border[w] = 1;
        }
    }

    WorkMesh& work_;
    Mesh& mesh_;
    int32_t strategy_;
    uint32_t edge_target_, vertex_minimum_;
    Collapse* log_;
    size_t& log_count_;
    Array<CollapseRun>& runs_;
    uint32_t* const list_; // of edges, by queue
    Call& call_;
    double from_, to_;
    uint32_t edges_before_, steps_ = 0;
    uint32_t in_runs_ = static_cast<uint32_t>(log_count_); // collapses that are
    bool last_stands_alone_ = false;                       // the last run of this level
    bool strict_ = true;
};

} // namespace

hmf_status collapse_level(WorkMesh& work, int32_t strategy, uint32_t edge_target, uint32_t vertex_minimum,
                          Collapse* log, size_t& log_count, Array<CollapseRun>& runs, uint32_t* scratch, Call& call,
                          double from, double to) {
    return Collapser(work, strategy, edge_target, vertex_minimum, log, log_count, runs, scratch, call, from, to).run();
}

} // namespace hmf
