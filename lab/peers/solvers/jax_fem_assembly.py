"""Newton's method on what jax-fem assembles: residual and Hessian by automatic differentiation of the stress.

Its own solver needs petsc4py, which has no wheel; so its matrices are solved by SciPy's sparse direct solver.
"""

from collections.abc import Callable, Iterator

import jax
import jax.numpy as jnp
import numpy as np
from held_body import Answers, HeldBody, main
from jax_fem.generate_mesh import Mesh
from jax_fem.problem import Problem
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

jax.config.update("jax_enable_x64", True)


class NeoHookean(Problem):
    """The material as users of jax-fem give one: its stress as a function of the displacement gradient."""

    def custom_init(self, mu: float, lame: float) -> None:
        """Lame's parameters [Pa], which jax-fem hands on from `additional_info`."""
        self.mu, self.lame = mu, lame

    def get_tensor_map(self) -> Callable[[jnp.ndarray], jnp.ndarray]:
        """Stress by the displacement gradient."""
        mu, lame = self.mu, self.lame

        def stress(gradient: jnp.ndarray) -> jnp.ndarray:
            F = gradient + jnp.eye(3)
            turned = jnp.linalg.inv(F).T
            return mu * (F - turned) + lame * jnp.log(jnp.linalg.det(F)) * turned

        return stress


def prepare(body: HeldBody, _variant: str) -> Answers:
    """Full steps, halved while an element is inverted or the forces left over grow."""
    mesh = Mesh(body.nodes, body.elements, ele_type="TET4")
    problem = NeoHookean(mesh, vec=3, dim=3, ele_type="TET4", additional_info=(body.mu, body.lame))
    free = np.flatnonzero(np.repeat(~body.held, 3))
    loads = body.forces.ravel()
    size = body.nodes.size

    def left_over(u: np.ndarray) -> np.ndarray:
        (forces,) = problem.compute_residual([jnp.array(u.reshape(-1, 3))])
        return np.asarray(forces).ravel() - loads

    def hessian(u: np.ndarray) -> tuple[np.ndarray, csc_array]:
        (forces,) = problem.newton_update([jnp.array(u.reshape(-1, 3))])
        matrix = csc_array((np.asarray(problem.V), (problem.I, problem.J)), (size, size))
        return np.asarray(forces).ravel() - loads, matrix[free][:, free].tocsc()

    def begin() -> Iterator[np.ndarray]:
        u = np.zeros(size)
        for _ in range(100):
            residual, matrix = hessian(u)
            step, share = np.zeros(size), 1.0
            step[free] = splu(matrix).solve(-residual[free])
            trial = left_over(u + step)
            while not np.abs(trial[free]).max() < 10 * np.abs(residual[free]).max() and share > 1e-4:
                share /= 2
                trial = left_over(u + share * step)
            u = u + share * step
            yield body.nodes + u.reshape(-1, 3)
            if np.abs(trial[free]).max() < 1e-10 * np.abs(loads).max():
                return

    return begin


if __name__ == "__main__":
    main(prepare)
