// Parts of a boundary that come near one another: the loops of geometry/boundary_tree.py and mechanics/self_contact.py.
//
// A pair is a node and an edge in the plane, a node and a triangle or two edges in space. Its squared distance is
// D(x) = min over l of F(x, l), l being where on its features the nearest points lie: F = |c|^2 with c = sum of w(l) x.
// Two edges that are nearly parallel have no certain nearest points, so that F has soft ((s - 1/2)^2 + (t - 1/2)^2) more
// where that is asked for.
//
// A pair of squared distance D has the energy W h^2 phi(D/h^2), phi(r) = -(r - 1)^2 ln r below r = 1, 0 above (the barrier of
// Li et al. 2020), h being the distance at which it begins. By the envelope theorem dD = dF and d2D = F_xx -
// F_xl F_ll^-1 F_lx, exactly, with the parts of l that are free, none at a corner.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <nanobind/stl/pair.h>

#include "arrays.hpp"

namespace {

using Int = int64_t;
const double NONE = std::numeric_limits<double>::infinity();

typedef float Four __attribute__((vector_size(16)));
typedef int Mask __attribute__((vector_size(16)));

double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Nearest points of a pair whose corners are at y: weights of the corners, and their slopes by what is free.
struct Nearest {
    double w[4], dw[2][4], c[3], squared;
    int free;

    // Weights of the point nearest y[0] between two corners, subtracted; how many parts of l are free.
    void on_edge(const double (*y)[3], int a, int b) {
        double along = 0.0, before = 0.0;
        for (int k = 0; k < 3; k++) {
            double span = y[b][k] - y[a][k];
            along += span * span;
            before += span * (y[0][k] - y[a][k]);
        }
        double share = std::min(std::max(before / std::max(along, 1e-300), 0.0), 1.0);
        w[a] = -(1.0 - share), w[b] = -share;
        dw[0][a] = 1.0, dw[0][b] = -1.0;
        free = 0.0 < share && share < 1.0 ? 1 : 0;
    }

    // The same for the point of the triangle y[1:] nearest y[0], by the regions around it (Ericson 2005, 5.1.5).
    void on_triangle(const double (*y)[3]) {
        double u[3], v[3], p[3];
        for (int k = 0; k < 3; k++) u[k] = y[2][k] - y[1][k], v[k] = y[3][k] - y[1][k], p[k] = y[0][k] - y[1][k];
        double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), up = dot(u, p), vp = dot(v, p);
        free = 0;
        if (up <= 0.0 && vp <= 0.0) return void(w[1] = -1.0);
        if (up >= uu && vp - uv <= up - uu) return void(w[2] = -1.0);
        if (vp >= vv && up - uv <= vp - vv) return void(w[3] = -1.0);
        double one = vv * up - uv * vp, two = uu * vp - uv * up, whole = uu * vv - uv * uv;
        if (two <= 0.0 && 0.0 <= up && up <= uu) return on_edge(y, 1, 2);
        if (one <= 0.0 && 0.0 <= vp && vp <= vv) return on_edge(y, 1, 3);
        if (one + two >= whole) return on_edge(y, 2, 3);
        one = one / whole, two = two / whole;
        w[1] = -(1.0 - one - two), w[2] = -one, w[3] = -two;
        dw[0][1] = 1.0, dw[0][2] = -1.0, dw[1][1] = 1.0, dw[1][3] = -1.0;
        free = 2;
    }

    // The same for the points of the edges y[:2] and y[2:] that make F least.
    void on_edges(const double (*y)[3], double soft) {
        double u[3], v[3], p[3];
        for (int k = 0; k < 3; k++) u[k] = y[1][k] - y[0][k], v[k] = y[3][k] - y[2][k], p[k] = y[0][k] - y[2][k];
        double a = dot(u, u) + soft, b = dot(u, v), c = dot(v, v) + soft;
        double d = dot(u, p) - 0.5 * soft, e = dot(v, p) + 0.5 * soft;
        double s = std::min(std::max((b * e - c * d) / std::max(a * c - b * b, 1e-300), 0.0), 1.0);
        double t = (e + b * s) / std::max(c, 1e-300);
        if (t < 0.0 || t > 1.0) {
            t = std::min(std::max(t, 0.0), 1.0);
            s = std::min(std::max((b * t - d) / std::max(a, 1e-300), 0.0), 1.0);
        }
        w[0] = 1.0 - s, w[1] = s, w[2] = -(1.0 - t), w[3] = -t;
        free = 0;
        if (0.0 < s && s < 1.0) dw[free][0] = -1.0, dw[free][1] = 1.0, free++;
        if (0.0 < t && t < 1.0) dw[free][2] = 1.0, dw[free][3] = -1.0, free++;
    }

    void find(const double (*y)[3], int corners, bool edges, double soft) {
        for (int i = 0; i < 4; i++) w[i] = 0.0, dw[0][i] = 0.0, dw[1][i] = 0.0;
        w[0] = 1.0;
        if (edges) on_edges(y, soft);
        else if (corners == 3) on_edge(y, 1, 2);
        else on_triangle(y);
        squared = 0.0;
        for (int k = 0; k < 3; k++) {
            c[k] = 0.0;
            for (int i = 0; i < corners; i++) c[k] += w[i] * y[i][k];
            squared += c[k] * c[k];
        }
        if (edges) {
            double one = w[1] - 0.5, two = -w[3] - 0.5;
            squared += soft * (one * one + two * two);
        }
    }
};

void place(const double* x, int dim, const Int* stencil, int corners, double (*y)[3]) {
    for (int i = 0; i < corners; i++)
        for (int k = 0; k < 3; k++) y[i][k] = k < dim ? x[stencil[i] * dim + k] : 0.0;
}

// Whether a plane across the line between the middles of two features, which move from somewhere by a straight way, keeps
// them so far apart that they neither come within reach (given squared) nor lose more of their gap than is allowed.
template <int DIM, int FIRST, class Number>
auto parted_by(const Number (*from)[DIM], const Number (*way)[DIM], Number near, Number kept) {
    typedef std::conditional_t<std::is_same_v<Number, double>, double, float> Real;
    Number across[DIM], length{}, square{};
    for (int k = 0; k < DIM; k++) {
        Number before{}, turn{};
        for (int i = 0; i <= DIM; i++) {
            Real weight = i < FIRST ? Real(1) / FIRST : Real(-1) / (DIM + 1 - FIRST);
            before += weight * from[i][k];
            turn += weight * way[i][k];
        }
        across[k] = before + 0.5f * turn;
        length += before * before, square += across[k] * across[k];
    }
    Number gap{};
    for (int turn = 0; turn < 2; turn++) {
        Number least{}, most{};
        for (int i = 0; i <= DIM; i++) {
            Number end{};
            for (int k = 0; k < DIM; k++) end += across[k] * (turn ? from[i][k] + way[i][k] : from[i][k]);
            if (i == 0) least = end;
            else if (i < FIRST) least = end < least ? end : least;
            else if (i == FIRST) most = end;
            else most = end > most ? end : most;
        }
        Number between = least - most;
        if (turn == 0) gap = between;
        else gap = between < gap ? between : gap;
    }
    Number allowed = 1.44f * kept * kept * length;
    return (gap > 0.0f) & (gap * gap > (near > allowed ? near : allowed) * square);
}

// A straight move of all nodes.
struct Move {
    const double *x, *move, *rest;
    int dim;
    double kept;

    // The share of the move that a pair admits; `close` tells whether it may come within reach up to there.
    double advanced(const Int* stencil, bool edges, double limit, double reach, bool& close) const {
        int corners = dim + 1, first = edges ? 2 : 1;
        double y[4][3], way[4][3];
        place(move, dim, stencil, corners, way);
        for (int k = 0; k < 3; k++) {
            double mean = 0.0;
            for (int i = 0; i < corners; i++) mean += way[i][k] / corners;
            for (int i = 0; i < corners; i++) way[i][k] -= mean;
        }
        double speeds = 0.0;
        for (int side = 0; side < 2; side++) {
            double fastest = 0.0;
            for (int i = side ? first : 0; i < (side ? corners : first); i++)
                fastest = std::max(fastest, dot(way[i], way[i]));
            speeds += std::sqrt(fastest);
        }
        Nearest pair;
        place(x, dim, stencil, corners, y);
        pair.find(y, corners, edges, 0.0);
        double distance = std::sqrt(pair.squared);
        close = distance - speeds * limit < reach;
        if (distance * (1.0 - kept) > speeds * limit) return limit;
        place(rest, dim, stencil, corners, y);
        pair.find(y, corners, edges, 0.0);
        if (pair.squared == 0.0) return limit;
        place(x, dim, stencil, corners, y);
        double least = kept * distance, done = 0.0;
        for (int round = 0; round < 200; round++) {
            double step = 0.95 * (distance - least) / speeds;
            if (done + step >= limit) return limit;
            done += step;
            for (int i = 0; i < corners; i++)
                for (int k = 0; k < 3; k++) y[i][k] += step * way[i][k];
            pair.find(y, corners, edges, 0.0);
            distance = std::sqrt(pair.squared);
            if (distance < 1.1 * least) break;
        }
        return done;
    }

    bool ends_within(const Int* stencil, bool edges, double limit, double reach) const {
        int corners = dim + 1;
        double y[4][3], way[4][3];
        place(x, dim, stencil, corners, y);
        place(move, dim, stencil, corners, way);
        for (int i = 0; i < corners; i++)
            for (int k = 0; k < 3; k++) y[i][k] += limit * way[i][k];
        Nearest pair;
        pair.find(y, corners, edges, 0.0);
        return pair.squared < reach * reach;
    }

    // Whether a plane parts two features all the way, as said at `parted_by`.
    bool passes(const Int* stencil, int first, double limit, double reach) const {
        if (dim == 2) return apart<2, 1>(stencil, limit, reach);
        return first == 1 ? apart<3, 1>(stencil, limit, reach) : apart<3, 2>(stencil, limit, reach);
    }

    template <int DIM, int FIRST>
    bool apart(const Int* stencil, double limit, double reach) const {
        double from[DIM + 1][DIM], to[DIM + 1][DIM];
        for (int i = 0; i <= DIM; i++)
            for (int k = 0; k < DIM; k++) {
                from[i][k] = x[stencil[i] * DIM + k];
                to[i][k] = limit * move[stencil[i] * DIM + k];
            }
        return parted_by<DIM, FIRST>(from, to, reach * reach, kept);
    }
};

// Boxes in single precision, wide enough for what rounding takes: lowest corner, and less the highest one.

bool any(Mask mask) {
#ifdef __SSE__
    return __builtin_ia32_movmskps((Four)mask) != 0;
#endif
    typedef int64_t Halves __attribute__((vector_size(16)));
    Halves halves = (Halves)mask;
    return (halves[0] | halves[1]) != 0;
}

struct Box {
    Four low, high;  // high is that of the highest corner, less

    void join(const Box& other) {
        low = low < other.low ? low : other.low;
        high = high < other.high ? high : other.high;
    }
};

void demand_nodes(const Int* numbers, Int count, Int nodes, const char* what) {
    for (Int i = 0; i < count; i++) demand(numbers[i] >= -1 && numbers[i] < nodes, what);
}

// A tree of boxes of facets, with the features that belong to each.
struct Tree {
    Int boxes, count, width;
    int dim;
    const Int *children, *facets, *points, *edges;

    Tree(const Counts<2>& children, const Counts<2>& facets, const Counts<2>& points, const Counts<2>& edges, Int nodes)
        : boxes((Int)children.shape(0)), count((Int)facets.shape(0)), width((Int)edges.shape(1)), dim((int)facets.shape(1)),
          children(children.data()), facets(facets.data()), points(points.data()), edges(edges.data()) {
        demand((dim == 2 || dim == 3) && children.shape(1) == 2 && (Int)points.shape(0) == count &&
                   (int)points.shape(1) == dim && (Int)edges.shape(0) == count && width == (dim == 3 ? 6 : 0),
               "features of each facet");
        demand_nodes(this->points, count * dim, nodes, "a point is no node");
        demand_nodes(this->edges, count * width, nodes, "an edge has no nodes");
        for (Int i = 0; i < count * dim; i++) demand(this->facets[i] >= 0 && this->facets[i] < nodes, "no such node");
        for (Int i = 0; i < count * width; i += 2)
            demand((this->edges[i] < 0) == (this->edges[i + 1] < 0), "an edge with one end");
        for (Int box = 0; box < boxes; box++) {
            Int one = this->children[2 * box], other = this->children[2 * box + 1];
            demand(one < 0 ? other >= 0 && other < count : one > box && other > box && one < boxes && other < boxes,
                   "children come after their parents");
        }
    }

    bool is_leaf(Int box) const { return children[2 * box] < 0; }
    Int facet_of(Int leaf) const { return children[2 * leaf + 1]; }
};

// A box of places and a box of ways.
struct alignas(64) Moving {
    Box at, way;

    void join(const Moving& other) { at.join(other.at), way.join(other.way); }
};

// The boxes of a tree, of its nodes and edges, wider by half of a reach.
struct Boxes {
    std::vector<Moving> tree, nodes, edges;  // of an edge: at the place that it has in the list of its facet

    Boxes(const Tree& all, const double* x, const double* move, Int count, double reach)
        : tree(all.boxes), nodes(count), edges(all.count * (all.width / 2)) {
        double widest = 0.0, longest = 0.0;
        for (Int i = 0; i < count * all.dim; i++) {
            widest = std::max(widest, std::abs(x[i]));
            longest = std::max(longest, std::abs(move[i]));
        }
        float margin = (float)(4e-7 * widest + 0.5 * reach), way_margin = (float)(4e-7 * longest);
        for (Int node = 0; node < count; node++) {
            Moving box{};
            for (int k = 0; k < all.dim; k++) {
                float at = (float)x[node * all.dim + k], by = (float)move[node * all.dim + k];
                box.at.low[k] = at - margin, box.at.high[k] = -at - margin;
                box.way.low[k] = by - way_margin, box.way.high[k] = -by - way_margin;
            }
            nodes[node] = box;
        }
        for (size_t place = 0; place < edges.size(); place++) {
            const Int* ends = all.edges + 2 * place;
            if (ends[0] < 0) continue;
            edges[place] = nodes[ends[0]];
            edges[place].join(nodes[ends[1]]);
        }
        for (Int at = all.boxes - 1; at >= 0; at--) {
            const Int* facet = all.facets + all.facet_of(at) * all.dim;
            bool leaf = all.is_leaf(at);
            Moving box = leaf ? nodes[facet[0]] : tree[all.children[2 * at]];
            if (!leaf) box.join(tree[all.children[2 * at + 1]]);
            for (int corner = 1; leaf && corner < all.dim; corner++) box.join(nodes[facet[corner]]);
            tree[at] = box;
        }
    }
};

// Whether two boxes, each of which moves by any of its ways, stay apart along one axis up to a share of the ways.
struct Passing {
    const Boxes& own;
    const float& limit;
    bool test(const Moving& one, const Moving& other) const {
        Four gap = one.at.low + other.at.high, closing = one.way.low + other.way.high;
        Four back = other.at.low + one.at.high, returning = other.way.low + one.way.high;
        return any(((gap > 0.0f) & (gap + limit * closing > 0.0f)) |
                   ((back > 0.0f) & (back + limit * returning > 0.0f)));
    }
    bool boxes(Int one, Int other) const { return test(own.tree[one], own.tree[other]); }
    bool node(Int node, Int leaf) const { return test(own.nodes[node], own.tree[leaf]); }
    bool edges(Int one, Int other) const { return test(own.edges[one], own.edges[other]); }
};

// Go down from some pairs of boxes; `skip` leaves out pairs of boxes of the tree, of a node and a leaf, of edges. Each
// pair of features without a common node goes to `visit`.
template <class Visit>
void descend(const Tree& tree, const Int* begin, Int count, const Passing& skip, const Visit& visit) {
    std::vector<Int> stack(8 * tree.boxes + 8);
    Int top = 0, dim = tree.dim, each = tree.width / 2;
    auto push = [&](Int one, Int other) { stack[top++] = one, stack[top++] = other; };
    auto leaves = [&](Int one, Int other) {
        Int stencil[4], sides[2] = {one, other};
        for (int turn = 0; turn < 2; turn++) {
            Int leaf = sides[1 - turn], f = tree.facet_of(sides[turn]);
            const Int* facet = tree.facets + tree.facet_of(leaf) * dim;
            for (int corner = 0; corner < dim; corner++) {
                Int node = tree.points[f * dim + corner];
                if (node < 0 || skip.node(node, leaf)) continue;
                if (node == facet[0] || node == facet[1] || (dim == 3 && node == facet[2])) continue;
                stencil[0] = node;
                for (int k = 0; k < dim; k++) stencil[1 + k] = facet[k];
                visit(stencil, 1);
            }
        }
        Int f = tree.facet_of(one), g = tree.facet_of(other);
        for (Int i = f * each; i < (f + 1) * each; i++) {
            Int p = tree.edges[2 * i], q = tree.edges[2 * i + 1];
            if (p < 0) continue;
            stencil[0] = p, stencil[1] = q;
            for (Int j = g * each; j < (g + 1) * each; j++) {
                Int a = tree.edges[2 * j], b = tree.edges[2 * j + 1];
                if (a < 0 || p == a || p == b || q == a || q == b || skip.edges(i, j)) continue;
                stencil[2] = a, stencil[3] = b;
                visit(stencil, 2);
            }
        }
    };
    for (Int next = 0; top > 0 || next < count;) {
        if (top == 0) {
            Int one = begin[2 * next], other = begin[2 * next + 1];
            next++;
            if (skip.boxes(one, other)) continue;
            push(one, other);
        }
        Int other = stack[--top], one = stack[--top];
        Int left = tree.children[2 * one], right = tree.children[2 * one + 1];
        if (left < 0 && tree.is_leaf(other)) {
            leaves(one, other);
            continue;
        }
        if (left < 0 || (!tree.is_leaf(other) && other < one)) {  // the larger box: they are numbered level by level
            left = tree.children[2 * other], right = tree.children[2 * other + 1];
            other = one;
        }
        if (!skip.boxes(left, other)) push(left, other);
        if (!skip.boxes(right, other)) push(right, other);
    }
}

// Pairs as they come from Python.
struct Listed {
    Int count, nodes;
    int dim, corners;
    const double* x;
    const Int* stencils;
    const bool* edges;

    Listed(const Reals<2>& x, const Counts<2>& stencils, const Array<const bool, 1>& edges)
        : count((Int)stencils.shape(0)), nodes((Int)x.shape(0)), dim((int)x.shape(1)), corners(dim + 1), x(x.data()),
          stencils(stencils.data()), edges(edges.data()) {
        demand((dim == 2 || dim == 3) && (int)stencils.shape(1) == corners && (Int)edges.shape(0) == count,
               "as many pairs of each");
        Int beyond = 0;
        for (Int i = 0; i < count * corners; i++) beyond |= this->stencils[i] | (nodes - 1 - this->stencils[i]);
        demand(beyond >= 0, "a corner is no node");
    }

    // Which pairs `parted_by` tells apart all the way, four at once in single precision; a few less than there are.
    std::vector<bool> parted(const double* move, double kept, double reach) const {
        std::vector<bool> found(count);
        std::vector<float> from(x, x + nodes * dim), way(move, move + nodes * dim);
        float widest = 0.0f;
        for (Int i = 0; i < nodes * dim; i++) widest = std::max({widest, std::abs(from[i]), std::abs(way[i])});
        float near = (float)reach + 1e-4f * widest;
        for (Int pair = 0; pair + 4 <= count; pair += 4) {
            const bool* kind = edges + pair;
            if (kind[0] != kind[1] || kind[0] != kind[2] || kind[0] != kind[3]) continue;
            Mask mask = dim == 2 ? four<2, 1>(from.data(), way.data(), pair, near, (float)kept)
                                 : (kind[0] ? four<3, 2>(from.data(), way.data(), pair, near, (float)kept)
                                            : four<3, 1>(from.data(), way.data(), pair, near, (float)kept));
            for (int lane = 0; lane < 4; lane++) found[pair + lane] = mask[lane] != 0;
        }
        return found;
    }

    template <int DIM, int FIRST>
    Mask four(const float* from, const float* way, Int pair, float near, float kept) const {
        Four begin[DIM + 1][DIM], by[DIM + 1][DIM];
        for (int i = 0; i <= DIM; i++) {
            const float *at[4], *to[4];
            for (int lane = 0; lane < 4; lane++) {
                Int node = stencils[(pair + lane) * (DIM + 1) + i];
                at[lane] = from + node * DIM, to[lane] = way + node * DIM;
            }
            for (int k = 0; k < DIM; k++) {
                begin[i][k] = Four{at[0][k], at[1][k], at[2][k], at[3][k]};
                by[i][k] = Four{to[0][k], to[1][k], to[2][k], to[3][k]};
            }
        }
        return parted_by<DIM, FIRST>(begin, by, Four{} + near * near, Four{} + kept);
    }

    // D of a pair; fills in w, dw/dl and c. How many parts of l are free, and D.
    Nearest nearest(Int pair, double soft, double (*y)[3]) const {
        Nearest found;
        place(x, dim, stencils + pair * corners, corners, y);
        found.find(y, corners, edges[pair], soft);
        return found;
    }
};

std::pair<double, Int> sweep_boundary(Counts<2> children, Counts<2> facets, Counts<2> points, Counts<2> edges,
                                    Counts<2> front, Counts<2> beside, Array<const bool, 1> kinds, Reals<2> nodes,
                                    Reals<2> move, Reals<2> rest, double kept, double reach, Array<Int, 2> stencils,
                                    Array<bool, 1> both) {
    Tree tree(children, facets, points, edges, (Int)nodes.shape(0));
    int dim = tree.dim;
    Listed neighbours(nodes, beside, kinds);
    demand(front.shape(1) == 2, "pairs of boxes");
    for (size_t i = 0; i < front.size(); i++)
        demand(front.data()[i] >= 0 && front.data()[i] < tree.boxes, "no such box");
    demand((int)nodes.shape(1) == dim && move.size() == nodes.size() && rest.size() == nodes.size() &&
               (int)stencils.shape(1) == dim + 1 && both.shape(0) == stencils.shape(0), "shapes of nodes and pairs");
    Move all{nodes.data(), move.data(), rest.data(), dim, kept};
    double limit = 1.0;
    float rounded = 1.0f;
    Int found = 0, room = (Int)stencils.shape(0);
    Free free(100.0 * tree.boxes);
    Boxes boxes(tree, nodes.data(), move.data(), (Int)nodes.shape(0), reach);
    auto visit = [&](const Int* stencil, int first) {
        bool close;
        if (all.passes(stencil, first, limit, reach)) return;
        limit = all.advanced(stencil, first == 2, limit, reach, close);
        rounded = (float)limit * 1.000001f;
        if (!close) return;
        if (found < room) {
            std::copy(stencil, stencil + dim + 1, stencils.data() + found * (dim + 1));
            both.data()[found] = first == 2;
        }
        found++;
    };
    std::vector<bool> parted = neighbours.parted(move.data(), kept, reach);
    for (Int pair = 0; pair < neighbours.count; pair++)
        if (!parted[pair]) visit(neighbours.stencils + pair * (dim + 1), neighbours.edges[pair] ? 2 : 1);
    descend(tree, front.data(), (Int)front.shape(0), Passing{boxes, rounded}, visit);
    if (found > room) return {limit, found};
    Int last = 0;
    for (Int pair = 0; pair < found; pair++) {
        const Int* stencil = stencils.data() + pair * (dim + 1);
        if (!all.ends_within(stencil, both.data()[pair], limit, reach)) continue;
        std::copy(stencil, stencil + dim + 1, stencils.data() + last * (dim + 1));
        both.data()[last++] = both.data()[pair];
    }
    return {limit, last};
}

// Fill in where samples of a boundary are: shares of the nodes at their corners.
void sample_places(Reals<2> x, Counts<2> corners, Reals<2> shares, Array<double, 2> places) {
    Int count = (Int)corners.shape(0), width = (Int)corners.shape(1), dim = (Int)x.shape(1);
    demand((Int)shares.shape(0) == count && (Int)shares.shape(1) == width && (Int)places.shape(0) == count &&
               (Int)places.shape(1) == dim,
           "corners, shares and places of the same samples");
    const Int* nodes = demand_range(corners, 0, (Int)x.shape(0), "a corner is no node");
    const double *weights = shares.data(), *at = x.data();
    double* out = places.data();
    for (Int sample = 0; sample < count; sample++)
        for (Int k = 0; k < dim; k++) {
            double sum = 0.0;
            for (Int i = 0; i < width; i++) sum += weights[sample * width + i] * at[nodes[sample * width + i] * dim + k];
            out[sample * dim + k] = sum;
        }
}

// Fill in D of each pair [m^2].
void squared_distances(Reals<2> x, Counts<2> stencils, Array<const bool, 1> edges, double soft,
                       Array<double, 1> squared) {
    Listed all(x, stencils, edges);
    demand((Int)squared.shape(0) == all.count, "a distance of each pair");
    double y[4][3];
    for (Int pair = 0; pair < all.count; pair++) squared.data()[pair] = all.nearest(pair, soft, y).squared;
}

// Largest share, at most 1, of a straight move after which each of some pairs keeps a share of its distance.
double admissible_share(Reals<2> x, Reals<2> move, Reals<2> rest, Counts<2> stencils, Array<const bool, 1> edges,
                        double kept) {
    Listed all(x, stencils, edges);
    demand(move.size() == x.size() && rest.size() == x.size(), "shapes of the nodes");
    Move way{x.data(), move.data(), rest.data(), all.dim, kept};
    double limit = 1.0;
    bool close;
    for (Int pair = 0; pair < all.count; pair++)
        limit = way.advanced(all.stencils + pair * all.corners, all.edges[pair], limit, 0.0, close);
    return limit;
}

struct Barrier {
    double value, slope, curve;

    Barrier(double squared, double begin, double weight) : value(0.0), slope(0.0), curve(0.0) {
        double r = squared / begin;
        if (r >= 1.0) return;
        if (r <= 0.0) {
            value = NONE, slope = -NONE, curve = NONE;
            return;
        }
        double log = -std::log(r), below = r - 1.0;
        value = weight * begin * below * below * log;
        slope = weight * (2.0 * below * log - below * below / r);
        curve = weight * (2.0 * log - 4.0 * below / r + below * below / (r * r)) / begin;
    }
};

void demand_laws(const Listed& all, const Reals<1>& begins, const Reals<1>& weights) {
    demand((Int)begins.shape(0) == all.count && (Int)weights.shape(0) == all.count, "a law of each pair");
}

std::pair<double, Int> barrier_energy(Reals<2> x, Counts<2> stencils, Array<const bool, 1> edges, double soft,
                                      Reals<1> begins, Reals<1> weights) {
    Listed all(x, stencils, edges);
    demand_laws(all, begins, weights);
    double y[4][3], total = 0.0;
    Int felt = 0;
    for (Int pair = 0; pair < all.count; pair++) {
        double squared = all.nearest(pair, soft, y).squared;
        if (!(squared < begins.data()[pair])) continue;
        total += Barrier(squared, begins.data()[pair], weights.data()[pair]).value;
        felt++;
    }
    return {total, felt};
}

// Fill in dE/dx of each pair [N].
void barrier_forces(Reals<2> x, Counts<2> stencils, Array<const bool, 1> edges, double soft, Reals<1> begins,
                    Reals<1> weights, Array<double, 3> blocks) {
    Listed all(x, stencils, edges);
    demand_laws(all, begins, weights);
    demand((Int)blocks.shape(0) == all.count && (int)blocks.shape(1) == all.corners && (int)blocks.shape(2) == all.dim,
           "forces of each pair");
    double y[4][3];
    for (Int pair = 0; pair < all.count; pair++) {
        Nearest near = all.nearest(pair, soft, y);
        Barrier law(near.squared, begins.data()[pair], weights.data()[pair]);
        double* block = blocks.data() + pair * all.corners * all.dim;
        for (int i = 0; i < all.corners; i++)
            for (int k = 0; k < all.dim; k++) block[i * all.dim + k] = 2.0 * law.slope * near.w[i] * near.c[k];
    }
}

// Add to a block what the nearest points give way on both features as the corners move.
void add_turning(const Nearest& near, int corners, int dim, const double (*y)[3], double extra, double push,
                 double* block) {
    int rows = corners * dim;
    double lines[2][3] = {}, mixed[2][12] = {};
    for (int q = 0; q < near.free; q++) {
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < corners; i++) lines[q][k] += near.dw[q][i] * y[i][k];
        for (int i = 0; i < corners; i++)
            for (int k = 0; k < dim; k++)
                mixed[q][dim * i + k] = near.w[i] * lines[q][k] + near.dw[q][i] * near.c[k];
    }
    double a00 = dot(lines[0], lines[0]) + extra, a11 = 1.0, a01 = 0.0;
    if (near.free == 2) a11 = dot(lines[1], lines[1]) + extra, a01 = dot(lines[0], lines[1]);
    push /= a00 * a11 - a01 * a01;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < rows; j++)
            block[i * rows + j] += push * (a11 * mixed[0][i] * mixed[0][j] + a00 * mixed[1][i] * mixed[1][j] -
                                           a01 * (mixed[0][i] * mixed[1][j] + mixed[1][i] * mixed[0][j]));
}

// A block of a pair acts on so many directions only: across both features and along them by w, across by the slopes dw.
const int BASIS = 5;

// Turn a symmetric matrix diagonal by Jacobi's rotations; the columns of `axes` become its eigenvectors.
void diagonalise(double (*m)[BASIS], double (*axes)[BASIS]) {
    for (int i = 0; i < BASIS; i++)
        for (int j = 0; j < BASIS; j++) axes[i][j] = i == j ? 1.0 : 0.0;
    double size = 0.0;
    for (int i = 0; i < BASIS; i++)
        for (int j = 0; j < BASIS; j++) size += m[i][j] * m[i][j];
    for (int round = 0; round < 20; round++) {
        double off = 0.0;
        for (int i = 0; i < BASIS; i++)
            for (int j = i + 1; j < BASIS; j++) off += m[i][j] * m[i][j];
        if (off <= 1e-30 * size) return;
        for (int p = 0; p < BASIS; p++)
            for (int q = p + 1; q < BASIS; q++) {
                if (m[p][q] == 0.0) continue;
                double turn = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
                double t = (turn < 0.0 ? -1.0 : 1.0) / (std::abs(turn) + std::sqrt(1.0 + turn * turn));
                double c = 1.0 / std::sqrt(1.0 + t * t), s = c * t;
                for (int k = 0; k < BASIS; k++) {
                    double a = m[k][p], b = m[k][q];
                    m[k][p] = c * a - s * b, m[k][q] = s * a + c * b;
                }
                for (int k = 0; k < BASIS; k++) {
                    double a = m[p][k], b = m[q][k];
                    m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
                    a = axes[k][p], b = axes[k][q];
                    axes[k][p] = c * a - s * b, axes[k][q] = s * a + c * b;
                }
            }
    }
}

// The directions in which the block of a pair acts: corner i moves by tips[i][d] along lines[d], for direction d.
struct Directions {
    double tips[4][BASIS], lines[BASIS][3];

    Directions(const Nearest& near, int corners) {
        double frame[3][3] = {}, span[3][4] = {};
        double length = std::sqrt(std::max(dot(near.c, near.c), 1e-300));
        for (int k = 0; k < 3; k++) frame[0][k] = near.c[k] / length;
        int least = 0;
        for (int k = 1; k < 3; k++)
            if (std::abs(frame[0][k]) < std::abs(frame[0][least])) least = k;
        frame[1][least] = 1.0;
        double along = dot(frame[1], frame[0]);
        for (int k = 0; k < 3; k++) frame[1][k] -= along * frame[0][k];
        double norm = std::sqrt(dot(frame[1], frame[1]));
        for (int k = 0; k < 3; k++) frame[1][k] /= norm;
        for (int k = 0; k < 3; k++)
            frame[2][k] = frame[0][(k + 1) % 3] * frame[1][(k + 2) % 3] - frame[0][(k + 2) % 3] * frame[1][(k + 1) % 3];
        for (int vector = 0; vector < 1 + near.free; vector++) {
            const double* from = vector ? near.dw[vector - 1] : near.w;
            double before = 0.0, after = 0.0;
            for (int i = 0; i < corners; i++) span[vector][i] = from[i], before += from[i] * from[i];
            for (int other = 0; other < vector; other++) {
                double share = 0.0;
                for (int i = 0; i < corners; i++) share += span[vector][i] * span[other][i];
                for (int i = 0; i < corners; i++) span[vector][i] -= share * span[other][i];
            }
            for (int i = 0; i < corners; i++) after += span[vector][i] * span[vector][i];
            double scale = after > 1e-20 * before ? 1.0 / std::sqrt(after) : 0.0;
            for (int i = 0; i < corners; i++) span[vector][i] *= scale;
        }
        for (int d = 0; d < BASIS; d++) {
            for (int k = 0; k < 3; k++) lines[d][k] = d < 3 ? frame[d][k] : frame[0][k];
            for (int i = 0; i < 4; i++) tips[i][d] = d < 3 ? span[0][i] : span[d - 2][i];
        }
    }
};

// Take a share of the negative eigenvalues out of the block of a pair.
void lift(const Nearest& near, int corners, int dim, double share, double* block) {
    int rows = corners * dim;
    Directions all(near, corners);
    double columns[BASIS][12] = {}, small[BASIS][BASIS] = {}, axes[BASIS][BASIS];
    for (int d = 0; d < BASIS; d++)
        for (int i = 0; i < corners; i++)
            for (int k = 0; k < dim; k++) columns[d][dim * i + k] = all.tips[i][d] * all.lines[d][k];
    for (int d = 0; d < BASIS; d++) {
        double image[12] = {};
        for (int i = 0; i < rows; i++)
            for (int j = 0; j < rows; j++) image[i] += block[i * rows + j] * columns[d][j];
        for (int e = 0; e < BASIS; e++)
            for (int i = 0; i < rows; i++) small[e][d] += columns[e][i] * image[i];
    }
    for (int d = 0; d < BASIS; d++)
        for (int e = 0; e < d; e++) small[d][e] = small[e][d] = 0.5 * (small[d][e] + small[e][d]);
    diagonalise(small, axes);
    for (int d = 0; d < BASIS; d++) {
        if (small[d][d] >= 0.0) continue;
        double axis[12] = {};
        for (int e = 0; e < BASIS; e++)
            for (int i = 0; i < rows; i++) axis[i] += axes[e][d] * columns[e][i];
        for (int i = 0; i < rows; i++)
            for (int j = 0; j < rows; j++) block[i * rows + j] -= share * small[d][d] * axis[i] * axis[j];
    }
}

// Fill in d2E/dx2 of each pair [N/m], with this share of its negative eigenvalues taken out.
void barrier_hessian(Reals<2> x, Counts<2> stencils, Array<const bool, 1> edges, double soft, Reals<1> begins,
                     Reals<1> weights, double share, Array<double, 3> blocks) {
    Listed all(x, stencils, edges);
    demand_laws(all, begins, weights);
    int corners = all.corners, dim = all.dim, rows = corners * dim;
    demand((Int)blocks.shape(0) == all.count && (int)blocks.shape(1) == rows && (int)blocks.shape(2) == rows,
           "a block of each pair");
    double y[4][3];
    for (Int pair = 0; pair < all.count; pair++) {
        double* block = blocks.data() + pair * rows * rows;
        std::fill(block, block + rows * rows, 0.0);
        Nearest near = all.nearest(pair, soft, y);
        if (near.squared >= begins.data()[pair]) continue;
        Barrier law(near.squared, begins.data()[pair], weights.data()[pair]);
        double length = std::max(dot(near.c, near.c), 1e-300);
        double across = 2.0 * law.slope, along = 4.0 * length * law.curve + 2.0 * law.slope;
        for (int i = 0; i < corners; i++)
            for (int j = 0; j < corners; j++)
                for (int a = 0; a < dim; a++)
                    for (int b = 0; b < dim; b++) {
                        double one = (along - across) * near.c[a] * near.c[b] / length;
                        if (a == b) one += across;
                        block[(dim * i + a) * rows + dim * j + b] = near.w[i] * near.w[j] * one;
                    }
        if (near.free > 0) add_turning(near, corners, dim, y, all.edges[pair] ? soft : 0.0, -2.0 * law.slope, block);
        if (share > 0.0) lift(near, corners, dim, share, block);
    }
}

}  // namespace

void add_contact(nb::module_& module) {
    module.def("sweep_boundary", &sweep_boundary, given(), given(), given(), given(), given(), given(), given(), given(),
               given(), given(), given(), given(), filled(), filled());
    module.def("sample_places", &sample_places, given(), given(), given(), filled());
    module.def("squared_distances", &squared_distances, given(), given(), given(), given(), filled());
    module.def("admissible_share", &admissible_share);
    module.def("barrier_energy", &barrier_energy);
    module.def("barrier_forces", &barrier_forces, given(), given(), given(), given(), given(), given(), filled());
    module.def("barrier_hessian", &barrier_hessian, given(), given(), given(), given(), given(), given(), given(),
               filled());
}
