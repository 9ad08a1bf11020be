// Charts: pieces of strips, joined in the plane where that saves seams and does
// not waste room.
#pragma once

#include "strips.hpp"

namespace hmf {

// (u, v) -> sign * (u, v) + (u, v of this): what can lie between two frames of a flat surface.
struct Motion {
    int64_t sign = 1, u = 0, v = 0;
    Motion after(const Motion& first) const { return {sign * first.sign, sign * first.u + u, sign * first.v + v}; }
    Motion inverse() const { return {sign, -sign * u, -sign * v}; }
};
inline bool operator==(const Motion& a, const Motion& b) { return a.sign == b.sign && a.u == b.u && a.v == b.v; }
// Some order of all motions.
inline bool operator<(const Motion& a, const Motion& b) {
    return a.sign != b.sign ? a.sign < b.sign : a.u != b.u ? a.u < b.u : a.v < b.v;
}

// A rectangle with sides along u and v.
struct Box {
    double u0 = 0, v0 = 0, u1 = 0, v1 = 0;
    double area() const { return (u1 - u0) * (v1 - v0); }
    void add(const Box& other);
};

struct JoinWish {
    double bonus = 0;   // room that a chart less is worth, as a part of the whole
    double rim = 0;     // room that a unit of the edge of a chart takes, in the unit of (u, v)
    double longest = 0; // side of a chart
};

class Charts {
public:
    Array<uint32_t> of_piece; // chart of each piece
    Array<Motion> motion;     // from the strip to the chart
    Array<Box> box;           // of each piece in its strip
    uint32_t count = 0;

    // Where pieces meet; once, before join.  triangle: length of a side.
    [[nodiscard]] hmf_status start(const Mesh& mesh, const SignBundle& bundle, const Strips& strips, double triangle,
                                   Call& call);
    [[nodiscard]] hmf_status join(const JoinWish& wish, Call& call);

    Box box_in_chart(uint32_t piece, const Motion& m) const { return moved(box[piece], m); }
    Box box_in_chart(uint32_t piece) const { return box_in_chart(piece, motion[piece]); }

private:
    // All sides of triangles where two pieces meet in the same way: motion leads from q to p.
    struct Contact {
        uint32_t p, q;
        Motion motion;
        int64_t u, v; // along it, with p on the left
    };
    struct Candidate {
        uint32_t a, b; // charts, a < b
        Motion motion; // from b to a
        double gain, score;
    };
    void find_boxes(const Strips& strips);
    [[nodiscard]] hmf_status find_contacts(const Mesh& mesh, const SignBundle& bundle, const Strips& strips,
                                           Call& call);
    double start_with_pieces();
    Done list_candidates();
    void keep_worthwhile(const JoinWish& wish, double whole);
    void merge(const Candidate& c);
    Done number_charts(Call& call);
    static Box moved(const Box& b, const Motion& m);
    double glued(uint32_t p, uint32_t q, const Motion& q_to_p, bool along_v) const;
    double covered(const Candidate& c, const Box& slot) const;
    bool fits(const Candidate& c) const;

    Array<Contact> contacts_;
    Array<Candidate> candidates_;
    Array<uint32_t> first_, next_; // pieces of each chart as lists
    Array<Box> chart_box_;
    double triangle_ = 0; // length of a side
};

} // namespace hmf
