// What constraints leave the points of a cable network: the loops of design/routes/margins.py.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "arrays.hpp"

namespace {

using Int = int64_t;
constexpr double STEP = 1e-7;  // of the central differences of a turn [m]
using Place = std::array<double, 3>;

struct Point {
    Place at;
    Int start;  // where its numbers begin
};

// A straight run of a cable: from `first` to `last`, of which the part that counts begins at `low`.
struct Run {
    Int route, winch, first, last;
    bool kept;
    Place low, high;
};

double dot(const Place& one, const Place& two) { return one[0] * two[0] + one[1] * two[1] + one[2] * two[2]; }
Place minus(const Place& one, const Place& two) { return {one[0] - two[0], one[1] - two[1], one[2] - two[2]}; }
Place along(const Place& from, const Place& way, double share) {
    return {from[0] + share * way[0], from[1] + share * way[1], from[2] + share * way[2]};
}
double length(const Place& way) { return std::sqrt(dot(way, way)); }
double clip(double share) { return std::min(std::max(share, 0.0), 1.0); }

// Nearest points of two segments, as shares of the way along each: as `nearest_shares` in design/polyline.py.
void nearest(const Place& begin, const Place& end, const Place& other, const Place& far, double& share, double& across) {
    const double tiny = 1.4916681462400413e-154;
    const Place way = minus(end, begin), ways = minus(far, other), between = minus(begin, other);
    const double square = dot(way, way), squares = dot(ways, ways), here = dot(way, between), there = dot(ways, between);
    const double both = dot(way, ways), slanted = square * squares - both * both;
    share = slanted > 1e-12 * square * squares ? both * there - here * squares : 0.0;
    share = clip(share / std::max(slanted, tiny));
    across = clip((both * share + there) / std::max(squares, tiny));
    share = clip((both * across - here) / std::max(square, tiny));
}

struct Limits {
    double winch_gap, hole_gap, cable_gap, turn, bend_radius, longest, reach, hair;
};

// Margins of one network, and their slopes by its numbers; those beyond the reach are left out.
struct Network {
    Int dim, size, rooms, count = 0;
    Limits limits;
    double *rows, *left;
    std::vector<Point> points;
    const Int *begins, *members, *pulled;
    const bool *kept, *world, *fixed;
    const double* radii;
    Int routes, winches;

    double* add(double margin) {
        if (!(margin <= limits.reach)) return nullptr;
        double* row = count < rooms ? rows + count * size : nullptr;
        if (row) std::fill(row, row + size, 0.0), left[count] = margin;
        count++;
        return row;
    }
    void slope(double* row, Int point, const Place& way, double share) const {
        for (Int axis = 0; axis < dim; axis++) row[points[point].start + axis] += share * way[axis];
    }
    // Limits whose slopes are all nought say nothing.
    void settle(double* row) {
        if (row && std::all_of(row, row + size, [](double value) { return value == 0.0; })) count--;
    }
    Place direction(const Place& span, double distance) const {
        if (!(distance > 1e-9)) return {1.0, 0.0, 0.0};
        return {span[0] / distance, span[1] / distance, span[2] / distance};
    }
    void apart(Int one, Int other, double gap) {
        const Place span = minus(points[one].at, points[other].at);
        const double distance = length(span);
        if (double* row = add(distance - gap - limits.hair)) {
            const Place way = direction(span, distance);
            slope(row, one, way, -1.0), slope(row, other, way, 1.0);
            settle(row);
        }
    }
    const Place& winch(Int number) const { return points[number].at; }
    double share(const Run& run, const Place& place) const {
        const Place way = minus(points[run.last].at, points[run.first].at);
        return dot(minus(place, points[run.first].at), way) / std::max(dot(way, way), 1e-300);
    }
    void part(double* row, const Run& run, const Place& place, const Place& way, double sign) const {
        const double own = share(run, place);
        slope(row, run.first, way, sign * (1 - own)), slope(row, run.last, way, sign * own);
    }

    void winches_apart() {
        for (Int one = 0; one < winches; one++) {
            if (world[one] || fixed[one]) continue;
            for (Int other = 0; other < winches; other++)
                if (other != one && !(other < one && !world[other] && !fixed[other])) apart(one, other, limits.winch_gap);
        }
    }
    void holes_apart() {
        std::vector<std::pair<Int, Int>> holes;  // point and route
        for (Int route = 0; route < routes; route++)
            for (Int place = begins[route] + 1; place < begins[route + 1]; place++) holes.push_back({members[place], route});
        for (size_t one = 0; one < holes.size(); one++)
            for (size_t other = one + 1; other < holes.size(); other++) {
                const auto [here, route] = holes[one];
                const auto [there, second] = holes[other];
                const double away = length(minus(points[here].at, points[there].at));
                if (away >= limits.hole_gap + limits.reach || (away < 1e-6 && route != second)) continue;
                if (!(kept[route] && kept[second])) apart(here, there, limits.hole_gap);
            }
        for (Int number = 0; number < winches; number++) {
            if (world[number]) continue;
            for (const auto& [hole, route] : holes) {
                const double need = pulled[route] == number ? limits.hole_gap : radii[number];
                if (kept[route] && fixed[number]) continue;
                if (length(minus(points[hole].at, winch(number))) < need + limits.reach) apart(hole, number, need);
            }
        }
    }
    std::vector<Run> runs() const {
        std::vector<Run> found;
        for (Int route = 0; route < routes; route++)
            for (Int place = begins[route]; place + 1 < begins[route + 1]; place++) {
                const bool entry = place == begins[route];
                if (entry && world[pulled[route]]) continue;  // what is outside the body hangs in a tube of its own
                Run run{route, pulled[route], members[place], members[place + 1], kept[route], {}, {}};
                run.low = points[run.first].at, run.high = points[run.last].at;
                const Place way = minus(run.high, run.low);
                const double span = length(way);
                if (entry && span > 0) run.low = along(run.low, way, std::min(1.0, radii[run.winch] / span));
                found.push_back(run);
            }
        return found;
    }
    void cables_apart() {
        if (limits.cable_gap == 0.0) return;
        const std::vector<Run> all = runs();
        std::vector<Place> middles;
        std::vector<double> halves;
        for (const Run& run : all) {
            const Place way = minus(run.high, run.low);
            middles.push_back(along(run.low, way, 0.5)), halves.push_back(0.5 * length(way));
        }
        const double near = limits.cable_gap + limits.reach;
        for (size_t one = 0; one < all.size(); one++)
            for (size_t other = one + 1; other < all.size(); other++) {
                const Run &run = all[one], &second = all[other];
                if ((run.route == second.route && other == one + 1) || (run.kept && second.kept)) continue;
                if (length(minus(middles[one], middles[other])) < halves[one] + halves[other] + near)
                    runs_apart(run, second, near);
            }
        for (Int number = 0; number < winches; number++) {
            if (world[number]) continue;
            for (const Run& run : all)
                if (run.winch != number && !(run.kept && fixed[number])) run_from_winch(run, number);
        }
    }
    void runs_apart(const Run& run, const Run& second, double near) {
        double share, across;
        nearest(run.low, run.high, second.low, second.high, share, across);
        const Place here = along(run.low, minus(run.high, run.low), share);
        const Place there = along(second.low, minus(second.high, second.low), across);
        const Place span = minus(here, there);
        const double distance = length(span);
        if (!(distance < near)) return;
        const double beside = radii[run.winch] - 1e-6;
        if (run.winch == second.winch && run.route != second.route && length(minus(here, winch(run.winch))) < beside &&
            length(minus(there, winch(run.winch))) < beside)
            return;
        if (double* row = add(distance - limits.cable_gap - limits.hair)) {
            const Place way = direction(span, distance);
            part(row, run, here, way, -1.0), part(row, second, there, way, 1.0);
            settle(row);
        }
    }
    void run_from_winch(const Run& run, Int number) {
        double share, none;
        nearest(run.low, run.high, winch(number), winch(number), share, none);
        const Place here = along(run.low, minus(run.high, run.low), share), span = minus(here, winch(number));
        const double distance = length(span);
        if (double* row = add(distance - radii[number] - limits.hair)) {
            const Place way = direction(span, distance);
            part(row, run, here, way, -1.0), slope(row, number, way, 1.0);
            settle(row);
        }
    }
    // Angle times the shorter segment [m], or what an arc between the middles of the segments has beyond its radius [m].
    double margin(const Place* corner, bool arc) const {
        const Place first = minus(corner[1], corner[0]), second = minus(corner[2], corner[1]);
        const double one = length(first), two = length(second), shorter = std::min(one, two);
        const double cosine = dot(first, second) / std::max(one * two, 1e-300);
        const double angle = std::acos(std::min(std::max(cosine, -1.0), 1.0));
        if (!arc) return (limits.turn - angle) * shorter;
        return 0.5 * shorter - limits.bend_radius * std::tan(0.5 * std::min(angle, 3.0));
    }
    void turns(Int route, bool arc) {
        for (Int place = begins[route]; place + 2 < begins[route + 1]; place++) {
            if (!arc && place == begins[route] && world[pulled[route]]) continue;  // where it enters it hangs as it likes
            Place corner[3];
            for (int which = 0; which < 3; which++) corner[which] = points[members[place + which]].at;
            double* row = add(margin(corner, arc));
            if (!row) continue;
            for (int which = 0; which < 3; which++)
                for (Int axis = 0; axis < dim; axis++) {
                    const double held = corner[which][axis];
                    corner[which][axis] = held + STEP;
                    const double above = margin(corner, arc);
                    corner[which][axis] = held - STEP;
                    row[points[members[place + which]].start + axis] -= (above - margin(corner, arc)) / (2 * STEP);
                    corner[which][axis] = held;
                }
            settle(row);
        }
    }
    void shape(Int route) {
        if (kept[route]) return;
        turns(route, false);
        if (limits.bend_radius > 0) turns(route, true);
        if (!(limits.longest < std::numeric_limits<double>::infinity())) return;
        double whole = 0.0;
        for (Int place = begins[route]; place + 1 < begins[route + 1]; place++)
            whole += length(minus(points[members[place + 1]].at, points[members[place]].at));
        double* row = add(limits.longest - whole - limits.hair);
        for (Int place = begins[route]; row && place + 1 < begins[route + 1]; place++) {
            const Place span = minus(points[members[place + 1]].at, points[members[place]].at);
            const Place way = direction(span, length(span));
            slope(row, members[place], way, -1.0), slope(row, members[place + 1], way, 1.0);
        }
    }
    void find() {
        winches_apart();
        holes_apart();
        cables_apart();
        for (Int route = 0; route < routes; route++) shape(route);
    }
};

// Margins of the points of a network [m] and their slopes, at most as many as there is room for; tells how many there are.
// Points are the winches, then those of each route after its first; `members` lists the points of the routes one after
// the other. `limits` are the gaps of winches, holes and cables, the largest turn [rad], the bend radius, the largest
// length, what is within reach, and the hair that is kept back.
Int network_limits(Reals<2> places, Counts<1> begins, Counts<1> members, Counts<1> pulled, Array<const bool, 1> kept,
                   Array<const bool, 1> world, Array<const bool, 1> fixed, Reals<1> radii, Reals<1> limits,
                   Array<double, 2> rows, Array<double, 1> left) {
    const Int count = (Int)places.shape(0), dim = (Int)places.shape(1), routes = (Int)pulled.shape(0);
    const Int winches = (Int)world.shape(0);
    demand((dim == 2 || dim == 3) && limits.shape(0) == 8 && (Int)begins.shape(0) == routes + 1 && winches <= count &&
               (Int)kept.shape(0) == routes && (Int)fixed.shape(0) == winches && (Int)radii.shape(0) == winches &&
               (Int)rows.shape(1) >= count * dim && rows.shape(0) == left.shape(0), "parts of one network");
    demand_range(begins, 0, (Int)members.shape(0) + 1, "no such point of a route");
    for (Int route = 0; route < routes; route++)
        demand(begins.data()[route] <= begins.data()[route + 1], "routes out of order");
    demand_range(members, 0, count, "no such point"), demand_range(pulled, 0, winches, "no such winch");
    const double* given = limits.data();
    Network network{dim, (Int)rows.shape(1), (Int)rows.shape(0)};
    network.limits = {given[0], given[1], given[2], given[3], given[4], given[5], given[6], given[7]};
    network.rows = rows.data(), network.left = left.data();
    network.begins = begins.data(), network.members = members.data(), network.pulled = pulled.data();
    network.kept = kept.data(), network.world = world.data(), network.fixed = fixed.data(), network.radii = radii.data();
    network.routes = routes, network.winches = winches;
    for (Int point = 0; point < count; point++) {
        const double* at = places.data() + point * dim;
        network.points.push_back({{at[0], at[1], dim == 3 ? at[2] : 0.0}, point * dim});
    }
    network.find();
    return network.count;
}

}  // namespace

void add_limits(nb::module_& module) {
    module.def("network_limits", &network_limits, given(), given(), given(), given(), given(), given(), given(), given(),
               given(), filled(), filled());
}
