// One table of kernels for the instruction set that this file is compiled for; LEVEL names it.
#include "quadratic.hpp"
#include "team.hpp"

#define JOIN(a, b) a##b
#define TABLE(level) JOIN(kernels_, level)
#define TEXT(level) #level
#define NAME(level) TEXT(level)

namespace {

// The variant of a kernel for a body in space, in plane stress or in plane strain.
#define CHOOSE(kernel, all, ...) \
    ((all).dim == 3 ? kernel<3, false>(all, __VA_ARGS__) \
     : (all).thin   ? kernel<2, true>(all, __VA_ARGS__) \
                    : kernel<2, false>(all, __VA_ARGS__))

double any_value(const Elements& all, const double* displacements) { return CHOOSE(value, all, displacements); }
void any_gradient(const Elements& all, const double* displacements, double* total) {
    CHOOSE(gradient, all, displacements, total);
}
bool any_hessian(const Elements& all, const double* displacements, double share, const Blocks& blocks) {
    return CHOOSE(hessian, all, displacements, share, blocks);
}
double any_quadratic_value(const Quadratics& all, const double* displacements) {
    return CHOOSE(quadratic_value, all, displacements);
}
double any_quadratic_least(const Quadratics& all, const double* displacements) {
    return all.dim == 2 ? quadratic_least<2>(all, displacements) : quadratic_least<3>(all, displacements);
}
void any_quadratic_gradient(const Quadratics& all, const double* displacements, double* total) {
    CHOOSE(quadratic_gradient, all, displacements, total);
}
bool any_quadratic_hessian(const Quadratics& all, const double* displacements, double share, const Blocks& blocks) {
    return CHOOSE(quadratic_hessian, all, displacements, share, blocks);
}
void any_turn(const Elements& all, const double* nodes, const double* step, double* right) {
    all.dim == 2 ? turn<2>(all, nodes, step, right) : turn<3>(all, nodes, step, right);
}

double any_largest(const Fronts& fronts, const double* data) { return largest_diagonal(fronts, data); }

}  // namespace

extern const Kernels TABLE(LEVEL) = {NAME(LEVEL), LANES, any_value, any_gradient, any_hessian,
                                     any_quadratic_value, any_quadratic_least, any_quadratic_gradient,
                                     any_quadratic_hessian, any_turn,
                                     factorise, any_largest, join, any_forward, any_backward};
