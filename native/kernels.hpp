// What the compiled core offers, as plain functions on arrays; one table of them for each instruction set.
#pragma once
#include <cstdint>

// Simplices in groups of eight, whose numbers lie side by side: stencils (groups, corners, 8), shape gradients
// (groups, corners, dim, 8), volumes (groups, 8). The last group is filled up with elements of no volume.
struct Elements {
    int64_t groups, terms;
    int dim;
    const int32_t* stencils;
    const double* gradients;
    const double* volumes;
    const double* mu;    // Lame's parameters of each element, in groups like the volumes
    const double* lame;
    bool thin;           // plane stress
};

// Quadratic simplices in groups of eight: stencils (groups, nodes, 8), corners first; shape gradients (groups, points,
// nodes, dim, 8), F - I of undeformed nodes (groups, points, dim, dim, 8) and weights (groups, points, 8) at the points of
// quadrature; moduli (3, groups, 8): mu, lambda at each point, lambda of the mean volume.
struct Quadratics {
    int64_t groups, terms;
    int dim;
    const int32_t* stencils;
    const double* gradients;
    const double* offsets;  // none where it is 0
    const double* weights;
    const double* moduli;
    bool thin;              // plane stress
};

// Where the blocks of elements go in a matrix: the first number of each block, by element and its two corners; the
// distance between two columns of each node, of all nodes the `widest`; the numbers.
struct Blocks {
    const int64_t* slots;
    const int64_t* strides;
    int64_t widest, size;
    double* data;
};

// Where the fronts of a factorisation lie; the columns of `table` are those of `Fronts` in fronts.py.
struct Fronts {
    int64_t count, dofs;
    const int64_t* table;
    const int64_t* rows;
    const int64_t* runs;
    const int32_t* entries;
    const int64_t* diagonal;
};

// Several threads at one factorisation. First each takes whole subtrees of fronts, the rest they do together.
struct Team {
    int size;
    int64_t subtrees;
    const int64_t* begins;   // first front of each subtree; the last is in `ends`
    const int64_t* ends;
    int64_t tops;            // fronts above the subtrees, children before parents
    const int64_t* top;
    double** updates;        // what each front hands up, of those that are the last of a subtree or above them
    double* (*claim)(int64_t numbers);
    void (*release)(double* numbers);
    void (*yield)();
    double least;            // no pivot is smaller
    int64_t next[4];         // what to take next, step by step
    int64_t waiting, round;  // at the barrier
    int64_t negative, failed, short_of_memory;
};

// What one thread works in: stacks for its subtrees, packed parts of panels.
struct Room {
    int me;
    double* first;
    double* second;
    double* spare;   // as in `factorise`
    double* packed;  // PACKED numbers
};
constexpr int64_t PACKED = 256 * 256 + 256 * 8 + 16;

struct Kernels {
    const char* name;
    int lanes;  // doubles in a vector
    double (*value)(const Elements&, const double* displacements);
    void (*gradient)(const Elements&, const double* displacements, double* total);
    bool (*hessian)(const Elements&, const double* displacements, double share, const Blocks&);  // false: a block lies outside
    double (*quadratic_value)(const Quadratics&, const double* displacements);
    double (*quadratic_least)(const Quadratics&, const double* displacements);  // J where it is squeezed most
    void (*quadratic_gradient)(const Quadratics&, const double* displacements, double* total);
    bool (*quadratic_hessian)(const Quadratics&, const double* displacements, double share, const Blocks&);
    void (*turn)(const Elements&, const double* nodes, const double* step, double* right);
    int64_t (*factorise)(const Fronts&, const double* data, double* lower, double* signs, double* first,
                         double* second, double* spare, double tiny);
    double (*largest)(const Fronts&, const double* data);
    void (*join)(const Fronts&, Team&, const Room&, const double* data, double* lower, double* signs);
    void (*forward)(const Fronts&, const double* lower, double* values, int sides, double* work);
    void (*backward)(const Fronts&, const double* lower, double* values, int sides, double* work);
};

extern const Kernels kernels_base;
#ifdef WITH_X86_LEVELS
extern const Kernels kernels_v3;
extern const Kernels kernels_v4;
#endif
