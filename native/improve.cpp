// One sweep over the nodes of tetrahedra: the loops of geometry/tetrahedra/improve.py, where the sum is explained.
#include <cmath>
#include <limits>

#include "arrays.hpp"

namespace {

using Int = int64_t;
const double NONE = std::numeric_limits<double>::infinity();
// The other corners p, q, r of a tetrahedron, so turned that (x - p) . ((q - p) x (r - p)) = 6 V.
const Int OTHERS[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};

// As std::pow, which takes long for powers that need none.
double raised(double value, double power) { return power == 0.0 ? 1.0 : power == 1.0 ? value : std::pow(value, power); }

struct Shape {
    double value, volume, squares, n[3], s[3];
};

struct Tetrahedra {
    double* nodes;
    const Int *elements, *start, *star, *facets, *begin, *ring;
    const double *normals, *offsets, *samples;
    Int count;
    double power, pull, regular;

    // Shape of a tetrahedron with a node at x, and what its derivatives need; infinite if it is turned over.
    Shape shape(const double* x, Int corner) const {
        const Int *element = elements + 4 * (corner / 4), *others = OTHERS[corner % 4];
        const double *p = nodes + 3 * element[others[0]], *q = nodes + 3 * element[others[1]];
        const double* r = nodes + 3 * element[others[2]];
        double px = x[0] - p[0], py = x[1] - p[1], pz = x[2] - p[2];
        double qx = q[0] - p[0], qy = q[1] - p[1], qz = q[2] - p[2];
        double rx = r[0] - p[0], ry = r[1] - p[1], rz = r[2] - p[2];
        double nx = qy * rz - qz * ry, ny = qz * rx - qx * rz, nz = qx * ry - qy * rx;
        double volume = (px * nx + py * ny + pz * nz) / 6.0;
        if (!(volume > 1e-12)) return {NONE, 0.0, 0.0, {}, {}};
        auto square = [](double a) { return a * a; };
        double squares = px * px + py * py + pz * pz + qx * qx + qy * qy + qz * qz + rx * rx + ry * ry + rz * rz;
        squares += square(px - qx) + square(py - qy) + square(pz - qz);
        squares += square(px - rx) + square(py - ry) + square(pz - rz);
        squares += square(qx - rx) + square(qy - ry) + square(qz - rz);
        return {regular * squares * std::pow(volume, -2.0 / 3.0), volume, squares, {nx / 6.0, ny / 6.0, nz / 6.0},
                {2.0 * (3.0 * px - qx - rx), 2.0 * (3.0 * py - qy - ry), 2.0 * (3.0 * pz - qz - rz)}};
    }

    double gap(const double* x, Int facet, Int own, Int sample) const {
        double total = -offsets[facet * count + sample];
        for (Int axis = 0; axis < 3; axis++) {
            double there = 0.0;
            for (Int corner = 0; corner < 3; corner++) {
                double at = corner == own ? x[axis] : nodes[3 * facets[3 * facet + corner] + axis];
                there += samples[3 * sample + corner] * at;
            }
            total += normals[3 * (facet * count + sample) + axis] * there;
        }
        return total;
    }

    // Whether the energy at x is less than a bound; no term is negative, so the sum ends where it reaches the bound.
    bool below(double bound, const double* x, Int node) const {
        double total = 0.0;
        for (Int place = start[node]; place < start[node + 1]; place++) {
            total += raised(shape(x, star[place]).value, power);
            if (!(total < bound)) return false;
        }
        for (Int place = begin[node]; place < begin[node + 1]; place++)
            for (Int sample = 0; sample < count; sample++) {
                double away = gap(x, ring[place] / 3, ring[place] % 3, sample);
                total += pull * away * away;
            }
        return total < bound;
    }

    // Energy where the node is, gradient, and the Hessian on and above its diagonal.
    double derivatives(Int node, double* slope, double (*bend)[3]) const {
        const double* x = nodes + 3 * node;
        double total = 0.0, first[3];
        for (Int i = 0; i < 3; i++) slope[i] = bend[i][0] = bend[i][1] = bend[i][2] = 0.0;
        for (Int place = start[node]; place < start[node + 1]; place++) {
            Shape one = shape(x, star[place]);
            if (one.value == NONE) return NONE;
            total += raised(one.value, power);
            const double *n = one.n, *s = one.s, volume = one.volume, squares = one.squares;
            for (Int i = 0; i < 3; i++) first[i] = one.value * (s[i] / squares - (2.0 / 3.0) * n[i] / volume);
            double outer = power * raised(one.value, power - 1.0);
            double again = power == 1.0 ? 0.0 : power * (power - 1.0) * raised(one.value, power - 2.0);
            for (Int i = 0; i < 3; i++) {
                slope[i] += outer * first[i];
                for (Int j = i; j < 3; j++) {
                    double second = (10.0 / 9.0) * n[i] * n[j] / (volume * volume);
                    second -= (2.0 / 3.0) * (n[i] * s[j] + s[i] * n[j]) / (volume * squares);
                    if (i == j) second += 6.0 / squares;
                    bend[i][j] += outer * one.value * second + again * first[i] * first[j];
                }
            }
        }
        for (Int place = begin[node]; place < begin[node + 1]; place++) {
            Int facet = ring[place] / 3, own = ring[place] % 3;
            for (Int sample = 0; sample < count; sample++) {
                double away = gap(x, facet, own, sample), weight = samples[3 * sample + own];
                const double* normal = normals + 3 * (facet * count + sample);
                total += pull * away * away;
                for (Int i = 0; i < 3; i++) {
                    slope[i] += 2.0 * pull * away * weight * normal[i];
                    for (Int j = i; j < 3; j++) bend[i][j] += 2.0 * pull * weight * weight * normal[i] * normal[j];
                }
            }
        }
        return total;
    }

    void move(Int node) {
        double slope[3], bend[3][3], x[3], share = 1.0, before = derivatives(node, slope, bend);
        if (!(before < NONE)) return;
        double a = bend[0][0], b = bend[0][1], c = bend[0][2], d = bend[1][1], e = bend[1][2], f = bend[2][2];
        double one = d * f - e * e, two = c * e - b * f, three = b * e - c * d;
        double size = a * one + b * two + c * three;
        if (!(size > 0.0)) return;
        double step[3] = {
            -(one * slope[0] + two * slope[1] + three * slope[2]) / size,
            -(two * slope[0] + (a * f - c * c) * slope[1] + (b * c - a * e) * slope[2]) / size,
            -(three * slope[0] + (b * c - a * e) * slope[1] + (a * d - b * b) * slope[2]) / size,
        };
        for (int halving = 0; halving < 8; halving++) {
            for (Int axis = 0; axis < 3; axis++) x[axis] = nodes[3 * node + axis] + share * step[axis];
            if (below(before, x, node)) {
                for (Int axis = 0; axis < 3; axis++) nodes[3 * node + axis] = x[axis];
                return;
            }
            share *= 0.5;
        }
    }
};

Tetrahedra mesh_of(const Array<double, 2>& nodes, const Counts<2>& elements, const Counts<1>& start, const Counts<1>& star,
                   const Counts<2>& facets, const Counts<1>& begin, const Counts<1>& ring, const Reals<3>& normals,
                   const Reals<2>& offsets, const Reals<2>& samples, double power, double pull) {
    const Int count = (Int)nodes.shape(0), samples_each = (Int)samples.shape(0), outer = (Int)facets.shape(0);
    demand(nodes.shape(1) == 3 && elements.shape(1) == 4 && facets.shape(1) == 3 && (Int)start.shape(0) == count + 1 &&
               (Int)begin.shape(0) == count + 1 && star.shape(0) == elements.size() && ring.shape(0) == facets.size(),
           "shapes of the mesh");
    demand((Int)normals.shape(0) == outer && (Int)normals.shape(1) == samples_each && normals.shape(2) == 3 &&
               (Int)offsets.shape(0) == outer && (Int)offsets.shape(1) == samples_each && samples.shape(1) == 3,
           "shapes of the planes");
    demand_range(elements, 0, count, "a corner is no node");
    demand_range(facets, 0, count, "a corner is no node");
    demand_range(start, 0, (Int)star.size() + 1, "a list of corners is too long");
    demand_range(begin, 0, (Int)ring.size() + 1, "a list of corners is too long");
    demand_range(star, 0, (Int)elements.size(), "no such corner");
    demand_range(ring, 0, (Int)facets.size(), "no such corner");
    // This makes the shape of a regular tetrahedron 1.
    const double regular = std::pow(std::sqrt(2.0) / 12.0, 2.0 / 3.0) / 6.0;
    return {nodes.data(), elements.data(), start.data(), star.data(), facets.data(), begin.data(),
            ring.data(), normals.data(), offsets.data(), samples.data(), samples_each, power, pull, regular};
}

// Move each node once, to where the sum of its own terms is least as far as a step of Newton tells.
void sweep(Array<double, 2> nodes, Counts<2> elements, Counts<1> start, Counts<1> star, Counts<2> facets, Counts<1> begin,
           Counts<1> ring, Reals<3> normals, Reals<2> offsets, Reals<2> samples, double power, double pull) {
    Tetrahedra all = mesh_of(nodes, elements, start, star, facets, begin, ring, normals, offsets, samples, power, pull);
    const Int count = (Int)nodes.shape(0);
    Free others(1e3 * (double)count);
    for (Int node = 0; node < count; node++) all.move(node);
}

// The sum of a node's own terms, its gradient, and its Hessian on and above the diagonal.
double node_derivatives(int64_t node, Array<double, 1> slope, Array<double, 2> bend, Array<double, 2> nodes, Counts<2> elements,
                        Counts<1> start, Counts<1> star, Counts<2> facets, Counts<1> begin, Counts<1> ring, Reals<3> normals,
                        Reals<2> offsets, Reals<2> samples, double power, double pull) {
    const Tetrahedra all = mesh_of(nodes, elements, start, star, facets, begin, ring, normals, offsets, samples, power, pull);
    demand(node >= 0 && node < (Int)nodes.shape(0) && slope.shape(0) == 3 && bend.shape(0) == 3 && bend.shape(1) == 3, "a node");
    return all.derivatives(node, slope.data(), (double(*)[3])bend.data());
}

}  // namespace

void add_improve(nb::module_& module) {
    module.def("sweep", &sweep, filled(), given(), given(), given(), given(), given(), given(), given(), given(),
               given(), given(), given());
    module.def("node_derivatives", &node_derivatives, given(), filled(), filled(), filled(), given(), given(), given(), given(),
               given(), given(), given(), given(), given(), given(), given());
}
