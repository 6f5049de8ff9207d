"""MuJoCo's flex elasticity with its implicit integrator ("discrete"), at great time steps: a way to statics.

Variants: "svk", its St. Venant-Kirchhoff material, and "snh", its experimental stable Neo-Hookean one; after each step
all speeds are set to 0, so that a step is one of a damped Newton method.
"""

import warnings
from collections.abc import Iterator

import mujoco
import numpy as np
from held_body import Answers, HeldBody, at_rest, main

TIME_STEP = 0.1
"""[s]; with 0.3 the stable Neo-Hookean hand under five times its weight flew apart. MuJoCo warns that linear solves end
early in the first steps; with 400 iterations for each instead of its 100 the tail flew apart at 0.1, too."""


def flex(body: HeldBody, *, stable: bool) -> mujoco.MjModel:
    """The body as a flex without contact; its weight comes as forces on the nodes."""

    def text(values: np.ndarray) -> str:
        return " ".join(repr(value) for value in values.ravel().tolist())

    spec = mujoco.MjSpec.from_string(
        f"""<mujoco>
        <option integrator="discrete" solver="Newton" timestep="{TIME_STEP}" gravity="0 0 0"/>
        <worldbody><flexcomp name="body" type="direct" dim="3" radius="1e-4" mass="{body.masses.sum()}"
            point="{text(body.nodes)}" element="{text(body.elements)}">
            <pin id="{text(np.flatnonzero(body.held))}"/>
            <elasticity young="{body.young}" poisson="{body.poisson}"/>
            <contact contype="0" conaffinity="0" selfcollide="none"/>
        </flexcomp></worldbody></mujoco>"""
    )
    for each in spec.flexes:
        each.elastic3d = int(stable)
    return spec.compile()


def prepare(body: HeldBody, variant: str) -> Answers:
    """Steps in time until five of them move nothing."""
    warnings.simplefilter("ignore")  # that no constraint holds the flex together: its elasticity does
    model = flex(body, stable=variant == "snh")
    free = np.flatnonzero(~body.held)
    places = model.body_dofadr[model.flex_vertbodyid[free]][:, None] + np.arange(3)

    def begin() -> Iterator[np.ndarray]:
        data = mujoco.MjData(model)
        data.qfrc_applied[places] = body.forces[free]
        nodes = before = body.nodes
        for step in range(1, 100_000):
            mujoco.mj_step(model, data)
            data.qvel[:] = 0
            nodes = body.nodes.copy()
            nodes[free] += data.qpos[places]
            yield nodes
            if step % 5 == 0:
                if at_rest(body, before, nodes, 1e-10):
                    return
                before = nodes

    return begin


if __name__ == "__main__":
    main(prepare)
