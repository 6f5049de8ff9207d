// In which order to eliminate nodes: the loops of mechanics/ordering.py, where the method is explained.
#include <limits>
#include <vector>

#include "bounds.hpp"

namespace {

constexpr double LARGEST = 0.4;  // share of the nodes that it separates that a separator may have

using Int = int64_t;

struct Graph {
    const Int *starts, *neighbours;

    Graph(const Counts<1>& begins, const Counts<1>& others, Int nodes) {
        demand((Int)begins.shape(0) == nodes + 1, "sizes of the graph");
        starts = demand_starts(begins, (Int)others.shape(0), "a node has no such neighbors");
        neighbours = demand_below(others, nodes, "a neighbor is no node");
    }
};

// Fill `starts` and `neighbours`; `seen` is -1 for every node.
void block_graph(Counts<1> indptr, Counts<1> indices, Int dim, Array<Int, 1> starts, Array<Int, 1> neighbours,
                 Array<Int, 1> seen) {
    Int nodes = (Int)seen.shape(0), filled = 0;
    demand(dim > 0 && (Int)indptr.shape(0) > nodes * dim && (Int)starts.shape(0) == nodes + 1 &&
               neighbours.shape(0) >= indices.shape(0), "sizes of the graph");
    const Int* begin = demand_starts(indptr, (Int)indices.shape(0), "a column has no such entries");
    const Int* entries = demand_below(indices, nodes * dim, "an entry is in no row");
    Int *mark = seen.data(), *out = neighbours.data(), *ends = starts.data();
    for (Int node = 0; node < nodes; node++) {
        mark[node] = node;
        for (Int entry = begin[node * dim]; entry < begin[(node + 1) * dim]; entry++) {
            Int other = entries[entry] / dim;
            if (mark[other] != node) {
                mark[other] = node;
                out[filled++] = other;
            }
        }
        ends[node + 1] = filled;
    }
}

// Edges between each node and `root`; left as they are, the number of nodes, where no path leads.
void distances(Counts<1> starts, Counts<1> neighbours, Int root, Array<double, 1> found, Array<Int, 1> queue) {
    Int nodes = (Int)found.shape(0);
    demand((Int)queue.shape(0) == nodes && root >= 0 && root < nodes, "sizes of the graph");
    const Graph graph(starts, neighbours, nodes);
    double* far = found.data();
    demand(far[root] >= (double)nodes, "a distance is the number of nodes before");
    Int *waiting = queue.data(), head = 0, tail = 1;
    double unseen = far[root];
    far[root] = 0.0;
    waiting[0] = root;
    while (head < tail) {
        Int node = waiting[head++];
        for (Int entry = graph.starts[node]; entry < graph.starts[node + 1]; entry++) {
            Int other = graph.neighbours[entry];
            if (far[other] == unseen) {
                far[other] = far[node] + 1.0;
                waiting[tail++] = other;
            }
        }
    }
}

// Nested dissection of one graph; `work` is -1 and the first of `sides` 0 everywhere between the steps.
struct Dissection {
    Graph graph;
    Int nodes, axes;
    const double* points;
    Int *lines, *order, *mate, *parent, *side, *place, *best, *queue, *touched, *border;

    // Breadth-first search along alternating paths from the nodes in `queue`; how many far nodes it reached.
    //
    // A near node without a mate is its own. With `grow` the search ends at the first free far node, and the matching
    // grows by the path to it.
    Int alternate(Int tail, bool grow) {
        Int head = 0, reached = 0;
        while (head < tail) {
            Int node = queue[head++];
            for (Int entry = graph.starts[node]; entry < graph.starts[node + 1]; entry++) {
                Int other = graph.neighbours[entry];
                if (side[other] != 2 || parent[other] >= 0) continue;
                parent[other] = node;
                touched[reached++] = other;
                if (mate[other] >= 0) {
                    queue[tail++] = mate[other];
                } else if (grow) {
                    Int following = other;
                    while (following != node) {
                        other = following;
                        node = parent[other];
                        following = mate[node];
                        mate[other] = node;
                        mate[node] = other;
                    }
                    return reached;
                }
            }
        }
        return reached;
    }

    // Ratio of a separator to the product of the halves, where the first `half` nodes of `line` are cut off.
    //
    // It is infinite where a half is empty, or where the separator is too large. `side` becomes 1 and 2, 3 on the
    // separator; it is 0 before, and `work` is -1 before and after.
    double separator(const Int* line, Int length, Int half) {
        for (Int rank = 0; rank < length; rank++) side[line[rank]] = rank < half ? 1 : 2;
        Int bordering = 0;
        for (Int rank = 0; rank < half; rank++) {
            Int node = line[rank];
            for (Int entry = graph.starts[node]; entry < graph.starts[node + 1]; entry++) {
                Int other = graph.neighbours[entry];
                if (side[other] != 2) continue;
                if (mate[node] < 0) {
                    border[bordering++] = node;
                    mate[node] = node;
                }
                if (mate[other] < 0) {
                    mate[other] = node;
                    mate[node] = other;
                    break;
                }
            }
        }
        for (Int rank = 0; rank < bordering; rank++) {
            Int node = border[rank];
            if (mate[node] != node) continue;
            queue[0] = node;
            Int reached = alternate(1, true);
            for (Int position = 0; position < reached; position++) parent[touched[position]] = -1;
        }
        Int free = 0, size = 0, near = half;
        for (Int rank = 0; rank < bordering; rank++)
            if (mate[border[rank]] == border[rank]) queue[free++] = border[rank];
        alternate(free, false);
        for (Int rank = 0; rank < bordering; rank++) {
            Int node = border[rank];
            if (mate[node] == node) continue;
            size++;
            if (parent[mate[node]] >= 0) {
                side[mate[node]] = 3;
            } else {
                side[node] = 3;
                near--;
            }
        }
        for (Int rank = 0; rank < length; rank++) mate[line[rank]] = parent[line[rank]] = -1;
        Int far = length - near - size;
        if (near == 0 || far == 0 || size > LARGEST * length) return std::numeric_limits<double>::infinity();
        return size / ((double)near * far);
    }

    // Sort each line from `low` to `high` into the two sides and the separator, and order the latter; where they end.
    //
    // The separator is ordered along its longest axis, so that what lies together is numbered together.
    void arrange(Int low, Int high, Int& middle, Int& end) {
        double widest = -1.0;
        Int* spare = queue;
        middle = end = low;
        for (Int axis = 0; axis < axes; axis++) {
            Int at = low, *line = lines + axis * nodes;
            for (Int which = 1; which < 4; which++) {
                if (which == 2) middle = at;
                if (which == 3) end = at;
                for (Int position = low; position < high; position++)
                    if (best[line[position]] == which) spare[at++] = line[position];
            }
            for (Int position = low; position < high; position++) line[position] = spare[position];
            if (end < high) {
                double width = points[axis * nodes + spare[high - 1]] - points[axis * nodes + spare[end]];
                if (width > widest) {
                    widest = width;
                    for (Int position = end; position < high; position++) order[position] = spare[position];
                }
            }
        }
        for (Int position = low; position < end; position++) place[lines[position]] = position;
        for (Int position = end; position < high; position++) place[order[position]] = position;
    }

    // Order the nodes of `part`, from `low` on, by least degree in what is left, counting neighbors ordered later.
    //
    // Neighborhoods are sets of bits: eliminating a node joins its neighborhood to that of each of its neighbors. `bit`
    // is -1 everywhere before and after.
    void minimum_degree(Int low, Int size, std::vector<uint64_t>& sets) {
        const Int* part = lines + low;
        Int *bit = mate, *degree = queue, bits = size;
        for (Int position = 0; position < size; position++) {
            Int node = part[position];
            bit[node] = position;
            for (Int entry = graph.starts[node]; entry < graph.starts[node + 1]; entry++) {
                Int other = graph.neighbours[entry];
                if ((place[other] < low || place[other] >= low + size) && bit[other] < 0) bit[other] = bits++;
            }
        }
        Int words = (bits + 63) >> 6;
        sets.assign(size * words, 0);
        for (Int position = 0; position < size; position++) {
            Int node = part[position];
            for (Int entry = graph.starts[node]; entry < graph.starts[node + 1]; entry++) {
                Int other = bit[graph.neighbours[entry]];
                sets[position * words + (other >> 6)] |= 1ull << (other & 63);
            }
            degree[position] = graph.starts[node + 1] - graph.starts[node];
        }
        const Int gone = 1ll << 60;
        for (Int step = 0; step < size; step++) {
            Int pivot = 0;
            for (Int position = 1; position < size; position++)
                if (degree[position] < degree[pivot]) pivot = position;
            order[low + step] = part[pivot];
            degree[pivot] = gone;
            const uint64_t* joined = &sets[pivot * words];
            for (Int position = 0; position < size; position++) {
                if (degree[position] == gone || !(joined[position >> 6] >> (position & 63) & 1)) continue;
                uint64_t* own = &sets[position * words];
                for (Int word = 0; word < words; word++) own[word] |= joined[word];
                own[pivot >> 6] &= ~(1ull << (pivot & 63));
                own[position >> 6] &= ~(1ull << (position & 63));
                Int count = 0;
                for (Int word = 0; word < words; word++) count += __builtin_popcountll(own[word]);
                degree[position] = count;
            }
        }
        for (Int position = 0; position < size; position++) {
            Int node = part[position];
            bit[node] = -1;
            for (Int entry = graph.starts[node]; entry < graph.starts[node + 1]; entry++)
                bit[graph.neighbours[entry]] = -1;
        }
        for (Int step = low; step < low + size; step++) place[order[step]] = step;
    }

    void run(Int leaf, const double* shares, Int count, Int* todo) {
        const double none = std::numeric_limits<double>::infinity();
        std::vector<uint64_t> sets;
        for (Int position = 0; position < nodes; position++) place[lines[position]] = position;
        todo[0] = 0;
        todo[1] = nodes;
        for (Int waiting = 1; waiting > 0;) {
            waiting--;
            Int low = todo[2 * waiting], high = todo[2 * waiting + 1], length = high - low, middle, end;
            double least = none;
            for (Int axis = 0; length > leaf && axis < axes; axis++) {
                const Int* line = lines + axis * nodes + low;
                for (Int which = 0; which < count; which++) {
                    double score = separator(line, length, (Int)(length * shares[which]));
                    if (score < least) {
                        least = score;
                        for (Int rank = 0; rank < length; rank++) best[line[rank]] = side[line[rank]];
                    }
                    for (Int rank = 0; rank < length; rank++) side[line[rank]] = 0;
                }
            }
            if (least < none) {
                arrange(low, high, middle, end);
                todo[2 * waiting] = low;
                todo[2 * waiting + 1] = middle;
                todo[2 * waiting + 2] = middle;
                todo[2 * waiting + 3] = end;
                waiting += 2;
            } else if (length > 0) {
                minimum_degree(low, length, sets);
            }
        }
    }
};

// Each node once.
void demand_permutation(const Int* line, Int nodes) {
    std::vector<bool> seen(nodes, false);
    demand_below(line, nodes, nodes, "a line has no such node");
    for (Int rank = 0; rank < nodes; rank++) {
        demand(!seen[line[rank]], "a line has a node twice");
        seen[line[rank]] = true;
    }
}

// Fill `order`. `lines` are the nodes sorted by each coordinate, at first all of them, in the end part by part.
//
// `work` is -1, `sides` 0 everywhere; `todo` and `room` hold anything.
void dissect(Counts<1> starts, Counts<1> neighbours, Reals<2> points, Array<Int, 2> lines, Int leaf, Reals<1> shares,
             Array<Int, 1> order, Array<Int, 2> work, Array<Int, 2> sides, Array<Int, 2> todo, Array<Int, 2> room) {
    Int nodes = (Int)order.shape(0);
    demand(points.shape(0) == lines.shape(0) && (Int)points.shape(1) == nodes &&
               (Int)lines.shape(1) == nodes && (Int)work.size() >= 2 * nodes && (Int)sides.size() == 3 * nodes &&
               (Int)todo.size() == 2 * nodes + 2 && (Int)room.size() == 3 * nodes, "sizes of the graph");
    Int *spare = work.data(), *side = sides.data(), *free = room.data();
    for (Int axis = 0; axis < (Int)lines.shape(0); axis++) demand_permutation(lines.data() + axis * nodes, nodes);
    for (size_t which = 0; which < shares.size(); which++)
        demand(shares.data()[which] >= 0.0 && shares.data()[which] <= 1.0, "a share is from 0 to 1");
    demand_range(work, -1, 0, "work is -1 before");
    demand_below(sides, 1, "sides are 0 before");
    Dissection all{Graph(starts, neighbours, nodes), nodes, (Int)lines.shape(0), points.data(), lines.data(),
                   order.data(), spare, spare + nodes, side, side + nodes, side + 2 * nodes,
                   free, free + nodes, free + 2 * nodes};
    Free others(1e3 * nodes);
    all.run(leaf, shares.data(), (Int)shares.shape(0), todo.data());
}

}  // namespace

void add_ordering(nb::module_& module) {
    module.def("block_graph", &block_graph, given(), given(), given(), filled(), filled(), filled());
    module.def("distances", &distances, given(), given(), given(), filled(), filled());
    module.def("dissect", &dissect, given(), given(), given(), filled(), given(), given(), filled(), filled(),
               filled(), filled(), filled());
}
