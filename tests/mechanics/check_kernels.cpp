// Prints what the kernels of native/ make of a small random body and of two fronts, for comparison between processors.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "kernels.hpp"

extern const Kernels kernels_base;

static uint64_t state = 1;
static double random_number() {  // -1 to 1, the same on every processor
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(state >> 33) / 1073741824.0 - 1.0;
}

static void print(const char* name, const std::vector<double>& numbers) {
    for (double number : numbers) std::printf("%s %.17g\n", name, number);
}

// Tetrahedra or triangles near the unit simplex, each with nodes of its own.
static void elements(int dim) {
    const int64_t terms = 19, groups = 3, corners = dim + 1, nodes = terms * corners, size = corners * dim;
    std::vector<int32_t> stencils(groups * corners * 8);
    std::vector<double> gradients(groups * corners * dim * 8), volumes(groups * 8), field(nodes * dim), step(nodes * dim);
    std::vector<double> mu(groups * 8, 3.0), lame(groups * 8, 10.0);
    for (int64_t term = 0; term < terms; term++) {
        const int64_t group = term / 8, lane = term % 8;
        volumes[term] = 1.0 + 0.3 * random_number();
        mu[term] += random_number(), lame[term] += random_number();
        for (int64_t corner = 0; corner < corners; corner++) {
            stencils[(group * corners + corner) * 8 + lane] = (int32_t)(term * corners + corner);
            for (int axis = 0; axis < dim; axis++)
                gradients[((group * corners + corner) * dim + axis) * 8 + lane] =
                    (corner == 0 ? -1.0 : corner == axis + 1 ? 1.0 : 0.0);
        }
    }
    for (double& number : field) number = 0.3 * random_number();
    for (double& number : step) number = 0.8 * random_number();
    std::vector<double> place(field);
    for (int64_t node = 0; node < nodes; node++)
        if (node % corners) place[node * dim + node % corners - 1] += 1.0;
    const Elements all{groups, terms, dim, stencils.data(), gradients.data(), volumes.data(), mu.data(), lame.data()};
    std::vector<double> forces(nodes * dim), bent(nodes * dim), data(terms * size * size);
    std::vector<int64_t> slots(terms * corners * corners), strides(nodes, size);
    for (int64_t term = 0; term < terms; term++)
        for (int64_t a = 0; a < corners; a++)
            for (int64_t b = 0; b < corners; b++)
                slots[(term * corners + a) * corners + b] = term * size * size + b * dim * size + a * dim;
    kernels_base.gradient(all, field.data(), forces.data());
    if (!kernels_base.hessian(all, field.data(), 0.7, {slots.data(), strides.data(), size, (int64_t)data.size(), data.data()}))
        std::abort();
    kernels_base.turn(all, place.data(), step.data(), bent.data());
    print("value", {kernels_base.value(all, field.data())});
    print("gradient", forces);
    print("hessian", data);
    print("turn", bent);
}

// A front that hands all its rows up to a second one; the matrix is indefinite.
static void factors() {
    const int64_t first = 21, second = 13, size = first + second;
    std::vector<double> data;
    std::vector<int32_t> entries;
    std::vector<int64_t> rows, diagonal(size);
    for (int64_t row = 0; row < second; row++) rows.push_back(first + row);
    int64_t split = 0;
    for (int64_t column = 0; column < size; column++) {
        const bool own = column < first;
        const int64_t high = own ? size : second, at = own ? column : column - first;
        if (column == first) split = (int64_t)data.size();
        for (int64_t row = at; row < high; row++) {
            entries.push_back((int32_t)data.size()), entries.push_back((int32_t)(at * high + row));
            if (row == at) diagonal[column] = (int64_t)data.size();
            data.push_back(random_number() + (row == at ? (column % 5 ? 9.0 : -9.0) : 0.0));
        }
    }
    const int64_t panel = first * size, all = panel + second * second, runs[3] = {0, 0, second};
    const int64_t table[33] = {first, second, 0, 0, 0, -1, -1, 0, 0, 0, 0,
                               second, 0, first, panel, second, 0, -1, 1, 0, 1, split,
                               0, 0, size, all, second, -1, -1, 0, 0, 1, (int64_t)data.size()};
    const Fronts fronts{2, size, table, rows.data(), runs, entries.data(), diagonal.data()};
    std::vector<double> lower(all + 8), signs(size), one(second * second + 8), two(second * second + 8), spare(size * 8 + 8);
    const int64_t negative = kernels_base.factorise(fronts, data.data(), lower.data(), signs.data(), one.data(), two.data(),
                                                    spare.data(), 1e-13);
    print("negative", {(double)negative});
    for (int sides : {1, 4, 8, 12, 16}) {
        std::vector<double> values(size * sides + 8), work(size * sides + 8);
        for (int64_t place = 0; place < size * sides; place++) values[place] = random_number();
        kernels_base.forward(fronts, lower.data(), values.data(), sides, work.data());
        for (int64_t row = 0; row < size; row++)
            for (int side = 0; side < sides; side++) values[row * sides + side] *= signs[row];
        kernels_base.backward(fronts, lower.data(), values.data(), sides, work.data());
        values.resize(size * sides);
        print("solve", values);
    }
}

int main() {
    elements(2);
    elements(3);
    factors();
    return 0;
}
