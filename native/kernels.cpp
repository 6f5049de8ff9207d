// One table of kernels for the instruction set that this file is compiled for; LEVEL names it.
#include "quadratic.hpp"
#include "team.hpp"

#define JOIN(a, b) a##b
#define TABLE(level) JOIN(kernels_, level)
#define TEXT(level) #level
#define NAME(level) TEXT(level)

namespace {

double any_value(const Elements& all, const double* displacements) {
    return all.dim == 2 ? value<2>(all, displacements) : value<3>(all, displacements);
}
void any_gradient(const Elements& all, const double* displacements, double* total) {
    all.dim == 2 ? gradient<2>(all, displacements, total) : gradient<3>(all, displacements, total);
}
bool any_hessian(const Elements& all, const double* displacements, double share, const Blocks& blocks) {
    return all.dim == 2 ? hessian<2>(all, displacements, share, blocks) : hessian<3>(all, displacements, share, blocks);
}
double any_quadratic_value(const Quadratics& all, const double* displacements) {
    return all.dim == 2 ? quadratic_value<2>(all, displacements) : quadratic_value<3>(all, displacements);
}
double any_quadratic_least(const Quadratics& all, const double* displacements) {
    return all.dim == 2 ? quadratic_least<2>(all, displacements) : quadratic_least<3>(all, displacements);
}
void any_quadratic_gradient(const Quadratics& all, const double* displacements, double* total) {
    all.dim == 2 ? quadratic_gradient<2>(all, displacements, total) : quadratic_gradient<3>(all, displacements, total);
}
bool any_quadratic_hessian(const Quadratics& all, const double* displacements, double share, const Blocks& blocks) {
    return all.dim == 2 ? quadratic_hessian<2>(all, displacements, share, blocks)
                        : quadratic_hessian<3>(all, displacements, share, blocks);
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
