// `hydrostat._native`: the compiled core for Python. Functions check shapes; those that take long let other threads run.
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bounds.hpp"
#include "checks.hpp"

namespace {

// Tables of kernels that the processor can run, the widest last.
std::vector<const Kernels*> levels() {
    std::vector<const Kernels*> found{&kernels_base};
#ifdef WITH_X86_LEVELS
    if (!(__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))) return found;
    found.push_back(&kernels_v3);
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512bw"))
        found.push_back(&kernels_v4);
#endif
    return found;
}

// The widest table, or the lower one that HYDROSTAT_LEVEL names.
const Kernels& choose_kernels() {
    const char* named = std::getenv("HYDROSTAT_LEVEL");
    const std::string level = named ? named : "";
    std::string names;
    for (const Kernels* found : levels()) {
        if (level == found->name) return *found;
        names += (names.empty() ? "" : ", ") + std::string(found->name);
    }
    if (!level.empty())
        throw std::invalid_argument("HYDROSTAT_LEVEL: unknown level \"" + level + "\". This processor has: " + names + ".");
    return *levels().back();
}

Kernels kernels = kernels_base;  // those that serve; chosen when the module is loaded

// Elements as they come from Python.
struct Packed {
    Elements all;

    Packed(const Reals<2>& field, const Array<const int32_t, 3>& stencils, const Array<const double, 4>& gradients, const Reals<2>& volumes,
           int64_t terms) {
        int64_t groups = (int64_t)stencils.shape(0), corners = (int64_t)stencils.shape(1);
        demand(stencils.shape(2) == 8 && gradients.shape(3) == 8 && volumes.shape(1) == 8, "groups must be of 8");
        demand((corners == 3 || corners == 4) && (int64_t)gradients.shape(1) == corners &&
                   (int64_t)gradients.shape(2) == corners - 1, "elements must be simplices");
        demand((int64_t)gradients.shape(0) == groups && (int64_t)volumes.shape(0) == groups &&
                   terms <= 8 * groups && terms > 8 * (groups - 1), "as many groups of each");
        all = {groups, terms, (int)corners - 1, stencils.data(), gradients.data(), volumes.data(), nullptr, nullptr, false};
        demand((int)field.shape(1) == all.dim, "dim of the nodes");
        demand_corners(all, (int64_t)field.shape(0));
    }

    // Lame's parameters: (2, groups, 8), mu first; `thin` in plane stress.
    void take_moduli(const Reals<3>& moduli, bool thin) {
        demand(!thin || all.dim == 2, "plane stress is for flat elements");
        all.thin = thin;
        demand(moduli.shape(0) == 2 && (int64_t)moduli.shape(1) == all.groups && moduli.shape(2) == 8,
               "two moduli of each element");
        all.mu = moduli.data();
        all.lame = moduli.data() + 8 * all.groups;
    }
};

double value(Reals<2> displacements, Array<const int32_t, 3> stencils, Array<const double, 4> gradients,
             Reals<2> volumes, int64_t terms, Reals<3> moduli, bool thin) {
    Packed packed(displacements, stencils, gradients, volumes, terms);
    packed.take_moduli(moduli, thin);
    Free free(9.0 * terms);
    return kernels.value(packed.all, displacements.data());
}

void gradient(Reals<2> displacements, Array<const int32_t, 3> stencils, Array<const double, 4> gradients,
              Reals<2> volumes, int64_t terms, Reals<3> moduli, bool thin, Array<double, 2> total) {
    Packed packed(displacements, stencils, gradients, volumes, terms);
    packed.take_moduli(moduli, thin);
    demand(total.shape(0) == displacements.shape(0) &&
               total.shape(1) == displacements.shape(1), "shape of the total");
    Free free(15.0 * terms);
    kernels.gradient(packed.all, displacements.data(), total.data());
}

void hessian(Reals<2> displacements, Array<const int32_t, 3> stencils, Array<const double, 4> gradients,
             Reals<2> volumes, int64_t terms, Reals<3> moduli, bool thin, double share, Array<const int64_t, 3> slots,
             Array<const int64_t, 1> strides, Array<double, 1> data) {
    Packed packed(displacements, stencils, gradients, volumes, terms);
    packed.take_moduli(moduli, thin);
    const size_t corners = stencils.shape(1);
    demand((int64_t)slots.shape(0) == terms && slots.shape(1) == corners && slots.shape(2) == corners &&
               strides.shape(0) == displacements.shape(0), "shapes of displacements, slots and strides");
    const int64_t size = (int64_t)data.shape(0), widest = demand_strides(strides.data(), (int64_t)strides.shape(0), size);
    bool inside;
    {
        Free free(120.0 * terms);
        inside = kernels.hessian(packed.all, displacements.data(), share, {slots.data(), strides.data(), widest, size, data.data()});
    }
    demand(inside, "a block lies outside the matrix");
}

// Quadratic elements as they come from Python; `offsets` is empty where it is 0.
Quadratics pack_quadratics(const Reals<2>& field, const Array<const int32_t, 3>& stencils, const Reals<5>& gradients,
                           const Reals<3>& weights, int64_t terms, const Reals<3>& moduli, const Reals<5>& offsets, bool thin) {
    const size_t groups = stencils.shape(0), corners = stencils.shape(1), dim = corners == 6 ? 2 : 3, points = dim + 1;
    demand(corners == 6 || corners == 10, "elements must be quadratic simplices");
    demand(stencils.shape(2) == 8 && gradients.shape(4) == 8 && weights.shape(2) == 8 && moduli.shape(2) == 8,
           "groups must be of 8");
    demand(gradients.shape(0) == groups && gradients.shape(1) == points && gradients.shape(2) == corners &&
               gradients.shape(3) == dim && weights.shape(0) == groups && weights.shape(1) == points &&
               moduli.shape(0) == 3 && moduli.shape(1) == groups && terms <= (int64_t)(8 * groups) &&
               terms > 8 * ((int64_t)groups - 1), "as many groups of each");
    demand(offsets.size() == 0 || (offsets.shape(0) == groups && offsets.shape(1) == points && offsets.shape(2) == dim &&
                                   offsets.shape(3) == dim && offsets.shape(4) == 8), "shape of the offsets");
    demand(field.shape(1) == dim, "dim of the nodes");
    const Quadratics all{(int64_t)groups, terms, (int)dim, stencils.data(), gradients.data(),
                         offsets.size() ? offsets.data() : nullptr, weights.data(), moduli.data(), thin};
    demand(!thin || dim == 2, "plane stress is for flat elements");
    demand_corners(all, (int64_t)field.shape(0));
    return all;
}

double quadratic_value(Reals<2> displacements, Array<const int32_t, 3> stencils, Reals<5> gradients, Reals<3> weights,
                       int64_t terms, Reals<3> moduli, Reals<5> offsets, bool thin) {
    const Quadratics all = pack_quadratics(displacements, stencils, gradients, weights, terms, moduli, offsets, thin);
    Free free(40.0 * terms);
    return kernels.quadratic_value(all, displacements.data());
}

double quadratic_least(Reals<2> displacements, Array<const int32_t, 3> stencils, Reals<5> gradients, Reals<3> weights,
                       int64_t terms, Reals<3> moduli, Reals<5> offsets, bool thin) {
    const Quadratics all = pack_quadratics(displacements, stencils, gradients, weights, terms, moduli, offsets, thin);
    Free free(30.0 * terms);
    return kernels.quadratic_least(all, displacements.data());
}

void quadratic_gradient(Reals<2> displacements, Array<const int32_t, 3> stencils, Reals<5> gradients, Reals<3> weights,
                        int64_t terms, Reals<3> moduli, Reals<5> offsets, bool thin, Array<double, 2> total) {
    const Quadratics all = pack_quadratics(displacements, stencils, gradients, weights, terms, moduli, offsets, thin);
    demand(total.shape(0) == displacements.shape(0) && total.shape(1) == displacements.shape(1), "shape of the total");
    Free free(80.0 * terms);
    kernels.quadratic_gradient(all, displacements.data(), total.data());
}

void quadratic_hessian(Reals<2> displacements, Array<const int32_t, 3> stencils, Reals<5> gradients, Reals<3> weights,
                       int64_t terms, Reals<3> moduli, Reals<5> offsets, bool thin, double share, Counts<3> slots, Counts<1> strides,
                       Array<double, 1> data) {
    const Quadratics all = pack_quadratics(displacements, stencils, gradients, weights, terms, moduli, offsets, thin);
    const size_t corners = stencils.shape(1);
    demand((int64_t)slots.shape(0) == terms && slots.shape(1) == corners && slots.shape(2) == corners &&
               strides.shape(0) == displacements.shape(0), "shapes of displacements, slots and strides");
    const int64_t size = (int64_t)data.shape(0), widest = demand_strides(strides.data(), (int64_t)strides.shape(0), size);
    bool inside;
    {
        Free free(1500.0 * terms);
        inside = kernels.quadratic_hessian(all, displacements.data(), share, {slots.data(), strides.data(), widest, size, data.data()});
    }
    demand(inside, "a block lies outside the matrix");
}

void turn(Reals<2> nodes, Reals<2> step, Array<const int32_t, 3> stencils, Array<const double, 4> gradients,
          Reals<2> volumes, int64_t terms, Array<double, 2> right) {
    Packed packed(nodes, stencils, gradients, volumes, terms);
    demand(step.shape(0) == nodes.shape(0) &&
               step.shape(1) == nodes.shape(1) && right.shape(0) == nodes.shape(0) &&
               right.shape(1) == nodes.shape(1), "shapes of nodes, step and right");
    Free free(25.0 * terms);
    kernels.turn(packed.all, nodes.data(), step.data(), right.data());
}

// Fronts as they come from Python.
Fronts plan(const Array<const int64_t, 2>& table, const Array<const int64_t, 1>& rows,
            const Array<const int64_t, 2>& runs, const Array<const int32_t, 2>& entries,
            const Array<const int64_t, 1>& diagonal) {
    demand(table.shape(0) > 0 && table.shape(1) == 11 && runs.shape(1) == 3 && entries.shape(1) == 2, "columns of the plan");
    return {(int64_t)table.shape(0) - 1, (int64_t)diagonal.shape(0), table.data(), rows.data(),
            runs.data(), entries.data(), diagonal.data()};
}

int64_t factorise(Array<const int64_t, 2> table, Array<const int64_t, 1> rows, Array<const int64_t, 2> runs,
                  Array<const int32_t, 2> entries, Array<const int64_t, 1> diagonal, Reals<1> data,
                  Array<double, 1> lower, Array<double, 1> signs, Array<double, 1> first, Array<double, 1> second,
                  Array<double, 1> spare, double tiny) {
    Fronts fronts = plan(table, rows, runs, entries, diagonal);
    demand((int64_t)signs.shape(0) == fronts.dofs, "as many signs as degrees of freedom");
    demand_fronts(fronts, {(int64_t)rows.shape(0), (int64_t)runs.shape(0), (int64_t)entries.shape(0), (int64_t)data.shape(0),
                           (int64_t)lower.shape(0), (int64_t)first.shape(0), (int64_t)second.shape(0), (int64_t)spare.shape(0)});
    Free free(0.3 * (double)lower.shape(0));
    return kernels.factorise(fronts, data.data(), lower.data(), signs.data(), first.data(), second.data(),
                             spare.data(), tiny);
}

// Which fronts threads take as whole subtrees, and which they do together: the largest subtree is cut up until each is
// a small share of all work.
struct Shares {
    std::vector<int64_t> begins, ends, tops;
    int64_t stacks[2] = {0, 0};

    Shares(const Fronts& fronts, int threads) {
        enum { COLUMNS, BELOW, CHILD = 5, SIBLING, STACK, OFFSET, WIDTH = 11 };
        const int64_t* table = fronts.table;
        std::vector<double> work(fronts.count);
        std::vector<int64_t> begin(fronts.count);
        std::vector<bool> under(fronts.count, false);
        double whole = 0.0;
        for (int64_t which = 0; which < fronts.count; which++) {
            double columns = (double)table[which * WIDTH + COLUMNS], below = (double)table[which * WIDTH + BELOW];
            work[which] = columns * (columns * columns / 3 + columns * below + below * below) + 1e3;
            whole += work[which];
            int64_t child = table[which * WIDTH + CHILD];
            begin[which] = child >= 0 ? begin[child] : which;
            for (; child >= 0; child = table[child * WIDTH + SIBLING]) work[which] += work[child], under[child] = true;
        }
        std::vector<std::pair<double, int64_t>> heap;
        for (int64_t which = 0; which < fronts.count; which++)
            if (!under[which]) heap.emplace_back(work[which], which);
        std::make_heap(heap.begin(), heap.end());
        while (!heap.empty() && heap.front().first > whole / (8 * threads) && heap.size() < 512) {
            int64_t which = heap.front().second;
            std::pop_heap(heap.begin(), heap.end());
            heap.pop_back();
            tops.push_back(which);
            for (int64_t child = table[which * WIDTH + CHILD]; child >= 0; child = table[child * WIDTH + SIBLING]) {
                heap.emplace_back(work[child], child);
                std::push_heap(heap.begin(), heap.end());
            }
        }
        std::sort(heap.rbegin(), heap.rend());
        std::sort(tops.begin(), tops.end());
        for (auto [_, which] : heap) {
            begins.push_back(begin[which]), ends.push_back(which);
            int64_t low[2] = {INT64_MAX, INT64_MAX}, high[2] = {0, 0};
            for (int64_t at = begin[which]; at < which; at++) {
                const int64_t* row = table + at * WIDTH;
                int64_t stack = row[STACK], end = row[OFFSET] + row[BELOW] * row[BELOW];
                if (row[OFFSET] < low[stack]) low[stack] = row[OFFSET];
                if (end > high[stack]) high[stack] = end;
            }
            for (int stack = 0; stack < 2; stack++)
                if (high[stack] > 0 && high[stack] - low[stack] > stacks[stack]) stacks[stack] = high[stack] - low[stack];
        }
    }
};

// Memory that factorisations by several threads use again: fresh pages cost about as much as what is done with them.
class Pool {
  public:
    double* claim(int64_t numbers) {
        {
            std::lock_guard<std::mutex> guard(lock);
            size_t best = idle.size();
            for (size_t at = 0; at < idle.size(); at++)
                if (size(idle[at]) >= numbers && size(idle[at]) <= 4 * numbers &&
                    (best == idle.size() || size(idle[at]) < size(idle[best])))
                    best = at;
            if (best < idle.size()) {
                double* found = idle[best];
                idle.erase(idle.begin() + (long)best);
                held -= size(found);
                return found;
            }
        }
        double* made = (double*)std::malloc((size_t)(numbers + HEAD) * sizeof(double));
        if (!made) return nullptr;
        *(int64_t*)made = numbers;
        return made + HEAD;
    }
    void release(double* numbers) {
        if (!numbers) return;
        std::lock_guard<std::mutex> guard(lock);
        if (held + size(numbers) > KEPT) return std::free(numbers - HEAD);
        idle.push_back(numbers);
        held += size(numbers);
    }

  private:
    static constexpr int64_t HEAD = 8;           // before the numbers stands how many there are
    static constexpr int64_t KEPT = 16'000'000;  // most numbers that lie idle (128 MB)
    static int64_t size(double* numbers) { return *(int64_t*)(numbers - HEAD); }
    std::mutex lock;
    std::vector<double*> idle;
    int64_t held = 0;
};

Pool pool;

double* claim(int64_t numbers) { return pool.claim(numbers); }
void release(double* numbers) { pool.release(numbers); }
void yield() { std::this_thread::yield(); }

// The same as `factorise` by several threads, to the same bytes.
int64_t factorise_together(Array<const int64_t, 2> table, Array<const int64_t, 1> rows, Array<const int64_t, 2> runs,
                           Array<const int32_t, 2> entries, Array<const int64_t, 1> diagonal, Reals<1> data,
                           Array<double, 1> lower, Array<double, 1> signs, int64_t widest, double tiny, int threads) {
    Fronts fronts = plan(table, rows, runs, entries, diagonal);
    demand(threads > 0 && (int64_t)signs.shape(0) == fronts.dofs, "threads, and as many signs as degrees of freedom");
    demand_fronts(fronts, {(int64_t)rows.shape(0), (int64_t)runs.shape(0), (int64_t)entries.shape(0), (int64_t)data.shape(0),
                           (int64_t)lower.shape(0), -1, -1, widest});
    nb::gil_scoped_release free;
    double largest = kernels.largest(fronts, data.data());
    if (!(largest < __builtin_inf())) return -1;
    Shares shares(fronts, threads);
    std::vector<double*> updates(fronts.count, nullptr);
    Team team{threads, (int64_t)shares.begins.size(), shares.begins.data(), shares.ends.data(),
              (int64_t)shares.tops.size(), shares.tops.data(), updates.data(), claim, release, yield,
              tiny * largest, {0, 0, 0, 0}, 0, 0, 0, 0, 0};
    auto work = [&](const Room& room) { kernels.join(fronts, team, room, data.data(), lower.data(), signs.data()); };
    std::vector<Room> rooms;
    bool enough = true;
    for (int me = 0; me < threads; me++) {
        rooms.push_back({me, claim(shares.stacks[0] + 8), claim(shares.stacks[1] + 8), claim(widest + 8), claim(PACKED)});
        const Room& room = rooms.back();
        enough = enough && room.first && room.second && room.spare && room.packed;
    }
    if (enough) {
        std::vector<std::thread> others;
        std::atomic<bool> go{false};
        auto wait = [&](const Room& room) {
            while (!go.load(std::memory_order_acquire)) std::this_thread::yield();
            work(room);
        };
        others.reserve(threads);
        try {
            for (int me = 1; me < threads; me++) others.emplace_back(wait, std::cref(rooms[me]));
        } catch (const std::system_error&) {
        }  // no more threads can be had: those that there are do it
        team.size = 1 + (int)others.size();
        go.store(true, std::memory_order_release);
        work(rooms[0]);
        for (std::thread& other : others) other.join();
    }
    for (double* update : updates) release(update);
    for (const Room& room : rooms)
        for (double* part : {room.first, room.second, room.spare, room.packed}) release(part);
    if (!enough || team.short_of_memory) throw std::bad_alloc();
    return team.failed ? -1 : team.negative;
}

// Solve for all or half of A = L S L^T: `way` 0 is A^-1, 1 is L^-1 (in the order of elimination), 2 is L^-T S.
// `place` is where each degree of freedom stands in the order of elimination.
void solve(Array<const int64_t, 2> table, Array<const int64_t, 1> rows, Array<const int64_t, 1> place,
           Reals<1> lower, Reals<1> signs, Reals<2> right, Array<double, 2> found, int way, int64_t height) {
    int64_t dofs = (int64_t)place.shape(0), sides = (int64_t)right.shape(1), count = (int64_t)table.shape(0) - 1;
    demand((int64_t)right.shape(0) == dofs && (int64_t)found.shape(0) == dofs && (int64_t)found.shape(1) == sides &&
               (int64_t)signs.shape(0) == dofs && count >= 0 && table.shape(1) == 11,
           "shapes of the right-hand sides");
    Fronts fronts{count, dofs, table.data(), rows.data(), nullptr, nullptr, nullptr};
    demand(height >= demand_panels(fronts, (int64_t)rows.shape(0), (int64_t)lower.shape(0)), "room for the highest front");
    const int64_t* at = demand_below(place, dofs, "a degree of freedom has no such place");
    const double* given = right.data();
    const double* sign = signs.data();
    double* out = found.data();
    Free free(0.2 * (double)lower.shape(0) * (double)(sides + 1));
    static thread_local std::vector<double> values, work;
    for (int64_t low = 0; low < sides; low += 16) {
        const int some = (int)(sides - low < 16 ? sides - low : 16), step = some <= 4 ? 4 : kernels.lanes == 8 ? 8 : 4;
        const int width = some == 1 ? 1 : (some + step - 1) / step * step;
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
    kernels = choose_kernels();
    nb::list names;
    for (const Kernels* found : levels()) names.append(found->name);
    module.attr("levels") = names;
    module.attr("instructions") = kernels.name;
    module.attr("interface") = 9;  // kernel.py asks for it: raise both where the arguments of a function change
    module.def("value", &value);
    module.def("gradient", &gradient, given(), given(), given(), given(), given(), given(), given(), filled());
    module.def("hessian", &hessian, given(), given(), given(), given(), given(), given(), given(), given(), given(), given(), filled());
    module.def("quadratic_value", &quadratic_value, given(), given(), given(), given(), given(), given(), given(), given());
    module.def("quadratic_least", &quadratic_least, given(), given(), given(), given(), given(), given(), given(), given());
    module.def("quadratic_gradient", &quadratic_gradient, given(), given(), given(), given(), given(), given(), given(), given(), filled());
    module.def("quadratic_hessian", &quadratic_hessian, given(), given(), given(), given(), given(), given(), given(), given(), given(),
               given(), given(), filled());
    module.def("turn", &turn, given(), given(), given(), given(), given(), given(), filled());
    module.def("factorise", &factorise, given(), given(), given(), given(), given(), given(), filled(), filled(), filled(), filled(), filled(), given());
    module.def("factorise_together", &factorise_together, given(), given(), given(), given(), given(), given(), filled(), filled(),
               given(), given(), given());
    module.def("solve", &solve, given(), given(), given(), given(), given(), given(), filled(), given(), given());
    add_ordering(module);
    add_sketches(module);
    add_symbolic(module);
    add_cables(module);
    add_improve(module);
    add_contact(module);
    add_pictures(module);
    add_release(module);
    add_limits(module);
    add_paths(module);
    add_perceptrons(module);
    add_chains(module);
    add_complement(module);
    add_patches(module);
}
