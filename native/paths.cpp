// The search for paths of cables: the loops of design/routes/price.py. Edges are directed; `edge_of` is the undirected one.
#include <algorithm>
#include <cmath>
#include <limits>

#include "arrays.hpp"

namespace {

using Int = int64_t;
constexpr double NONE = -std::numeric_limits<double>::infinity();

void demand_within(const Int* numbers, Int size, Int low, Int high, const char* what) {
    for (Int place = 0; place < size; place++) demand(numbers[place] >= low && numbers[place] < high, what);
}

// Directed edges after which each one may follow, by the cosine of the turn; counted, and listed if there is room.
Int count_turns(Reals<2> points, Counts<1> offsets, Counts<1> sources, Counts<1> targets, Counts<1> reverses,
                Array<const bool, 1> blocked, double least, Array<int64_t, 1> counts, Array<int64_t, 1> before) {
    const Int edges = (Int)sources.shape(0), nodes = (Int)points.shape(0), dim = (Int)points.shape(1);
    demand((Int)targets.shape(0) == edges && (Int)reverses.shape(0) == edges && (Int)counts.shape(0) == edges + 1 &&
               (Int)offsets.shape(0) == nodes + 1 && (Int)blocked.shape(0) == nodes, "edges and points of one graph");
    const Int *from = demand_range(sources, 0, nodes, "no such point"), *to = demand_range(targets, 0, nodes, "no such point");
    const Int* begin = demand_range(offsets, 0, edges + 1, "no such edge");
    Int total = 0;
    for (Int edge = 0; edge < edges; edge++) {
        const Int here = from[edge], there = to[edge];
        counts.data()[edge] = total;
        if (blocked.data()[here]) continue;
        for (Int back = begin[here]; back < begin[here + 1]; back++) {
            const Int came = to[back];
            if (came == there) continue;
            double product = 0.0, one = 0.0, two = 0.0;
            for (Int axis = 0; axis < dim; axis++) {
                const double first = points.data()[here * dim + axis] - points.data()[came * dim + axis];
                const double second = points.data()[there * dim + axis] - points.data()[here * dim + axis];
                product += first * second, one += first * first, two += second * second;
            }
            if (!(product >= least * std::sqrt(one * two))) continue;
            if (total < (Int)before.shape(0)) before.data()[total] = reverses.data()[back];
            total++;
        }
    }
    counts.data()[edges] = total;
    return total;
}

// Shortest lead to the start of each directed edge, by sweeps until nothing changes.
void spread_leads(Counts<1> turns, Counts<1> before, Reals<1> lengths, Array<double, 1> leads, Array<int64_t, 1> origins,
                  double longest) {
    const Int edges = (Int)leads.shape(0);
    demand((Int)turns.shape(0) == edges + 1 && (Int)lengths.shape(0) == edges && (Int)origins.shape(0) == edges,
           "as many edges of each");
    const Int *begin = demand_range(turns, 0, (Int)before.shape(0) + 1, "no such turn"), *came = demand_range(before, 0, edges, "no such edge");
    for (bool changed = true; changed;) {
        changed = false;
        for (Int edge = 0; edge < edges; edge++)
            for (Int slot = begin[edge]; slot < begin[edge + 1]; slot++) {
                const double lead = leads.data()[came[slot]] + lengths.data()[came[slot]];
                if (!(lead < leads.data()[edge] - 1e-12 && lead <= longest)) continue;
                leads.data()[edge] = lead;
                origins.data()[edge] = came[slot];
                changed = true;
            }
    }
}

double dot(const double* one, const double* two, Int rows) {
    double sums[4] = {};
    Int row = 0;
    for (; row + 4 <= rows; row += 4)
        for (int lane = 0; lane < 4; lane++) sums[lane] += one[row + lane] * two[row + lane];
    double total = (sums[0] + sums[1]) + (sums[2] + sums[3]);
    for (; row < rows; row++) total += one[row] * two[row];
    return total;
}

// What a path gains in one pose: max over t in [0, most] of t pull - t^2 (square + ridge) / 2.
double decrease(double pull, double square, double ridge, double most) {
    if (pull <= 0.0) return 0.0;
    const double stiff = square + ridge;
    return pull >= most * stiff ? most * (pull - 0.5 * most * stiff) : 0.5 * pull * pull / stiff;
}

// r . m and |m|^2 of each undirected edge in each pose.
void edge_products(Reals<3> moves, Reals<3> residual, Array<double, 2> pulls, Array<double, 2> squares) {
    const Int edges = (Int)moves.shape(0), poses = (Int)moves.shape(1), rows = (Int)moves.shape(2);
    demand(residual.shape(0) == 1 && (Int)residual.shape(1) == poses && (Int)residual.shape(2) == rows &&
               (Int)pulls.shape(0) == edges && (Int)pulls.shape(1) == poses && (Int)squares.shape(0) == edges &&
               (Int)squares.shape(1) == poses, "as many edges, poses and rows");
    Free others((double)(edges * poses * rows));
    for (Int edge = 0; edge < edges; edge++)
        for (Int pose = 0; pose < poses; pose++) {
            const double* move = moves.data() + (edge * poses + pose) * rows;
            pulls.data()[edge * poses + pose] = dot(residual.data() + pose * rows, move, rows);
            squares.data()[edge * poses + pose] = dot(move, move, rows);
        }
}

// Gains of directed edges, and labels. Label `edge * slots + slot` is a path that ends with a directed edge. Its row of
// `labels` is what it moves, (poses, rows); of `sums` r . J of each pose, |J|^2 of each pose, the length it may still grow
// by, and the factor of its value. `marks` has a bit for each of its points, by their numbers modulo 64: a bit that is not
// set rules a point out. `values[hop]` is its gain, -inf for none; `parents[hop]` the label it grew from. The first half of
// the slots is for the largest gains, the rest for the largest r . J of those that are left: a long strong path that is
// not yet well aimed survives.
struct Gains {
    Int edges, poses, rows, slots;
    const double *lengths, *moves, *pulls, *squares, *ridge;
    double most;
    const Int* edge_of;

    Gains(const Counts<1>& edge_of, const Reals<1>& lengths, const Reals<3>& moves, const Reals<2>& pulls,
          const Reals<2>& squares, const Reals<1>& ridge, double most, Int labels)
        : edges((Int)edge_of.shape(0)), poses((Int)ridge.shape(0)), rows((Int)moves.shape(2)),
          slots(edges ? labels / edges : 0), lengths(lengths.data()), moves(moves.data()), pulls(pulls.data()),
          squares(squares.data()), ridge(ridge.data()), most(most),
          edge_of(demand_range(edge_of, 0, (Int)lengths.shape(0), "no such edge")) {
        const Int own = (Int)lengths.shape(0);
        demand((Int)moves.shape(0) == own && (Int)moves.shape(1) == poses && (Int)pulls.shape(0) == own &&
                   (Int)pulls.shape(1) == poses && (Int)squares.shape(0) == own && (Int)squares.shape(1) == poses &&
                   slots * edges == labels, "shapes of the gains");
    }
};

Int bit(Int point) { return (Int)((uint64_t)1 << (point & 63)); }

// Labels of one edge, in the first slot of each directed edge that may begin a path.
void first_labels(Counts<1> sources, Counts<1> targets, Counts<1> edge_of, Reals<1> lengths, Reals<1> begins, Reals<1> rooms,
                  Reals<3> moves, Reals<2> pulls, Reals<2> squares, Reals<1> ridge, double most, Array<double, 3> labels,
                  Array<double, 2> sums, Array<int64_t, 1> marks, Array<double, 1> values, Array<int64_t, 1> parents) {
    const Gains all(edge_of, lengths, moves, pulls, squares, ridge, most, (Int)values.shape(0));
    const Int count = all.edges * all.slots, width = 2 * all.poses + 2, size = all.poses * all.rows;
    demand((Int)labels.shape(0) == count && (Int)labels.shape(1) == all.poses && (Int)labels.shape(2) == all.rows &&
               (Int)sums.shape(0) == count && (Int)sums.shape(1) == width && (Int)marks.shape(0) == count &&
               (Int)parents.shape(0) == count && (Int)sources.shape(0) == all.edges && (Int)targets.shape(0) == all.edges &&
               (Int)begins.shape(0) == all.edges && (Int)rooms.shape(0) == all.edges, "shapes of the labels");
    std::fill(values.data(), values.data() + count, NONE);
    std::fill(parents.data(), parents.data() + count, (Int)-1);
    for (Int edge = 0; edge < all.edges; edge++) {
        const Int own = all.edge_of[edge], label = edge * all.slots;
        const double begin = begins.data()[edge], room = rooms.data()[edge];
        if (begin <= 0.0 || all.lengths[own] > room) continue;
        double* sum = sums.data() + label * width;
        double value = 0.0;
        for (Int pose = 0; pose < all.poses; pose++) {
            const double pull = all.pulls[own * all.poses + pose], square = all.squares[own * all.poses + pose];
            value += decrease(pull, square, all.ridge[pose], most);
            sum[pose] = pull, sum[all.poses + pose] = square;
        }
        sum[2 * all.poses] = room - all.lengths[own], sum[2 * all.poses + 1] = begin;
        values.data()[label] = value * begin;
        marks.data()[label] = bit(sources.data()[edge]) | bit(targets.data()[edge]);
        std::copy(all.moves + own * size, all.moves + (own + 1) * size, labels.data() + label * size);
    }
}

// Slots of the best labels: the first `sharp` by gain, the others by r . J of those that are left.
struct Slots {
    Int count, sharp;
    double *best, *ranked;
    Int* chosen;

    void clear() {
        std::fill(best, best + count, NONE);
        std::fill(ranked, ranked + count, NONE);
        std::fill(chosen, chosen + count, (Int)-1);
    }
    bool wants(double value, double price) const {
        return value > best[sharp - 1] || (count > sharp && price > ranked[count - 1]);
    }
    void insert(Int label, double value, double price) {
        if (value > best[sharp - 1]) sift(label, value, price, 0, sharp, value, best);
        if (label >= 0 && count > sharp && price > ranked[count - 1]) sift(label, value, price, sharp, count, price, ranked);
    }

  private:
    // Insert into slots sorted by `keys`, of which `key` is the candidate's; leaves what falls out at the end.
    void sift(Int& label, double& value, double& price, Int begin, Int end, double& key, double* keys) {
        for (Int slot = begin; slot < end; slot++)
            if (key > keys[slot]) std::swap(label, chosen[slot]), std::swap(value, best[slot]), std::swap(price, ranked[slot]);
    }
};

// Paths of one edge more: each directed edge keeps the best that end with it.
void grow_labels(Counts<1> turns, Counts<1> before, Counts<1> sources, Counts<1> targets, Counts<1> edge_of,
                 Array<const bool, 1> blocked, Reals<1> lengths, Reals<3> moves, Reals<2> pulls, Reals<2> squares,
                 Reals<1> ridge, double most, int64_t hop, Reals<3> labels, Reals<2> sums, Counts<1> marks,
                 Array<double, 2> values, Array<int64_t, 2> parents, Array<double, 3> longer, Array<double, 2> longer_sums,
                 Array<int64_t, 1> longer_marks, Array<double, 1> best, Array<double, 1> ranked, Array<int64_t, 1> chosen) {
    const Gains all(edge_of, lengths, moves, pulls, squares, ridge, most, (Int)values.shape(1));
    const Int count = all.edges * all.slots, poses = all.poses, width = 2 * poses + 2, size = poses * all.rows;
    demand(hop > 0 && hop < (Int)values.shape(0) && parents.shape(0) == values.shape(0) && (Int)parents.shape(1) == count, "no such hop");
    auto fits = [&](const auto& list, const auto& table, const auto& bits) {
        demand((Int)list.shape(0) == count && (Int)list.shape(1) == poses && (Int)list.shape(2) == all.rows &&
                   (Int)table.shape(0) == count && (Int)table.shape(1) == width && (Int)bits.shape(0) == count, "shapes of the labels");
    };
    fits(labels, sums, marks);
    fits(longer, longer_sums, longer_marks);
    demand((Int)turns.shape(0) == all.edges + 1 && (Int)blocked.shape(0) == all.edges && (Int)sources.shape(0) == all.edges &&
               (Int)targets.shape(0) == all.edges && (Int)best.shape(0) == all.slots && (Int)ranked.shape(0) == all.slots &&
               (Int)chosen.shape(0) == all.slots, "shapes of edges and slots");
    const Int *begin = demand_range(turns, 0, (Int)before.shape(0) + 1, "no such turn"), *came = demand_range(before, 0, all.edges, "no such edge");
    demand_within(parents.data(), hop * count, -1, count, "no such label");
    // Plain pointers, which the loops need not fetch again after each number that they write.
    const Int *from = sources.data(), *to = targets.data(), *mark = marks.data();
    const double *rows_of = labels.data(), *sums_of = sums.data(), *before_gains = values.data() + (hop - 1) * count;
    const double *edge_lengths = all.lengths, *ridge_of = all.ridge;
    const Int own_slots = all.slots, rows = all.rows, *edge_number = all.edge_of;
    double *gains = values.data() + hop * count, *longer_rows = longer.data(), *longer_sums_of = longer_sums.data();
    Int *parent = parents.data(), *longer_mark = longer_marks.data();
    Slots slots{own_slots, (own_slots + 1) / 2, best.data(), ranked.data(), chosen.data()};

    auto visits = [&](Int label, Int point) {  // whether the path of a label runs through a point
        if (to[label / own_slots] == point) return true;
        for (Int step = hop - 1;; step--) {
            if (from[label / own_slots] == point) return true;
            if (step == 0) return false;
            label = parent[step * count + label];
        }
    };
    Free others((double)before.shape(0) * (double)(own_slots * size));
    for (Int edge = 0; edge < all.edges; edge++) {
        const Int own = edge_number[edge], end = to[edge], end_bit = bit(end);
        const double *pull_of = all.pulls + own * poses, *square_of = all.squares + own * poses, *move = all.moves + own * size;
        const double length = edge_lengths[own];
        auto square_with = [&](Int label, Int pose) {
            const double cross = dot(rows_of + label * size + pose * rows, move + pose * rows, rows);
            return sums_of[label * width + poses + pose] + 2.0 * cross + square_of[pose];
        };
        slots.clear();
        if (!blocked.data()[edge])
            for (Int place = begin[edge], last = begin[edge + 1]; place < last; place++)
                for (Int label = came[place] * own_slots, stop = label + own_slots; label < stop; label++) {
                    const double* sum = sums_of + label * width;
                    if (before_gains[label] == NONE || length > sum[2 * poses]) continue;
                    double value = 0.0, price = 0.0;
                    for (Int pose = 0; pose < poses; pose++) {
                        const double pull = sum[pose] + pull_of[pose];
                        value += decrease(pull, square_with(label, pose), ridge_of[pose], most);
                        price += pull;
                    }
                    value *= sum[2 * poses + 1], price *= sum[2 * poses + 1];
                    if (!slots.wants(value, price)) continue;
                    if (mark[label] & end_bit && visits(label, end)) continue;
                    slots.insert(label, value, price);
                }
        for (Int slot = 0; slot < own_slots; slot++) {
            const Int label = slots.chosen[slot], grown = edge * own_slots + slot;
            gains[grown] = slots.best[slot];
            parent[hop * count + grown] = label;
            if (label < 0) continue;
            const double *sum = sums_of + label * width, *rows_before = rows_of + label * size;
            double *found = longer_sums_of + grown * width, *grown_rows = longer_rows + grown * size;
            for (Int pose = 0; pose < poses; pose++) {
                found[pose] = sum[pose] + pull_of[pose];
                found[poses + pose] = square_with(label, pose);
            }
            found[2 * poses] = sum[2 * poses] - length, found[2 * poses + 1] = sum[2 * poses + 1];
            longer_mark[grown] = mark[label] | end_bit;
            for (Int row = 0; row < size; row++) grown_rows[row] = rows_before[row] + move[row];
        }
    }
}

// Points of each path from its last to its first; -1 beyond it.
void walk_back(Counts<2> parents, Counts<1> sources, Counts<1> targets, int64_t slots, Counts<1> hops, Counts<1> labels,
               Array<int64_t, 2> paths) {
    const Int count = (Int)parents.shape(1), most = (Int)paths.shape(1);
    demand(slots > 0 && (Int)sources.shape(0) * slots == count && (Int)targets.shape(0) * slots == count &&
               hops.shape(0) == labels.shape(0) && paths.shape(0) == labels.shape(0) && most > 0, "shapes of the paths");
    demand_range(labels, 0, count, "no such label");
    demand_range(parents, -1, count, "no such label");
    demand_range(hops, -1, (Int)parents.shape(0), "no such hop");
    for (Int row = 0; row < (Int)labels.shape(0); row++) {
        Int label = labels.data()[row], hop = hops.data()[row];
        Int* path = paths.data() + row * most;
        path[0] = targets.data()[label / slots];
        for (Int place = 1; place < most; place++) {
            path[place] = -1;
            if (hop < 0 || label < 0) continue;
            path[place] = sources.data()[label / slots];
            label = parents.data()[hop * count + label];
            hop--;
        }
    }
}

// Share of their edges that two paths have in common.
double common_share(const Int* one, Int longest, const Int* two, Int other_longest) {
    auto edges_of = [](const Int* path, Int most) {
        Int count = 0;
        while (count + 1 < most && path[count + 1] >= 0) count++;
        return count;
    };
    const Int own = edges_of(one, longest), their = edges_of(two, other_longest);
    Int same = 0;
    for (Int i = 0; i < own; i++)
        for (Int j = 0; j < their; j++)
            same += (one[i] == two[j] && one[i + 1] == two[j + 1]) || (one[i] == two[j + 1] && one[i + 1] == two[j]);
    return (double)same / (double)std::min(own, their);
}

// The first usable path from `begin` on unlike all others; as many as there are paths if there is none.
Int next_unlike(Counts<2> paths, int64_t begin, Counts<2> others, Array<const bool, 1> usable, double alike) {
    const Int count = (Int)paths.shape(0), most = (Int)paths.shape(1), their = (Int)others.shape(1);
    demand(begin >= 0 && (Int)usable.shape(0) == count && their >= most, "shapes of the paths");
    for (Int index = begin; index < count; index++) {
        if (!usable.data()[index]) continue;
        const Int* path = paths.data() + index * most;
        bool unlike = true;
        for (Int row = 0; row < (Int)others.shape(0) && unlike; row++) {
            const Int* other = others.data() + row * their;
            unlike = !(common_share(path, most, other, their) > alike) && !std::equal(path, path + most, other);
        }
        if (unlike) return index;
    }
    return count;
}

}  // namespace

void add_paths(nb::module_& module) {
    module.def("count_turns", &count_turns, given(), given(), given(), given(), given(), given(), given(), filled(), filled());
    module.def("spread_leads", &spread_leads, given(), given(), given(), filled(), filled(), given());
    module.def("edge_products", &edge_products, given(), given(), filled(), filled());
    module.def("first_labels", &first_labels, given(), given(), given(), given(), given(), given(), given(), given(), given(),
               given(), given(), filled(), filled(), filled(), filled(), filled());
    module.def("grow_labels", &grow_labels, given(), given(), given(), given(), given(), given(), given(), given(), given(),
               given(), given(), given(), given(), given(), given(), given(), filled(), filled(), filled(), filled(), filled(),
               filled(), filled(), filled());
    module.def("walk_back", &walk_back, given(), given(), given(), given(), given(), given(), filled());
    module.def("next_unlike", &next_unlike, given(), given(), given(), given(), given());
    module.def("decrease", &decrease);
}
