// `hydrostat._native`: the compiled core for Python. Functions check shapes; those that take long let other threads run.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <stdexcept>
#include <vector>

#include "kernels.hpp"

namespace nb = nanobind;
template <class T, int N> using Array = nb::ndarray<T, nb::ndim<N>, nb::c_contig, nb::device::cpu>;
template <int N> using Reals = Array<const double, N>;

namespace {

const Kernels& chosen() {
#ifdef WITH_X86_LEVELS
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512bw"))
        return kernels_v4;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return kernels_v3;
#endif
    return kernels_base;
}

const Kernels& kernels = chosen();

// Lets other threads run while a call goes on for longer than handing over takes, some tens of microseconds.
struct Free {
    explicit Free(double nanoseconds) {
        if (nanoseconds > 3e4) state = PyEval_SaveThread();
    }
    ~Free() {
        if (state) PyEval_RestoreThread(state);
    }
    Free(const Free&) = delete;
    Free& operator=(const Free&) = delete;
    PyThreadState* state = nullptr;
};

void demand(bool right, const char* what) {
    if (!right) throw std::invalid_argument(what);
}

// Elements as they come from Python.
struct Packed {
    Elements all;

    Packed(const Array<const int32_t, 3>& stencils, const Array<const double, 4>& gradients, const Reals<2>& volumes,
           int64_t terms, double mu, double lame) {
        int64_t groups = (int64_t)stencils.shape(0), corners = (int64_t)stencils.shape(1);
        demand(stencils.shape(2) == 8 && gradients.shape(3) == 8 && volumes.shape(1) == 8, "groups must be of 8");
        demand((corners == 3 || corners == 4) && (int64_t)gradients.shape(1) == corners &&
                   (int64_t)gradients.shape(2) == corners - 1, "elements must be simplices");
        demand((int64_t)gradients.shape(0) == groups && (int64_t)volumes.shape(0) == groups &&
                   terms <= 8 * groups && terms > 8 * (groups - 1), "as many groups of each");
        all = {groups, terms, (int)corners - 1, stencils.data(), gradients.data(), volumes.data(), mu, lame};
    }
};

double value(Reals<2> displacements, Array<const int32_t, 3> stencils, Array<const double, 4> gradients,
             Reals<2> volumes, int64_t terms, double mu, double lame) {
    Packed packed(stencils, gradients, volumes, terms, mu, lame);
    demand((int)displacements.shape(1) == packed.all.dim, "dim of the displacements");
    Free free(9.0 * terms);
    return kernels.value(packed.all, displacements.data());
}

void gradient(Reals<2> displacements, Array<const int32_t, 3> stencils, Array<const double, 4> gradients,
              Reals<2> volumes, int64_t terms, double mu, double lame, Array<double, 2> total) {
    Packed packed(stencils, gradients, volumes, terms, mu, lame);
    demand((int)displacements.shape(1) == packed.all.dim && total.shape(0) == displacements.shape(0) &&
               total.shape(1) == displacements.shape(1), "shape of the total");
    Free free(15.0 * terms);
    kernels.gradient(packed.all, displacements.data(), total.data());
}

void hessian(Reals<2> displacements, Array<const int32_t, 3> stencils, Array<const double, 4> gradients,
             Reals<2> volumes, int64_t terms, double mu, double lame, double share, Array<const int64_t, 3> slots,
             Array<const int64_t, 1> strides, Array<double, 1> data) {
    Packed packed(stencils, gradients, volumes, terms, mu, lame);
    demand((int)displacements.shape(1) == packed.all.dim && (int64_t)slots.shape(0) == terms &&
               strides.shape(0) == displacements.shape(0), "shapes of displacements, slots and strides");
    Free free(120.0 * terms);
    kernels.hessian(packed.all, displacements.data(), share, slots.data(), strides.data(), data.data());
}

void turn(Reals<2> nodes, Reals<2> step, Array<const int32_t, 3> stencils, Array<const double, 4> gradients,
          Reals<2> volumes, int64_t terms, Array<double, 2> right) {
    Packed packed(stencils, gradients, volumes, terms, 0.0, 0.0);
    demand((int)nodes.shape(1) == packed.all.dim && step.shape(0) == nodes.shape(0) &&
               step.shape(1) == nodes.shape(1) && right.shape(0) == nodes.shape(0) &&
               right.shape(1) == nodes.shape(1), "shapes of nodes, step and right");
    Free free(25.0 * terms);
    kernels.turn(packed.all, nodes.data(), step.data(), right.data());
}

// Fronts as they come from Python.
Fronts plan(const Array<const int64_t, 2>& table, const Array<const int64_t, 1>& rows,
            const Array<const int64_t, 2>& runs, const Array<const int32_t, 2>& entries,
            const Array<const int64_t, 1>& diagonal) {
    demand(table.shape(1) == 11 && runs.shape(1) == 3 && entries.shape(1) == 2, "columns of the plan");
    return {(int64_t)table.shape(0) - 1, (int64_t)diagonal.shape(0), table.data(), rows.data(),
            runs.data(), entries.data(), diagonal.data()};
}

int64_t factorise(Array<const int64_t, 2> table, Array<const int64_t, 1> rows, Array<const int64_t, 2> runs,
                  Array<const int32_t, 2> entries, Array<const int64_t, 1> diagonal, Reals<1> data,
                  Array<double, 1> lower, Array<double, 1> signs, Array<double, 1> first, Array<double, 1> second,
                  Array<double, 1> spare, double tiny) {
    Fronts fronts = plan(table, rows, runs, entries, diagonal);
    demand(signs.shape(0) == diagonal.shape(0), "as many signs as degrees of freedom");
    Free free(0.3 * (double)lower.shape(0));
    return kernels.factorise(fronts, data.data(), lower.data(), signs.data(), first.data(), second.data(),
                             spare.data(), tiny);
}

// Solve for all or half of A = L S L^T: `way` 0 is A^-1, 1 is L^-1 (in the order of elimination), 2 is L^-T S.
// `place` is where each degree of freedom stands in the order of elimination.
void solve(Array<const int64_t, 2> table, Array<const int64_t, 1> rows, Array<const int64_t, 1> place,
           Reals<1> lower, Reals<1> signs, Reals<2> right, Array<double, 2> found, int way, int64_t height) {
    int64_t dofs = (int64_t)place.shape(0), sides = (int64_t)right.shape(1), count = (int64_t)table.shape(0) - 1;
    demand((int64_t)right.shape(0) == dofs && (int64_t)found.shape(0) == dofs && (int64_t)found.shape(1) == sides &&
               (int64_t)signs.shape(0) == dofs && table.shape(1) == 11, "shapes of the right-hand sides");
    Fronts fronts{count, dofs, table.data(), rows.data(), nullptr, nullptr, nullptr};
    const int64_t* at = place.data();
    const double* given = right.data();
    const double* sign = signs.data();
    double* out = found.data();
    Free free(0.2 * (double)lower.shape(0) * (double)(sides + 1));
    static thread_local std::vector<double> values, work;
    for (int64_t low = 0; low < sides; low += 16) {
        int some = (int)(sides - low < 16 ? sides - low : 16), width = some == 1 ? 1 : some <= 4 ? 4 : some <= 8 ? 8 : 16;
        values.assign(dofs * width + 8, 0.0);
        work.resize(height * width + 8);
        for (int64_t dof = 0; dof < dofs; dof++) {
            double* to = values.data() + (way == 2 ? dof : at[dof]) * width;
            double factor = way == 2 ? sign[dof] : 1.0;
            for (int side = 0; side < some; side++) to[side] = factor * given[dof * sides + low + side];
        }
        if (way != 2) kernels.forward(fronts, lower.data(), values.data(), width, work.data());
        if (way == 0)
            for (int64_t dof = 0; dof < dofs; dof++)
                if (sign[dof] < 0)
                    for (int side = 0; side < some; side++) values[dof * width + side] *= -1.0;
        if (way != 1) kernels.backward(fronts, lower.data(), values.data(), width, work.data());
        for (int64_t dof = 0; dof < dofs; dof++) {
            const double* from = values.data() + (way == 1 ? dof : at[dof]) * width;
            for (int side = 0; side < some; side++) out[dof * sides + low + side] = from[side];
        }
    }
}

}  // namespace

NB_MODULE(_native, module) {
    nb::set_leak_warnings(false);
    module.attr("instructions") = kernels.name;
    module.def("value", &value);
    module.def("gradient", &gradient);
    module.def("hessian", &hessian);
    module.def("turn", &turn);
    module.def("factorise", &factorise);
    module.def("solve", &solve);
}
