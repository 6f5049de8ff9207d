"""Newton's soft bodies, on the CPU by Warp, in single precision, run to rest.

Variants: "vbd", vertex block descent; "semi", semi-implicit Euler with explicit elastic forces. So that they come to
rest soon, all speeds are set to 0 whenever the kinetic energy falls (kinetic damping). With few sweeps of vertex block
descent in a long time step the body sags too far, whatever the number of steps: the time step sets the error that is
left.
"""

from collections.abc import Iterator

import newton
import numpy as np
import warp as wp
from held_body import Answers, HeldBody, at_rest, main

TIME_STEPS = {"vbd": 1e-4, "semi": 5e-5}
"""[s]; semi-implicit Euler flies apart at twice that on the hand."""

SWEEPS = 2
"""Of vertex block descent in each time step."""

BETWEEN = 100
"""Time steps from one answer to the next."""


def built(body: HeldBody, mu: float, lame: float) -> newton.Model:
    """The body, its held nodes without mass and not active, as Newton's own examples hold some."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    builder.add_soft_mesh(
        pos=wp.vec3(0, 0, 0), rot=wp.quat_identity(), scale=1.0, vel=wp.vec3(0, 0, 0),
        vertices=[wp.vec3(*node) for node in body.nodes], indices=body.elements.ravel().tolist(),
        density=1.0, k_mu=mu, k_lambda=lame, k_damp=0.0, particle_radius=1e-4,
    )  # fmt: skip
    for node in range(len(body.nodes)):
        builder.particle_mass[node] = 0.0 if body.held[node] else float(body.masses[node])
        if body.held[node]:
            builder.particle_flags[node] = 0
    builder.color()
    model = builder.finalize(device="cpu")
    model.particle_grid = None  # contact of nodes, and of nodes with triangles below, would take most of the time
    return model


def prepare(body: HeldBody, variant: str) -> Answers:
    """Steps in time until 1,000 of them move nothing."""
    wp.config.quiet = True
    if variant == "vbd":
        model = built(body, body.mu, body.lame)
        solver = newton.solvers.SolverVBD(
            model, iterations=SWEEPS, particle_enable_self_contact=False, particle_enable_tile_solve=False
        )
    else:  # its parameters are those of Smith et al. 2018, not Lame's
        model = built(body, 4 / 3 * body.mu, body.lame + 5 / 6 * body.mu)
        solver = newton.solvers.SolverSemiImplicit(model, enable_tri_contact=False)
    forces = wp.array(body.forces.astype(np.float32), dtype=wp.vec3, device="cpu")
    masses = body.masses[:, None]

    def begin() -> Iterator[np.ndarray]:
        state, after, control = model.state(), model.state(), model.control()
        last, before = 0.0, body.nodes
        for step in range(1, 1_000_000):
            state.particle_f.assign(forces)
            solver.step(state, after, control, None, TIME_STEPS[variant])
            state, after = after, state
            kinetic = float((masses * state.particle_qd.numpy() ** 2).sum())
            if kinetic < last:
                state.particle_qd.zero_()
                kinetic = 0.0
            last = kinetic
            if step % BETWEEN == 0:
                nodes = state.particle_q.numpy().astype(float)
                yield nodes
                if step % 1000 == 0:
                    if at_rest(body, before, nodes, 1e-4):
                        return
                    before = nodes

    return begin


if __name__ == "__main__":
    main(prepare)
