// What a factorisation will look like: the loops of mechanics/symbolic.py and of the plan in mechanics/supernodal.py.
#include <algorithm>

#include "bounds.hpp"

namespace {

using Int = int64_t;

// A graph whose nodes are ordered: neighbours of node i are neighbours[starts[i]:starts[i + 1]].
struct Ordered {
    const Int *begin, *other, *node, *at;

    Ordered(const Counts<1>& starts, const Counts<1>& neighbours, const Counts<1>& order, const Counts<1>& place) {
        Int nodes = (Int)order.shape(0);
        demand((Int)starts.shape(0) == nodes + 1 && (Int)place.shape(0) == nodes, "sizes of the graph");
        begin = demand_starts(starts, (Int)neighbours.shape(0), "a node has no such neighbors");
        other = demand_below(neighbours, nodes, "a neighbor is no node");
        node = demand_below(order, nodes, "the order has no such node");
        at = demand_below(place, nodes, "a node has no such place");
    }
};

// Fill `parent`; `ancestor` shortens the paths. Both are -1 before.
void elimination_tree(Counts<1> starts, Counts<1> neighbours, Counts<1> order, Counts<1> place, Array<Int, 1> parent,
                      Array<Int, 1> ancestor) {
    Int nodes = (Int)order.shape(0);
    demand((Int)parent.shape(0) == nodes && (Int)ancestor.shape(0) == nodes, "sizes of the graph");
    const Ordered graph(starts, neighbours, order, place);
    demand_range(ancestor, -1, nodes, "no such ancestor");
    Int *up = parent.data(), *highest = ancestor.data();
    for (Int column = 0; column < nodes; column++)
        for (Int entry = graph.begin[graph.node[column]]; entry < graph.begin[graph.node[column] + 1]; entry++) {
            Int row = graph.at[graph.other[entry]];
            while (row >= 0 && row < column) {
                Int following = highest[row];
                highest[row] = column;
                if (following < 0) up[row] = column;
                row = following;
            }
        }
}

// Fill `result`, and spoil `child`.
void postorder(Counts<1> parent, Array<Int, 1> child, Counts<1> sibling, Array<Int, 1> result, Array<Int, 1> stack) {
    Int count = (Int)parent.shape(0), written = 0;
    demand((Int)child.shape(0) == count && (Int)sibling.shape(0) == count && (Int)result.shape(0) == count &&
               (Int)stack.shape(0) == count, "sizes of the forest");
    const Int *up = parent.data(), *next = demand_range(sibling, -1, count, "no such sibling");
    demand_range(child, -1, count, "no such child");
    Int *first = child.data(), *out = result.data(), *waiting = stack.data();
    for (Int root = 0; root < count; root++) {
        if (up[root] >= 0) continue;
        waiting[0] = root;
        for (Int depth = 1; depth > 0;) {
            Int vertex = waiting[depth - 1];
            if (first[vertex] >= 0) {
                demand(depth < count, "no forest");
                waiting[depth++] = first[vertex];
                first[vertex] = next[first[vertex]];
            } else {
                demand(written < count, "no forest");
                out[written++] = vertex;
                depth--;
            }
        }
    }
}

// Entries of each column of L, the diagonal included: a row of L is a subtree from the row's entries upwards.
//
// `count` is 1 and `seen` -1 before.
void column_counts(Counts<1> starts, Counts<1> neighbours, Counts<1> order, Counts<1> place, Counts<1> parent,
                   Array<Int, 1> count, Array<Int, 1> seen) {
    Int nodes = (Int)order.shape(0);
    demand((Int)parent.shape(0) == nodes && (Int)count.shape(0) == nodes && (Int)seen.shape(0) == nodes,
           "sizes of the graph");
    const Ordered graph(starts, neighbours, order, place);
    const Int* up = demand_range(parent, -1, nodes, "no such parent");
    Int *total = count.data(), *mark = seen.data();
    for (Int row = 0; row < nodes; row++) {
        mark[row] = row;
        for (Int entry = graph.begin[graph.node[row]]; entry < graph.begin[graph.node[row] + 1]; entry++)
            for (Int column = graph.at[graph.other[entry]]; column < row && mark[column] != row; column = up[column]) {
                demand(up[column] >= 0, "no elimination tree of the graph");
                mark[column] = row;
                total[column]++;
            }
    }
}

// The model of time of `front_seconds` in symbolic.py, where its numbers are explained.
double front_seconds(double columns, double rows) {
    double below = rows - columns;
    double operations = columns * (columns * columns / 3.0 + columns * below + below * 1.0 * below);
    double rate = 30e9 * columns / (columns + 12.0);
    return 1.5e-6 + 0.6e-9 * columns * rows + 0.5 * 0.8e-9 * below * below + operations / rate;
}

// Fill in which supernode each is merged into, itself at first; `columns` are those of heads, 0 of other nodes.
void merge(Counts<1> child, Counts<1> sibling, Array<Int, 1> columns, Counts<1> count, Array<Int, 1> into, Int dim) {
    Int nodes = (Int)into.shape(0);
    demand((Int)child.shape(0) == nodes && (Int)sibling.shape(0) == nodes && (Int)columns.shape(0) == nodes &&
               (Int)count.shape(0) == nodes, "sizes of the forest");
    const Int *first = demand_range(child, -1, nodes, "no such child"), *high = count.data();
    const Int* next = demand_rising(sibling, "siblings do not rise");
    demand_below(into, nodes, "no such supernode");
    Int *wide = columns.data(), *out = into.data();
    for (Int top = 0; top < nodes; top++)
        for (Int vertex = first[top]; vertex >= 0; vertex = next[vertex]) {
            Int own = dim * (high[top] - 1), two = dim * wide[vertex], one = dim * wide[top];
            double apart = front_seconds((double)two, (double)(two + dim * (high[vertex] - 1))) +
                           front_seconds((double)one, (double)(one + own));
            if (front_seconds((double)(one + two), (double)(one + two + own)) < apart) {
                wide[top] += wide[vertex];
                out[vertex] = top;
            }
        }
    for (Int node = nodes - 1; node >= 0; node--) out[node] = out[out[node]];
}

// Rows below each supernode: of its nodes' neighbours and of its children, those after its last node.
//
// `seen` is -1 before.
void rows(Counts<1> starts, Counts<1> neighbours, Counts<1> order, Counts<1> place, Counts<1> first, Counts<1> child,
          Counts<1> sibling, Counts<1> begins, Array<Int, 1> found, Array<Int, 1> seen) {
    Int count = (Int)child.shape(0), nodes = (Int)order.shape(0);
    demand((Int)seen.shape(0) == nodes && (Int)first.shape(0) == count + 1 && (Int)begins.shape(0) == count + 1 &&
               (Int)sibling.shape(0) == count && (Int)found.shape(0) == begins.data()[count], "sizes of the tree");
    const Ordered graph(starts, neighbours, order, place);
    const Int* low = demand_starts(first, nodes, "a supernode has no such nodes");
    const Int* lists = demand_starts(begins, (Int)found.shape(0), "a supernode has no such rows");
    const Int* next = demand_rising(sibling, "siblings do not rise");
    demand_range(child, -1, count, "no such child");
    Int *out = found.data(), *mark = seen.data();
    for (Int which = 0; which < count; which++) {
        Int end = low[which + 1], written = lists[which];
        auto take = [&](Int row) {
            demand(row >= 0 && row < nodes, "a row is no node");
            if (row < end || mark[row] == which) return;
            demand(written < lists[which + 1], "a supernode has more rows");
            mark[row] = which;
            out[written++] = row;
        };
        for (Int column = low[which]; column < end; column++)
            for (Int entry = graph.begin[graph.node[column]]; entry < graph.begin[graph.node[column] + 1]; entry++)
                take(graph.at[graph.other[entry]]);
        for (Int below = child.data()[which]; below >= 0; below = next[below])
            for (Int position = lists[below]; position < lists[below + 1]; position++) take(out[position]);
    }
}

// Columns of `Fronts.table`.
enum { COLUMNS, BELOW, FIRST, PANEL, STARTS, CHILD, SIBLING, STACK, OFFSET, RUNS, ENTRIES, WIDTH };

// On which stack what a front hands up will lie, where, and how much the stacks hold at most; `top` is 0.
void stacks(Array<Int, 2> table, Counts<1> parent, Array<Int, 1> top, Array<Int, 1> most) {
    Int count = (Int)parent.shape(0);
    demand((Int)table.shape(0) == count + 1 && table.shape(1) == WIDTH && top.shape(0) == 2 && most.shape(0) == 2,
           "shape of the table");
    Int *fronts = table.data(), *height = top.data(), *highest = most.data();
    const Int* up = demand_rising(parent, "a parent comes before its child");
    for (Int vertex = 0; vertex < count; vertex++) {
        const Int* front = fronts + vertex * WIDTH;
        demand((front[STACK] == 0 || front[STACK] == 1) && front[CHILD] >= -1 && front[CHILD] < count, "no such stack or child");
    }
    for (Int vertex = count - 1; vertex >= 0; vertex--)
        if (up[vertex] >= 0) fronts[vertex * WIDTH + STACK] = 1 - fronts[up[vertex] * WIDTH + STACK];
    for (Int vertex = 0; vertex < count; vertex++) {
        Int *front = fronts + vertex * WIDTH, which = front[STACK];
        if (front[CHILD] >= 0) height[1 - which] = fronts[front[CHILD] * WIDTH + OFFSET];
        front[OFFSET] = height[which];
        height[which] += front[BELOW] * front[BELOW];
        highest[which] = std::max(highest[which], height[which]);
    }
}

// Rows of the fronts lie one behind the other in a list.
void demand_fronts(const Int* fronts, Int count, Int rows) {
    for (Int which = 0; which < count; which++) {
        const Int* front = fronts + which * WIDTH;
        demand(front[STARTS] >= 0 && front[BELOW] >= 0 && front[BELOW] <= rows && front[STARTS] <= rows &&
                   front[WIDTH + STARTS] == front[STARTS] + front[BELOW], "a front has no such rows");
    }
    demand(fronts[count * WIDTH + STARTS] <= rows, "a front has no such rows");
}

// Pieces of the rows below each front that are contiguous in the parent's front; none crosses its own columns.
void runs(Array<Int, 2> table, Counts<1> parent, Counts<1> below, Array<Int, 2> found) {
    Int count = (Int)parent.shape(0), written = 0;
    demand((Int)table.shape(0) == count + 1 && table.shape(1) == WIDTH && found.shape(1) == 3 &&
               found.shape(0) == below.shape(0), "shape of the table");
    Int *fronts = table.data(), *out = found.data();
    const Int* lists = below.data();
    demand_rising(parent, "a parent comes before its child");
    demand_fronts(fronts, count, (Int)below.shape(0));
    for (Int which = 0; which < count; which++) {
        Int up = parent.data()[which], *front = fronts + which * WIDTH;
        if (up >= 0) {
            const Int* higher = fronts + up * WIDTH;
            Int columns = higher[COLUMNS], at = higher[STARTS], previous = -2;
            for (Int position = front[STARTS]; position < front[WIDTH + STARTS]; position++) {
                Int row = lists[position], local = row - higher[FIRST];
                if (local >= columns) {
                    while (at < higher[WIDTH + STARTS] && lists[at] < row) at++;
                    local = columns + at - higher[STARTS];
                }
                if (local == previous + 1 && local != columns) {
                    out[3 * written - 1]++;
                } else {
                    out[3 * written] = position - front[STARTS];
                    out[3 * written + 1] = local;
                    out[3 * written + 2] = 1;
                    written++;
                }
                previous = local;
            }
        }
        front[WIDTH + RUNS] = written;
    }
}

// For each front the places of its entries of A in the data and in its panel, and the places of the diagonal.
void entries(Array<Int, 2> table, Counts<1> below, Counts<1> indptr, Counts<1> indices, Counts<1> place,
             Counts<1> undo, Array<Int, 1> local, Array<int32_t, 2> found, Array<Int, 1> diagonal) {
    Int count = (Int)table.shape(0) - 1, dofs = (Int)place.shape(0), written = 0;
    demand(table.shape(1) == WIDTH && (Int)indptr.shape(0) == dofs + 1 && (Int)undo.shape(0) == dofs &&
               (Int)local.shape(0) == dofs && (Int)diagonal.shape(0) == dofs && found.shape(1) == 2 &&
               2 * (Int)found.shape(0) >= (Int)indices.shape(0) + dofs, "sizes of the matrix");
    Int *fronts = table.data(), *here = local.data(), *middle = diagonal.data();
    const Int* begin = demand_starts(indptr, (Int)indices.shape(0), "a column has no such entries");
    const Int* lists = demand_below(below, dofs, "a row is no degree of freedom");
    const Int *old_of = demand_below(undo, dofs, "no such column"), *at = demand_below(place, dofs, "no such place");
    const Int* cells = demand_below(indices, dofs, "an entry is in no row");
    demand_fronts(fronts, count, (Int)below.shape(0));
    int32_t* out = found.data();
    for (Int which = 0; which < count; which++) {
        Int* front = fronts + which * WIDTH;
        Int first = front[FIRST], columns = front[COLUMNS], height = columns + front[BELOW];
        demand(first >= 0 && columns >= 0 && first <= dofs && columns <= dofs - first, "a front has no such columns");
        for (Int row = 0; row < columns; row++) here[first + row] = row;
        for (Int position = 0; position < front[BELOW]; position++)
            here[lists[front[STARTS] + position]] = columns + position;
        for (Int column = 0; column < columns; column++) {
            Int old = old_of[first + column];
            for (Int entry = begin[old]; entry < begin[old + 1]; entry++) {
                Int row = at[cells[entry]];
                if (row == first + column) middle[old] = entry;
                if (row < first + column) continue;
                demand(written < (Int)found.shape(0), "a front has more entries");
                out[2 * written] = (int32_t)entry;
                out[2 * written + 1] = (int32_t)(column * height + here[row]);
                written++;
            }
        }
        front[WIDTH + ENTRIES] = written;
    }
}

}  // namespace

void add_symbolic(nb::module_& module) {
    module.def("elimination_tree", &elimination_tree, given(), given(), given(), given(), filled(), filled());
    module.def("postorder", &postorder, given(), filled(), given(), filled(), filled());
    module.def("column_counts", &column_counts, given(), given(), given(), given(), given(), filled(), filled());
    module.def("merge", &merge, given(), given(), filled(), given(), filled(), given());
    module.def("rows", &rows, given(), given(), given(), given(), given(), given(), given(), given(), filled(),
               filled());
    module.def("stacks", &stacks, filled(), given(), filled(), filled());
    module.def("runs", &runs, filled(), given(), given(), filled());
    module.def("entries", &entries, filled(), given(), given(), given(), given(), given(), filled(), filled(),
               filled());
}
