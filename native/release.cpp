// Which points of a surface have something straight above or below them: the loop of fabrication/moulds/release.py.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "arrays.hpp"

namespace {

using Int = int64_t;

// Whether triangles lie straight above and straight below each point; they are found by a grid of cells.
void find_covered(Reals<2> points, Reals<3> corners, Array<bool, 1> above, Array<bool, 1> below) {
    const Int count = (Int)corners.shape(0), asked = (Int)points.shape(0);
    demand(points.shape(1) == 3 && corners.shape(1) == 3 && corners.shape(2) == 3 && (Int)above.shape(0) == asked &&
               (Int)below.shape(0) == asked, "points and triangles in space");
    std::fill(above.data(), above.data() + asked, false);
    std::fill(below.data(), below.data() + asked, false);
    if (!count) return;
    double low[2], high[2];
    for (int axis = 0; axis < 2; axis++) {
        low[axis] = high[axis] = corners.data()[axis];
        for (Int place = 0; place < 3 * count; place++) {
            low[axis] = std::min(low[axis], corners.data()[3 * place + axis]);
            high[axis] = std::max(high[axis], corners.data()[3 * place + axis]);
        }
    }
    const double longest = std::max(high[0] - low[0], high[1] - low[1]);
    demand(longest < std::numeric_limits<double>::infinity(), "corners must be finite");
    const double even = std::sqrt((high[0] - low[0]) * (high[1] - low[1]) / (double)count) * 1.5;
    const double cell = std::max(even, longest / (double)count) + 1e-12;  // also of a surface seen edge-on
    const Int cells[2] = {(Int)((high[0] - low[0]) / cell) + 1, (Int)((high[1] - low[1]) / cell) + 1};
    auto cell_of = [&](double place, int axis) { return std::min((Int)((place - low[axis]) / cell), cells[axis] - 1); };
    auto each_cell = [&](Int triangle, auto&& call) {
        Int first[2], last[2];
        for (int axis = 0; axis < 2; axis++) {
            const double* at = corners.data() + 9 * triangle + axis;
            first[axis] = cell_of(std::min({at[0], at[3], at[6]}), axis);
            last[axis] = cell_of(std::max({at[0], at[3], at[6]}), axis);
        }
        for (Int x = first[0]; x <= last[0]; x++)
            for (Int y = first[1]; y <= last[1]; y++) call(x * cells[1] + y);
    };
    std::vector<Int> starts(cells[0] * cells[1] + 1);  // of each cell in the list of its triangles
    for (Int triangle = 0; triangle < count; triangle++) each_cell(triangle, [&](Int place) { starts[place + 1]++; });
    for (size_t place = 1; place < starts.size(); place++) starts[place] += starts[place - 1];
    std::vector<Int> listed(starts.back()), filled(starts.begin(), starts.end() - 1);
    for (Int triangle = 0; triangle < count; triangle++) each_cell(triangle, [&](Int place) { listed[filled[place]++] = triangle; });
    Free others(1e3 * (double)asked);
    for (Int point = 0; point < asked; point++) {
        const double px = points.data()[3 * point], py = points.data()[3 * point + 1], pz = points.data()[3 * point + 2];
        if (!(low[0] <= px && px <= high[0] && low[1] <= py && py <= high[1])) continue;
        const Int place = cell_of(px, 0) * cells[1] + cell_of(py, 1);
        for (Int entry = starts[place]; entry < starts[place + 1]; entry++) {
            const double *a = corners.data() + 9 * listed[entry], *b = a + 3, *c = a + 6;
            const double whole = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
            if (whole == 0.0) continue;
            const double one = ((b[0] - px) * (c[1] - py) - (c[0] - px) * (b[1] - py)) / whole;
            const double two = ((c[0] - px) * (a[1] - py) - (a[0] - px) * (c[1] - py)) / whole;
            if (one < 0.0 || two < 0.0 || one + two > 1.0) continue;
            const bool over = one * a[2] + two * b[2] + (1.0 - one - two) * c[2] > pz;
            (over ? above : below).data()[point] = true;
        }
    }
}

}  // namespace

void add_release(nb::module_& module) {
    module.def("find_covered", &find_covered, given(), given(), filled(), filled());
}
