// Loops over the pixels and corners of pictures: those of hydrostat/drawing, where they are explained.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "arrays.hpp"

namespace {

using Int = int64_t;
constexpr double NOTHING = -std::numeric_limits<double>::infinity();  // depth where nothing is seen
constexpr int SAMPLES = 40;                                           // neighbors asked how much of the sky they take

struct Offset {
    Int x, y;
};

double clamp(double value) { return value > 0.0 ? std::min(value, 1.0) : 0.0; }  // 0 where it is no number

// Share of the sky that each pixel sees past its neighbors, 0 to 1 (screen-space ambient occlusion).
void sky_shares(Reals<2> depths, Reals<3> normals, double reach, Array<float, 2> sky) {
    const Int height = (Int)depths.shape(0), width = (Int)depths.shape(1);
    demand((Int)normals.shape(0) == height && (Int)normals.shape(1) == width && normals.shape(2) == 3 &&
               (Int)sky.shape(0) == height && (Int)sky.shape(1) == width, "a normal and a share for each pixel");
    const double *depth = depths.data(), *normal = normals.data();
    float* share = sky.data();
    // Depths with a border of nothing, as wide as the farthest neighbor: no neighbor lies beyond it.
    const Int border = (Int)std::ceil(reach) + 1, wide = width + 2 * border;
    std::vector<double> framed(wide * (height + 2 * border), NOTHING);
    for (Int row = 0; row < height; row++)
        std::copy(depth + row * width, depth + (row + 1) * width, framed.data() + (row + border) * wide + border);
    double across[SAMPLES], along[SAMPLES], flat[SAMPLES];
    Int places[SAMPLES];
    for (int sample = 0; sample < SAMPLES; sample++) {
        const double radius = reach * std::sqrt((sample + 0.5) / SAMPLES), angle = 2.399963229728653 * sample;
        across[sample] = std::nearbyint(radius * std::cos(angle)), along[sample] = std::nearbyint(radius * std::sin(angle));
        places[sample] = (Int)along[sample] * wide + (Int)across[sample];
        flat[sample] = across[sample] * across[sample] + along[sample] * along[sample];
    }
    Free others(100.0 * height * width);
    for (Int row = 0; row < height; row++)
        for (Int column = 0; column < width; column++) {
            const Int pixel = row * width + column;
            const double* here = framed.data() + (row + border) * wide + column + border;
            share[pixel] = 1.0f;
            if (*here == NOTHING) continue;
            const double* n = normal + 3 * pixel;
            double taken = 0.0;
            for (int sample = 0; sample < SAMPLES; sample++) {
                const double rise = here[places[sample]] - *here;
                const double towards = n[0] * across[sample] + n[1] * along[sample] + n[2] * rise;
                const double square = flat[sample] + rise * rise;
                if (!(towards > 0.0) || towards * towards < 0.0143 * square || rise == NOTHING) continue;  // leans below 0.12
                const double far = std::sqrt(square) + 1e-6, lean = towards / far - 0.12;
                if (lean > 0 && far < 2 * reach) taken += lean * (1 - far / (2 * reach));
            }
            share[pixel] = (float)std::max(0.0, 1.0 - 2.6 * taken / SAMPLES);
        }
}

// Samples of a picture: depth, and what is shown there.
struct Samples {
    Int height, width, values;
    const double* depth;
    const float* shown;
};

// Light on a normal: lamps to the left above the eye and, weaker, right; the sky at (0, up, near).
double light_on(double x, double y, double z, double up, double near) {
    const double key = clamp((-0.4801 * x + 0.6202 * y + 0.6202 * z + 0.25) / 1.25);
    const double side = clamp(0.8518 * x + 0.0501 * y + 0.5211 * z);
    const double hemisphere = 0.5 + 0.5 * (up * y + near * z), away = 1.0 - clamp(z);
    return (0.14 + 0.26 * hemisphere + 0.56 * key + 0.12 * side) * (1.0 - 0.22 * away * away * away);
}

// Slanting strokes on a thin ground.
double hatching(double row, double column, double dot) {
    const double gap = 3.0 * dot, along = (column - row) / std::sqrt(2.0);
    const double near = std::abs(along - gap * std::floor(along / gap) - gap / 2);
    return 0.1 + 0.42 * clamp(0.32 * dot + 0.5 - near);
}

// 1 where a nearer part of the body begins at a neighbor, 0 elsewhere.
double edge_at(const Samples& all, Int row, Int column, double x, double y, double z, double jump, const Offset (&around)[8]) {
    const double own = all.depth[row * all.width + column];
    for (const Offset& offset : around) {
        const Int u = column + offset.x, v = row + offset.y;
        if (u < 0 || v < 0 || u >= all.width || v >= all.height) continue;
        const double rise = all.depth[v * all.width + u] - own;
        if (!(rise > jump)) continue;
        const double leaning = -(x / std::max(z, 0.15) * (double)offset.x + y / std::max(z, 0.15) * (double)offset.y);
        if (rise - std::max(leaning, 0.0) > jump) return 1.0;
    }
    return 0.0;
}

// Colors of an image from the samples within its pixels: light, hatching, mesh and edges.
void paint(Reals<2> depths, Array<const float, 3> shown, Array<const float, 2> sky, Reals<1> look, Reals<2> table, Reals<2> inks,
           Reals<1> shares, Array<double, 3> image) {
    const Int height = (Int)sky.shape(0), width = (Int)sky.shape(1), colors = (Int)table.shape(0);
    const Samples all{(Int)depths.shape(0), (Int)depths.shape(1), (Int)shown.shape(2), depths.data(), shown.data()};
    demand(look.shape(0) == 6 && look.data()[0] >= 1.0, "the look is six numbers");
    const Int fine = (Int)look.data()[0];
    const double dot = look.data()[1], jump = look.data()[2], up = look.data()[3], near = look.data()[4], moved = look.data()[5];
    demand(all.height == height * fine && all.width == width * fine && (Int)shown.shape(0) == all.height &&
               (Int)shown.shape(1) == all.width && (all.values == 4 || all.values == 7), "samples in whole pixels");
    demand(colors >= 2 && table.shape(1) == 3 && inks.shape(0) == 3 && inks.shape(1) == 3 && shares.shape(0) == 3 &&
               (Int)image.shape(0) == height && (Int)image.shape(1) == width && image.shape(2) == 4, "colors and image");
    const double *scale = table.data(), *ink = inks.data(), *strength = shares.data();
    double* pixels = image.data();
    Offset around[8];
    for (int turn = 0; turn < 8; turn++)
        around[turn] = {(Int)std::nearbyint(0.55 * dot * std::cos(turn * M_PI / 4)),
                        (Int)std::nearbyint(0.55 * dot * std::sin(turn * M_PI / 4))};
    Free others(100.0 * all.height * all.width);
    const auto add_sample = [&](Int row, Int column, double share, double* pixel) {
        const Int sample = row * all.width + column;
        if (all.depth[sample] == NOTHING) return;
        const float* seen = all.shown + sample * all.values;
        double x = seen[0], y = seen[1], z = seen[2];
        const double length = std::max(std::sqrt(x * x + y * y + z * z), 1e-12);
        x /= length, y /= length, z /= length;
        const double place = clamp(light_on(x, y, z, up, near) * (0.35 + 0.65 * share)) * (double)(colors - 1);
        const Int lower = std::min((Int)place, colors - 2);
        double covers[3] = {0.0, 0.0, edge_at(all, row, column, x, y, z, jump, around)};
        if (seen[3] > 0.5) covers[0] = hatching((double)row, (double)column + moved, dot);
        if (all.values == 7) covers[1] = clamp(0.24 * dot + 0.5 - (double)std::min({seen[4], seen[5], seen[6]}));
        for (int channel = 0; channel < 3; channel++) {
            const double low = scale[lower * 3 + channel], high = scale[(lower + 1) * 3 + channel];
            double value = low + (place - (double)lower) * (high - low);
            for (int each = 0; each < 3; each++)
                if (covers[each] > 0.0) value += strength[each] * covers[each] * (ink[each * 3 + channel] - value);
            pixel[channel] += value;
        }
        pixel[3] += 1.0;
    };
    for (Int row = 0; row < height; row++)
        for (Int column = 0; column < width; column++) {
            const double share = (double)sky.data()[row * width + column];
            double sums[4] = {}, *pixel = pixels + (row * width + column) * 4;
            for (Int v = row * fine; v < (row + 1) * fine; v++)
                for (Int u = column * fine; u < (column + 1) * fine; u++) add_sample(v, u, share, sums);
            for (int channel = 0; channel < 3; channel++)
                pixel[channel] = sums[3] > 0 ? sums[channel] / sums[3] : ink[6 + channel];
            pixel[3] = sums[3] / (double)(fine * fine);
        }
}

void demand_corners(const Counts<2>& triangles, Int vertices) {
    demand(triangles.shape(1) == 3, "triangles have three corners");
    for (size_t place = 0; place < triangles.size(); place++)
        demand(triangles.data()[place] >= 0 && triangles.data()[place] < vertices, "a corner is no vertex");
}

double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Angle of each triangle at each of its corners [rad].
void corner_angles(Reals<2> vertices, Counts<2> triangles, Array<double, 2> angles) {
    demand_corners(triangles, (Int)vertices.shape(0));
    demand(vertices.shape(1) == 3 && angles.shape(0) == triangles.shape(0) && angles.shape(1) == 3, "an angle a corner");
    for (Int index = 0; index < (Int)triangles.shape(0); index++)
        for (int corner = 0; corner < 3; corner++) {
            const Int* triangle = triangles.data() + 3 * index;
            double sides[2][3];
            for (int side = 0; side < 2; side++)
                for (int axis = 0; axis < 3; axis++)
                    sides[side][axis] = vertices.data()[3 * triangle[(corner + 1 + side) % 3] + axis] -
                                        vertices.data()[3 * triangle[corner] + axis];
            const double lengths = std::sqrt(dot(sides[0], sides[0]) * dot(sides[1], sides[1]));
            angles.data()[3 * index + corner] = std::acos(std::min(std::max(dot(sides[0], sides[1]) / lengths, -1.0), 1.0));
        }
}

// Unit normal at each corner of each triangle: the mean over those about its vertex that are not beyond a crease.
void corner_normals(Counts<2> triangles, Reals<2> normals, Reals<2> weights, Counts<1> starts, Counts<1> stars,
                    double sharpest, Array<double, 3> corners) {
    const Int count = (Int)triangles.shape(0);
    demand_corners(triangles, (Int)starts.shape(0) - 1);
    demand((Int)normals.shape(0) == count && normals.shape(1) == 3 && (Int)weights.shape(0) == count && weights.shape(1) == 3 &&
               (Int)corners.shape(0) == count && corners.shape(1) == 3 && corners.shape(2) == 3, "as many triangles of each");
    for (Int place = 0; place < (Int)stars.shape(0); place++)
        demand(stars.data()[place] >= 0 && stars.data()[place] < 3 * count, "a star has no such corner");
    for (Int vertex = 0; vertex + 1 < (Int)starts.shape(0); vertex++)
        demand(starts.data()[vertex] >= 0 && starts.data()[vertex + 1] <= (Int)stars.shape(0), "a star has no such place");
    for (Int index = 0; index < count; index++)
        for (int corner = 0; corner < 3; corner++) {
            const Int vertex = triangles.data()[3 * index + corner];
            const double* own = normals.data() + 3 * index;
            double mean[3] = {};
            for (Int place = starts.data()[vertex]; place < starts.data()[vertex + 1]; place++) {
                const Int other = stars.data()[place];
                const double* its = normals.data() + other / 3 * 3;
                if (dot(own, its) > sharpest)
                    for (int axis = 0; axis < 3; axis++) mean[axis] += weights.data()[other] * its[axis];
            }
            const double length = std::sqrt(dot(mean, mean));
            for (int axis = 0; axis < 3; axis++)
                corners.data()[9 * index + 3 * corner + axis] = length > 0 ? mean[axis] / length : own[axis];
        }
}

// Lay triangles into a depth buffer, the nearest on top.
template <class Real>
void rasterise(Reals<3> spots, Array<const Real, 3> values, bool inside, Array<double, 2> depth, Array<Real, 3> shown,
               Array<int32_t, 2> owner) {
    const Int rows = (Int)depth.shape(0), columns = (Int)depth.shape(1), many = (Int)values.shape(2);
    demand(spots.shape(1) == 3 && spots.shape(2) == 3 && values.shape(0) == spots.shape(0) && values.shape(1) == 3,
           "values of each corner");
    demand((Int)shown.shape(0) == rows && (Int)shown.shape(1) == columns && (Int)shown.shape(2) == many &&
               (Int)owner.shape(0) == rows && (Int)owner.shape(1) == columns, "buffers of one size");
    Free others(1e3 * (double)spots.shape(0));
    for (Int index = 0; index < (Int)spots.shape(0); index++) {
        const double* p = spots.data() + 9 * index;
        const double x0 = p[0], y0 = p[1], z0 = p[2], x1 = p[3], y1 = p[4], z1 = p[5], x2 = p[6], y2 = p[7], z2 = p[8];
        const double area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
        if (!(std::abs(area) >= 1e-9) || (area < 0 && !inside)) continue;
        const Int first = (Int)std::max(std::ceil(std::min({y0, y1, y2})), 0.0);
        const Int last = (Int)std::min(std::floor(std::max({y0, y1, y2})), (double)rows - 1);
        const Int left = (Int)std::max(std::ceil(std::min({x0, x1, x2})), 0.0);
        const Int right = (Int)std::min(std::floor(std::max({x0, x1, x2})), (double)columns - 1);
        const Real* value = values.data() + 3 * many * index;
        for (Int row = first; row <= last; row++)
            for (Int column = left; column <= right; column++) {
                const double u = (double)column, v = (double)row;
                const double b = ((u - x0) * (y2 - y0) - (x2 - x0) * (v - y0)) / area;
                const double c = ((x1 - x0) * (v - y0) - (u - x0) * (y1 - y0)) / area, a = 1.0 - b - c;
                if (a < -1e-9 || b < -1e-9 || c < -1e-9) continue;
                const double z = a * z0 + b * z1 + c * z2;
                const Int pixel = row * columns + column;
                if (!(z > depth.data()[pixel])) continue;
                depth.data()[pixel] = z;
                owner.data()[pixel] = (int32_t)index;
                for (Int k = 0; k < many; k++)
                    shown.data()[pixel * many + k] = (Real)(a * value[k] + b * value[many + k] + c * value[2 * many + k]);
            }
    }
}

}  // namespace

void add_pictures(nb::module_& module) {
    module.def("sky_shares", &sky_shares, given(), given(), given(), filled());
    module.def("paint", &paint, given(), given(), given(), given(), given(), given(), given(), filled());
    module.def("corner_angles", &corner_angles, given(), given(), filled());
    module.def("corner_normals", &corner_normals, given(), given(), given(), given(), given(), given(), filled());
    module.def("rasterise", &rasterise<float>, given(), filled(), given(), filled(), filled(), filled());
    module.def("rasterise", &rasterise<double>, given(), filled(), given(), filled(), filled(), filled());
}
