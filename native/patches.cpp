// Patches of elements that resist a change of volume: the loops of mechanics/patch_dilatation.py, where they are explained.
#include <algorithm>
#include <cmath>
#include <vector>

#include "arrays.hpp"

namespace {

using Int = int64_t;

// An element in the deformed shape: gradients of its shape functions, and its share of the patch's volume times J.
struct Spatial {
    double slope[4][3];
    double weight;
};

// Patches as they come from Python: nodes of each, its elements, where in it their corners stand.
struct Patches {
    Int count, width, members, corners, dim;
    const double *displacements, *gradients, *shares;
    const Int *stencils, *starts, *places;

    Patches(const Reals<2>& displacements, const Counts<2>& stencils, const Counts<1>& starts, const Counts<2>& places,
            const Reals<3>& gradients, const Reals<1>& shares)
        : count((Int)stencils.shape(0)), width((Int)stencils.shape(1)), members((Int)places.shape(0)),
          corners((Int)places.shape(1)), dim((Int)displacements.shape(1)), displacements(displacements.data()),
          gradients(gradients.data()), shares(shares.data()), stencils(stencils.data()), starts(starts.data()),
          places(places.data()) {
        demand((dim == 2 || dim == 3) && corners == dim + 1 && (Int)starts.shape(0) == count + 1 &&
                   (Int)gradients.shape(0) == members && (Int)gradients.shape(1) == corners && gradients.shape(2) == 3 &&
                   (Int)shares.shape(0) == members, "shapes of the patches");
        for (Int place = 0; place < count * width; place++)
            demand(this->stencils[place] >= 0 && this->stencils[place] < (Int)displacements.shape(0), "a corner is no node");
        for (Int place = 0; place < members * corners; place++)
            demand(this->places[place] >= 0 && this->places[place] < width, "a corner is not in its patch");
        demand(this->starts[0] == 0 && this->starts[count] == members, "patches hold all elements");
        for (Int patch = 0; patch < count; patch++) demand(this->starts[patch] <= this->starts[patch + 1], "patches rise");
    }

    Int largest() const {
        Int most = 0;
        for (Int patch = 0; patch < count; patch++) most = std::max(most, starts[patch + 1] - starts[patch]);
        return most;
    }

    // J - 1 of an element without cancellation, from G = F - I, padded to 3 x 3.
    double change(Int patch, Int member, double (&G)[3][3]) const {
        for (auto& row : G)
            for (double& entry : row) entry = 0.0;
        for (Int corner = 0; corner < corners; corner++) {
            const double* moved = displacements + dim * stencils[patch * width + places[member * corners + corner]];
            const double* rest = gradients + 3 * (member * corners + corner);
            for (Int row = 0; row < dim; row++)
                for (Int column = 0; column < dim; column++) G[row][column] += moved[row] * rest[column];
        }
        const double minors = G[0][0] * G[1][1] - G[0][1] * G[1][0] + G[0][0] * G[2][2] - G[0][2] * G[2][0] +
                              G[1][1] * G[2][2] - G[1][2] * G[2][1];
        const double determinant = G[0][0] * (G[1][1] * G[2][2] - G[1][2] * G[2][1]) -
                                   G[0][1] * (G[1][0] * G[2][2] - G[1][2] * G[2][0]) +
                                   G[0][2] * (G[1][0] * G[2][1] - G[1][1] * G[2][0]);
        return G[0][0] + G[1][1] + G[2][2] + minors + determinant;
    }

    // F^-T grad N of each corner, from G = F - I.
    void push(Int member, double (&G)[3][3], double J, Spatial& found) const {
        for (int i = 0; i < 3; i++) G[i][i] += 1.0;
        for (int i = 0; i < 3; i++) {
            const int p = (i + 1) % 3, q = (i + 2) % 3;
            double row[3];
            for (int j = 0; j < 3; j++) {
                const int r = (j + 1) % 3, s = (j + 2) % 3;
                row[j] = (G[p][r] * G[q][s] - G[p][s] * G[q][r]) / J;
            }
            for (Int corner = 0; corner < corners; corner++) {
                const double* rest = gradients + 3 * (member * corners + corner);
                found.slope[corner][i] = row[0] * rest[0] + row[1] * rest[1] + row[2] * rest[2];
            }
        }
    }

    // J - 1 of a patch; dJ/dx at its nodes, and its elements in the deformed shape.
    double differentiate(Int patch, Spatial* spatials, double* slope) const {
        std::fill(slope, slope + width * dim, 0.0);
        double mean = 0.0, G[3][3];
        for (Int member = starts[patch]; member < starts[patch + 1]; member++) {
            Spatial& spatial = spatials[member - starts[patch]];
            const double moved = change(patch, member, G);
            push(member, G, 1.0 + moved, spatial);
            mean += shares[member] * moved;
            spatial.weight = shares[member] * (1.0 + moved);
            for (Int corner = 0; corner < corners; corner++)
                for (Int i = 0; i < dim; i++)
                    slope[places[member * corners + corner] * dim + i] += spatial.weight * spatial.slope[corner][i];
        }
        return mean;
    }
};

// J - 1 of each patch: the mean over its elements, by their volumes.
void patch_changes(Reals<2> displacements, Array<double, 1> changes, Counts<2> stencils, Counts<1> starts, Counts<2> places,
                   Reals<3> gradients, Reals<1> shares) {
    const Patches all(displacements, stencils, starts, places, gradients, shares);
    demand((Int)changes.shape(0) == all.count, "a change for each patch");
    double G[3][3];
    for (Int patch = 0; patch < all.count; patch++) {
        double mean = 0.0;
        for (Int member = all.starts[patch]; member < all.starts[patch + 1]; member++)
            mean += all.shares[member] * all.change(patch, member, G);
        changes.data()[patch] = mean;
    }
}

// V lambda ln J / J dJ/dx of each patch.
void patch_gradient(Reals<2> displacements, Reals<1> moduli, Array<double, 3> blocks, Counts<2> stencils, Counts<1> starts,
                    Counts<2> places, Reals<3> gradients, Reals<1> shares) {
    const Patches all(displacements, stencils, starts, places, gradients, shares);
    demand((Int)moduli.shape(0) == all.count && (Int)blocks.shape(0) == all.count && (Int)blocks.shape(1) == all.width &&
               (Int)blocks.shape(2) == all.dim, "a modulus and a block for each patch");
    std::vector<Spatial> spatials(all.largest());
    for (Int patch = 0; patch < all.count; patch++) {
        double* slope = blocks.data() + patch * all.width * all.dim;
        const double change = all.differentiate(patch, spatials.data(), slope);
        const double factor = moduli.data()[patch] * std::log1p(change) / (1.0 + change);
        for (Int place = 0; place < all.width * all.dim; place++) slope[place] *= factor;
    }
}

// V lambda ((1 - ln J) / J^2 dJ dJ^T + ln J / J d2J) of each patch.
void patch_hessian(Reals<2> displacements, Reals<1> moduli, double projection, Array<double, 3> blocks, Counts<2> stencils,
                   Counts<1> starts, Counts<2> places, Reals<3> gradients, Reals<1> shares) {
    const Patches all(displacements, stencils, starts, places, gradients, shares);
    const Int dim = all.dim, size = all.width * dim;
    demand((Int)moduli.shape(0) == all.count && (Int)blocks.shape(0) == all.count && (Int)blocks.shape(1) == size &&
               (Int)blocks.shape(2) == size, "a modulus and a block for each patch");
    std::vector<Spatial> spatials(all.largest());
    std::vector<double> slope(size);
    Free others(500.0 * (double)all.members);
    for (Int patch = 0; patch < all.count; patch++) {
        const double change = all.differentiate(patch, spatials.data(), slope.data());
        const double log_j = std::log1p(change), J = 1.0 + change;
        double* block = blocks.data() + patch * size * size;
        double straight = moduli.data()[patch] * (1.0 - log_j) / (J * J);
        if (straight < 0.0) straight -= projection * straight;
        for (Int row = 0; row < size; row++)
            for (Int column = 0; column < size; column++) block[row * size + column] = straight * slope[row] * slope[column];
        for (Int member = all.starts[patch]; member < all.starts[patch + 1]; member++) {
            const Spatial& spatial = spatials[member - all.starts[patch]];
            const double bend = moduli.data()[patch] * log_j / J * spatial.weight;
            const double along = bend - projection * bend * (bend > 0.0 ? 1.0 / (double)dim : 1.0 - 1.0 / (double)dim);
            const double crossed = 0.5 * projection * bend - bend, plain = 0.5 * projection * std::abs(bend);
            for (Int a = 0; a < all.corners; a++)
                for (Int b = 0; b < all.corners; b++) {
                    const double *one = spatial.slope[a], *two = spatial.slope[b];
                    const Int row = all.places[member * all.corners + a] * dim, column = all.places[member * all.corners + b] * dim;
                    double product = 0.0;
                    for (Int i = 0; i < dim; i++) product += one[i] * two[i];
                    for (Int i = 0; i < dim; i++)
                        for (Int j = 0; j < dim; j++)
                            block[(row + i) * size + column + j] +=
                                along * one[i] * two[j] + crossed * one[j] * two[i] + (i == j ? plain * product : 0.0);
                }
        }
    }
}

}  // namespace

void add_patches(nb::module_& module) {
    module.def("patch_changes", &patch_changes, given(), filled(), given(), given(), given(), given(), given());
    module.def("patch_gradient", &patch_gradient, given(), given(), filled(), given(), given(), given(), given(), given());
    module.def("patch_hessian", &patch_hessian, given(), given(), given(), filled(), given(), given(), given(), given(), given());
}
