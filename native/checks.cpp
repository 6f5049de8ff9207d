// The checks of checks.hpp, without branches in their inner loops: they are made at each call.
#include "checks.hpp"

#include <algorithm>
#include <vector>

#include "bounds.hpp"

namespace {

using Int = int64_t;
enum { COLUMNS, BELOW, FIRST, PANEL, STARTS, CHILD, SIBLING, STACK, OFFSET, RUNS, ENTRIES, WIDTH };
constexpr Int PACK = 8;

uint32_t outside(int32_t number, uint32_t count) { return (uint32_t)number | (count - 1 - (uint32_t)number); }

// Runs of a child's rows rise in its parent's front, and none lies half in its columns.
bool has_runs(const Fronts& fronts, const Int* child, const Int* parent, Int count) {
    Int begin = child[RUNS], end = child[WIDTH + RUNS], before = 0, columns = parent[COLUMNS];
    if (begin < 0 || begin > end || end > count) return false;
    uint64_t wrong = 0;
    for (const Int* run = fronts.runs + 3 * begin; run < fronts.runs + 3 * end; run += 3) {
        Int low = run[1], length = run[2];
        if (length < 0 || length > child[BELOW] || low < before || low > columns + parent[BELOW]) return false;
        before = low + length;
        wrong |= ::outside(run[0], child[BELOW] - length + 1) | (low < columns ? ::outside(before, columns + 1) : 0);
    }
    return wrong >> 63 == 0 && before <= columns + parent[BELOW];
}

// Places of the entries of a front in the matrix and in its panel.
bool has_entries(const Fronts& fronts, const Int* front, Int count, Int data) {
    Int begin = front[ENTRIES], end = front[WIDTH + ENTRIES];
    if (begin < 0 || begin > end || end > count) return false;
    Int panel = std::min(front[COLUMNS] * (front[COLUMNS] + front[BELOW]), (Int)INT32_MAX);
    const uint32_t few = (uint32_t)std::min(data, (Int)INT32_MAX), room = (uint32_t)panel;
    uint32_t wrong = 0;
    for (Int entry = begin; entry < end; entry++)
        wrong |= outside(fronts.entries[2 * entry], few) | outside(fronts.entries[2 * entry + 1], room);
    return wrong >> 31 == 0;
}

// Children of a front are whole subtrees one behind the other, the last just before it; `begin` is where each begins.
void demand_children(const Fronts& fronts, Int which, const FrontRoom& room, std::vector<Int>& begin) {
    const Int* front = fronts.table + which * WIDTH;
    Int child = front[CHILD];
    demand(child >= -1 && child < which, "a front has no such child");
    begin[which] = child < 0 ? which : begin[child];
    while (child >= 0) {
        const Int *own = fronts.table + child * WIDTH, next = own[SIBLING];
        demand(own[STACK] == 1 - front[STACK], "a front hands up to the wrong stack");
        demand(has_runs(fronts, own, front, room.runs), "a front has no such runs");
        demand(next < 0 ? child == which - 1 : next > child && next < which && begin[next] == child + 1,
               "the fronts are in no postorder");
        child = next;
    }
}

}  // namespace

static void demand_nodes(const int32_t* stencils, Int size, Int nodes) {
    const uint32_t few = (uint32_t)std::min(nodes, (Int)INT32_MAX);
    uint32_t wrong = 0;
    for (Int place = 0; place < size; place++) wrong |= outside(stencils[place], few);
    demand(wrong >> 31 == 0, "a corner is no node");
}

void demand_corners(const Elements& all, Int nodes) {
    demand_nodes(all.stencils, all.groups * (all.dim + 1) * PACK, nodes);
}

void demand_corners(const Quadratics& all, Int nodes) {
    demand_nodes(all.stencils, all.groups * ((all.dim + 1) * (all.dim + 2) / 2) * PACK, nodes);
}

Int demand_strides(const Int* strides, Int nodes, Int size) {
    demand_below(strides, nodes, size + 1, "a column is longer than the matrix");
    Int widest = 0;
    for (Int node = 0; node < nodes; node++) widest = std::max(widest, strides[node]);
    return widest;
}

Int demand_panels(const Fronts& fronts, Int rows, Int lower) {
    Int highest = 0, done = 0;
    for (Int which = 0; which < fronts.count; which++) {
        const Int* front = fronts.table + which * WIDTH;
        Int columns = front[COLUMNS], below = front[BELOW];
        demand(columns >= 0 && columns <= fronts.dofs && below >= 0 && below <= rows, "a front is larger than the matrix");
        demand(front[FIRST] == done, "columns of the fronts do not follow each other");
        done += columns;
        uint64_t wrong = ::outside(front[STARTS], rows - below + 1) |
                         ::outside(front[PANEL], lower - 8 - columns * (columns + below) + 1);
        demand(wrong >> 63 == 0, "a front lies outside the factors");
        highest = std::max(highest, columns + below);
    }
    demand(done == fronts.dofs, "as many columns as degrees of freedom");
    demand_below(fronts.rows, rows, fronts.dofs, "a row is no degree of freedom");
    return highest;
}

void demand_fronts(const Fronts& fronts, const FrontRoom& room) {
    static thread_local std::vector<Int> begin;
    demand_panels(fronts, room.rows, room.lower);
    begin.resize(fronts.count);
    Int widest = 0, whole = 8;
    for (Int which = 0; which < fronts.count; which++) {
        const Int below = fronts.table[which * WIDTH + BELOW];
        whole += below * below;
    }
    const Int stacks[2] = {room.first < 0 ? whole : room.first, room.second < 0 ? whole : room.second};
    for (Int which = 0; which < fronts.count; which++) {
        const Int* front = fronts.table + which * WIDTH;
        demand((front[STACK] == 0 || front[STACK] == 1) && front[OFFSET] >= 0 &&
                   front[OFFSET] <= stacks[front[STACK]] - 8 - front[BELOW] * front[BELOW], "a front lies outside its stack");
        demand(front[SIBLING] == -1 || (front[SIBLING] > which && front[SIBLING] < fronts.count), "a front has no such sibling");
        demand_children(fronts, which, room, begin);
        demand(has_entries(fronts, front, room.entries, room.data), "a front has no such entries");
        widest = std::max(widest, front[COLUMNS]);
    }
    demand(room.spare >= 8 * widest, "room for a panel");
    for (Int dof = 0; dof < fronts.dofs; dof++)
        demand(fronts.diagonal[dof] >= -1 && fronts.diagonal[dof] < room.data, "a diagonal lies outside the matrix");
}
