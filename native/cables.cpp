// Cables and what all energies share: the loops of mechanics/cable.py, tension_law.py, energy.py and of least volumes.
#include <cmath>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bounds.hpp"
#include "eliminate.hpp"
#include "spring.hpp"

namespace {

using Int = int64_t;

// Each block of dim by dim numbers lies within the matrix: one for each pair of corners, its columns a stride apart.
void demand_blocks(const Counts<2>& stencils, const Counts<3>& slots, const Counts<1>& strides, Int dim, Int size) {
    Int terms = (Int)stencils.shape(0), corners = (Int)stencils.shape(1);
    const Int *stencil = stencils.data(), *stride = strides.data(), *slot = slots.data();
    demand_below(stencil, terms * corners, (Int)strides.shape(0), "a corner is no node");
    demand_below(stride, (Int)strides.shape(0), size + 1, "a column is longer than the matrix");
    Int widest = 0;
    for (Int place = 0; place < terms * corners; place++)
        widest = stride[stencil[place]] > widest ? stride[stencil[place]] : widest;
    Int last = (dim - 1) * widest + dim - 1;
    uint64_t wrong = 0, unsure = 0;
    for (Int i = 0; i < terms * corners * corners; i++) unsure |= outside(slot[i], size - last);
    if (unsure >> 63 == 0) return;
    for (Int term = 0; term < terms; term++)  // exactly, each with its own stride: only where blocks lie at the end
        for (Int a = 0; a < corners; a++)
            for (Int b = 0; b < corners; b++)
                wrong |= outside(slot[(term * corners + a) * corners + b],
                                 size - (dim - 1) * stride[stencil[term * corners + b]] - dim + 1);
    demand(wrong >> 63 == 0, "a block lies outside the matrix");
}

// Segments of cables as they come from Python.
struct Segments {
    Int terms, corners, dim;
    const double *nodes, *weights, *offsets, *roundings;
    const Int* stencils;

    Segments(const Reals<2>& nodes, const Counts<2>& stencils, const Reals<2>& weights, const Reals<2>& offsets,
             const Reals<1>& roundings)
        : terms((Int)stencils.shape(0)), corners((Int)stencils.shape(1)), dim((Int)nodes.shape(1)),
          nodes(nodes.data()), weights(weights.data()), offsets(offsets.data()), roundings(roundings.data()),
          stencils(stencils.data()) {
        demand((Int)weights.shape(0) == terms && (Int)weights.shape(1) == corners && (Int)offsets.shape(0) == terms &&
                   (Int)offsets.shape(1) == dim && (Int)roundings.shape(0) == terms, "as many segments of each");
        demand_below(this->stencils, terms * corners, (Int)nodes.shape(0), "a corner is no node");
    }

    // Length of a segment, and its span.
    double measure(Int term, double* span) const {
        double square = roundings[term] * roundings[term];
        for (Int axis = 0; axis < dim; axis++) {
            span[axis] = offsets[term * dim + axis];
            for (Int corner = 0; corner < corners; corner++)
                span[axis] += weights[term * corners + corner] * nodes[stencils[term * corners + corner] * dim + axis];
            square += span[axis] * span[axis];
        }
        return std::sqrt(square);
    }
};

void measure(Reals<2> nodes, Counts<2> stencils, Reals<2> weights, Reals<2> offsets, Reals<1> roundings,
             Array<double, 2> spans, Array<double, 1> lengths) {
    Segments all(nodes, stencils, weights, offsets, roundings);
    demand((Int)spans.shape(0) == all.terms && (Int)spans.shape(1) == all.dim && (Int)lengths.shape(0) == all.terms,
           "as many spans as segments");
    for (Int term = 0; term < all.terms; term++)
        lengths.data()[term] = all.measure(term, spans.data() + term * all.dim);
}

// Add up the lengths of the segments of each cable.
void lengths(Reals<2> nodes, Counts<2> stencils, Reals<2> weights, Reals<2> offsets, Reals<1> roundings,
             Counts<1> cables, Array<double, 1> total) {
    Segments all(nodes, stencils, weights, offsets, roundings);
    double span[3];
    demand((Int)cables.shape(0) == all.terms && all.dim <= 3, "as many segments of each");
    demand_below(cables.data(), all.terms, (Int)total.shape(0), "a segment of no cable");
    for (Int term = 0; term < all.terms; term++) total.data()[cables.data()[term]] += all.measure(term, span);
}

// T (I - u u^T) / length of every segment, spread to its nodes by the weights.
void bends(Reals<2> spans, Reals<1> lengths, Reals<2> weights, Reals<1> tensions, Array<double, 3> blocks) {
    Int terms = (Int)spans.shape(0), dim = (Int)spans.shape(1), corners = (Int)weights.shape(1), size = corners * dim;
    demand((Int)lengths.shape(0) == terms && (Int)weights.shape(0) == terms && (Int)tensions.shape(0) == terms &&
               (Int)blocks.shape(0) == terms && (Int)blocks.shape(1) == size && (Int)blocks.shape(2) == size,
           "as many segments of each");
    for (Int term = 0; term < terms; term++) {
        const double *span = spans.data() + term * dim, *share = weights.data() + term * corners;
        double length = lengths.data()[term], scale = tensions.data()[term] / length, square = length * length;
        double* block = blocks.data() + term * size * size;
        for (Int i = 0; i < dim; i++)
            for (Int j = 0; j < dim; j++) {
                double across = -span[i] * span[j] / square;
                if (i == j) across += 1.0;
                across *= scale;
                for (Int a = 0; a < corners; a++)
                    for (Int b = 0; b < corners; b++)
                        block[(a * dim + i) * size + b * dim + j] = share[a] * share[b] * across;
            }
    }
}

// Add T (I - u u^T) / length of every taut segment, spread to its nodes by the weights, to a sparse matrix.
void add_bends(Reals<2> spans, Reals<1> lengths, Reals<2> weights, Reals<1> pulls, Counts<2> stencils,
               Counts<3> slots, Counts<1> strides, Array<double, 1> data) {
    Int terms = (Int)spans.shape(0), dim = (Int)spans.shape(1), corners = (Int)weights.shape(1);
    demand((Int)lengths.shape(0) == terms && (Int)weights.shape(0) == terms && (Int)pulls.shape(0) == terms &&
               (Int)stencils.shape(0) == terms && (Int)stencils.shape(1) == corners &&
               (Int)slots.size() == terms * corners * corners && dim <= 3, "as many segments of each");
    demand((Int)slots.shape(0) == terms && (Int)slots.shape(1) == corners, "as many segments of each");
    demand_blocks(stencils, slots, strides, dim, (Int)data.shape(0));
    for (Int term = 0; term < terms; term++) {
        const double *span = spans.data() + term * dim, *share = weights.data() + term * corners;
        double pull = pulls.data()[term], square = lengths.data()[term] * lengths.data()[term], across[3][3];
        if (pull == 0.0) continue;
        for (Int i = 0; i < dim; i++)
            for (Int j = 0; j < dim; j++) across[i][j] = pull * ((i == j ? 1.0 : 0.0) - span[i] * span[j] / square);
        for (Int b = 0; b < corners; b++) {
            Int stride = strides.data()[stencils.data()[term * corners + b]];
            for (Int a = 0; a < corners; a++) {
                double weight = share[a] * share[b];
                double* block = data.data() + slots.data()[(term * corners + a) * corners + b];
                for (Int j = 0; j < dim; j++)
                    for (Int i = 0; i < dim; i++) block[j * stride + i] += weight * across[j][i];
            }
        }
    }
}

// Add the slopes of the length of each segment by its nodes, times its factor, to its column of a matrix.
void add_slopes(Reals<2> nodes, Counts<2> stencils, Reals<2> weights, Reals<2> offsets, Reals<1> roundings,
                Counts<1> columns, Reals<1> factors, Array<double, 3> total) {
    Segments all(nodes, stencils, weights, offsets, roundings);
    Int count = (Int)total.shape(2);
    double span[3];
    demand((Int)columns.shape(0) == all.terms && (Int)factors.shape(0) == all.terms && all.dim <= 3,
           "as many segments of each");
    demand(total.shape(0) == nodes.shape(0) && total.shape(1) == nodes.shape(1), "as many slopes as nodes");
    demand_below(columns.data(), all.terms, count, "a segment of no cable");
    for (Int term = 0; term < all.terms; term++) {
        double scale = factors.data()[term] / all.measure(term, span);
        double* column = total.data() + columns.data()[term];
        for (Int corner = 0; corner < all.corners; corner++) {
            Int place = term * all.corners + corner, first = all.stencils[place] * all.dim;
            for (Int axis = 0; axis < all.dim; axis++)
                column[(first + axis) * count] += all.weights[place] * (span[axis] * scale);
        }
    }
}

void evaluate(Reals<1> stiffness, Reals<1> smoothing, Reals<1> elongation, Array<double, 2> found) {
    Int count = (Int)stiffness.shape(0);
    demand((Int)smoothing.shape(0) == count && (Int)elongation.shape(0) == count && found.shape(0) == 3 &&
               (Int)found.shape(1) == count, "a number for each cable");
    double* out = found.data();
    for (Int cable = 0; cable < count; cable++) {
        Spring one = spring(stiffness.data()[cable], smoothing.data()[cable], elongation.data()[cable]);
        out[cable] = one.energy;
        out[count + cable] = one.tension;
        out[2 * count + cable] = one.slope;
    }
}

// Newton with a line search on T M T / 2 + U(elongations - M T); false if it does not arrive.
bool balance(Reals<1> stiffness, Reals<1> smoothing, Reals<1> elongations, Reals<2> compliance,
             Array<double, 1> tensions) {
    Int count = (Int)tensions.shape(0);
    demand((Int)stiffness.shape(0) == count && (Int)smoothing.shape(0) == count &&
               (Int)elongations.shape(0) == count && (Int)compliance.shape(0) == count &&
               (Int)compliance.shape(1) == count, "a number for each cable");
    const double *k = stiffness.data(), *eps = smoothing.data(), *given = elongations.data();
    const double* gives = compliance.data();
    double *tension = tensions.data(), value = 0.0;
    std::vector<double> matrix(count * count), change(count), trial(count), slopes(count), rest(given, given + count);
    for (Int cable = 0; cable < count; cable++) value += spring(k[cable], eps[cable], rest[cable]).energy;
    for (int round = 0; round < 30; round++) {
        double largest = 0.0, missing = 0.0, slope = 0.0, length = 1.0, reached = 0.0;
        for (Int cable = 0; cable < count; cable++) {
            Spring one = spring(k[cable], eps[cable], rest[cable]);
            slopes[cable] = one.slope;
            change[cable] = one.tension - tension[cable];
            largest = one.tension > largest ? one.tension : largest;
            missing = std::fabs(change[cable]) > missing ? std::fabs(change[cable]) : missing;
        }
        if (missing <= 1e-12 * largest) return true;
        for (Int row = 0; row < count; row++) {
            trial[row] = 0.0;
            for (Int column = 0; column < count; column++) {
                trial[row] += gives[row * count + column] * change[column];
                matrix[row * count + column] = slopes[row] * gives[row * count + column] + (row == column ? 1.0 : 0.0);
            }
        }
        if (!eliminate(matrix, change)) return false;
        for (Int cable = 0; cable < count; cable++) slope -= trial[cable] * change[cable];
        bool found = false;
        for (int halving = 0; halving < 12 && !found; halving++) {
            reached = 0.0;
            for (Int row = 0; row < count; row++) trial[row] = tension[row] + length * change[row];
            for (Int row = 0; row < count; row++) {
                double yielded = 0.0;
                for (Int column = 0; column < count; column++) yielded += gives[row * count + column] * trial[column];
                rest[row] = given[row] - yielded;
                reached += 0.5 * trial[row] * yielded + spring(k[row], eps[row], rest[row]).energy;
            }
            found = reached <= value + 1e-4 * length * slope + 1e-14 * std::fabs(value);
            length *= 0.5;
        }
        if (!found) return false;
        for (Int cable = 0; cable < count; cable++) tension[cable] = trial[cable];
        value = reached;
    }
    return false;
}

// Add the vector of every corner of every term to its node.
void add_vectors(Counts<2> stencils, Reals<3> vectors, Array<double, 2> total) {
    Int places = (Int)stencils.size(), dim = (Int)total.shape(1);
    demand((Int)vectors.size() == places * dim, "a vector for each corner");
    demand_below(stencils.data(), places, (Int)total.shape(0), "a corner is no node");
    for (Int place = 0; place < places; place++)
        for (Int axis = 0; axis < dim; axis++)
            total.data()[stencils.data()[place] * dim + axis] += vectors.data()[place * dim + axis];
}

// Add every dim x dim block of symmetric blocks to the values of the sparse matrix.
void add_blocks(Counts<2> stencils, Counts<3> slots, Counts<1> strides, Reals<3> blocks, Array<double, 1> data) {
    Int terms = (Int)stencils.shape(0), corners = (Int)stencils.shape(1), size = (Int)blocks.shape(1);
    demand((Int)blocks.shape(0) == terms && (Int)blocks.shape(2) == size && size % (corners > 0 ? corners : 1) == 0 &&
               (Int)slots.shape(0) == terms && (Int)slots.shape(1) == corners && (Int)slots.shape(2) == corners,
           "a block for each term");
    Int dim = corners > 0 ? size / corners : 0;
    demand_blocks(stencils, slots, strides, dim, (Int)data.shape(0));
    for (Int term = 0; term < terms; term++)
        for (Int b = 0; b < corners; b++) {
            Int stride = strides.data()[stencils.data()[term * corners + b]];
            for (Int a = 0; a < corners; a++) {
                Int start = slots.data()[(term * corners + a) * corners + b];
                for (Int j = 0; j < dim; j++)
                    for (Int i = 0; i < dim; i++)
                        data.data()[start + j * stride + i] +=
                            blocks.data()[(term * size + b * dim + j) * size + a * dim + i];
            }
        }
}

// J of the element that is squeezed most, by the spans of its corners; 1 if none is. `gradients` have three columns.
double least_volume(Reals<2> nodes, Counts<2> stencils, Reals<3> gradients, nb::tuple axes) {
    Int terms = (Int)stencils.shape(0), corners = (Int)stencils.shape(1), dim = (Int)nodes.shape(1);
    demand((dim == 2 || dim == 3) && dim == (Int)nb::len(axes) && corners == dim + 1 && (Int)gradients.shape(0) == terms &&
               (Int)gradients.shape(1) == corners && gradients.shape(2) == 3, "elements must be simplices");
    demand_below(stencils.data(), terms * corners, (Int)nodes.shape(0), "a corner is no node");
    double least = 1.0;
    Free others(10.0 * terms);
    for (Int term = 0; term < terms; term++) {
        const Int* corner = stencils.data() + term * corners;
        const double *g = gradients.data() + term * corners * 3, *o = nodes.data() + corner[0] * dim;
        const double *p = nodes.data() + corner[1] * dim, *q = nodes.data() + corner[2] * dim;
        double ax = p[0] - o[0], ay = p[1] - o[1], bx = q[0] - o[0], by = q[1] - o[1], found;
        if (dim == 2) {
            found = (ax * by - ay * bx) * (g[3] * g[7] - g[4] * g[6]);
        } else {
            const double* r = nodes.data() + corner[3] * dim;
            double az = p[2] - o[2], bz = q[2] - o[2], cx = r[0] - o[0], cy = r[1] - o[1], cz = r[2] - o[2];
            double scale = g[3] * (g[7] * g[11] - g[8] * g[10]) - g[4] * (g[6] * g[11] - g[8] * g[9]) +
                           g[5] * (g[6] * g[10] - g[7] * g[9]);
            found = (ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)) * scale;
        }
        least = found < least ? found : least;
    }
    return least;
}

}  // namespace

void add_cables(nb::module_& module) {
    module.def("measure", &measure, given(), given(), given(), given(), given(), filled(), filled());
    module.def("lengths", &lengths, given(), given(), given(), given(), given(), given(), filled());
    module.def("bends", &bends, given(), given(), given(), given(), filled());
    module.def("add_bends", &add_bends, given(), given(), given(), given(), given(), given(), given(), filled());
    module.def("add_slopes", &add_slopes, given(), given(), given(), given(), given(), given(), given(), filled());
    module.def("evaluate", &evaluate, given(), given(), given(), filled());
    module.def("balance", &balance, given(), given(), given(), given(), filled());
    module.def("add_vectors", &add_vectors, given(), given(), filled());
    module.def("add_blocks", &add_blocks, given(), given(), given(), given(), filled());
    module.def("least_volume", &least_volume, given(), given(), given(), given());
}
