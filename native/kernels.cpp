// One table of kernels for the instruction set that this file is compiled for; LEVEL names it.
#include "elements.hpp"
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
void any_turn(const Elements& all, const double* nodes, const double* step, double* right) {
    all.dim == 2 ? turn<2>(all, nodes, step, right) : turn<3>(all, nodes, step, right);
}

double any_largest(const Fronts& fronts, const double* data) { return largest_diagonal(fronts, data); }

}  // namespace

extern const Kernels TABLE(LEVEL) = {NAME(LEVEL), LANES, any_value, any_gradient, any_hessian, any_turn,
                                     factorise, any_largest, join, any_forward, any_backward};
