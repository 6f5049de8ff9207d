"""`MjcfStatics`: equilibria of a MuJoCo model, found from those of hydrostat; it needs MuJoCo."""

from typing import Any

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.export.mjcf import TIE_STIFFNESS, MjcfModel
from hydrostat.export.mjcf_tuning import MjcfTuning
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation

REST_TOLERANCE = 3e-6  # last step of a search that ends [m]
SEARCH_LIMITS = ((1.0, 60), (0.4, 400))  # share of each step and most steps, of a search and of the next if it fails


class MjcfStatics:
    """Equilibria of a MuJoCo model without motion in time.

    MuJoCo computes the forces on all bodies; the factorized Hessian of hydrostat's pose turns them into displacements,
    until nothing moves. That takes about a hundredth of the time in which a model settles.
    """

    def __init__(self, robot: Robot, simulation: Simulation, tuning: MjcfTuning | None = None) -> None:
        import mujoco  # type: ignore[import-not-found]

        self._engine: Any = mujoco
        self._robot, self._rest = robot, robot.body.mesh.nodes
        parts = MjcfModel(robot, tuning, simulation)
        model = self._model = mujoco.MjModel.from_xml_string("\n".join(parts.lines((), 1.0)))
        self._data = mujoco.MjData(model)
        ties = [tie for tie in parts.ties if tie.is_free]
        self._held, self._free = parts.held, np.flatnonzero(~parts.held)
        self._node_dofs = self._dofs([f"node_{node}" for node in self._free])
        self._tie_dofs = self._dofs([f"tie {tie.name}" for tie in ties])
        self._weights = np.zeros((len(ties), len(self._rest)))
        for row, tie in zip(self._weights, ties, strict=True):
            np.add.at(row, tie.nodes, tie.weights)
        self._tie_stiffness = TIE_STIFFNESS * max((cable.stiffness for cable in robot.cables), default=4e3)
        order = {winch.name: index for index, winch in enumerate(robot.winches)}
        self._winches = [order[cable.winch] for cable in robot.cables]
        names = [f"marker {marker.name}" for marker in robot.markers]
        self._sites = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name) for name in names]

    def find_markers(self, pose: Equilibrium, contractions: Vector, begin: Nodes) -> tuple[Points, Nodes] | None:
        """Positions of the markers and of the nodes [m] at rest, searched from some nodes; None if none is found."""
        stiffness = pose.result.stiffness
        assert stiffness is not None
        max_pull = REST_TOLERANCE * self._tie_stiffness
        for share, most in SEARCH_LIMITS:
            nodes, ties = begin.copy(), np.zeros(self._tie_dofs.shape)
            nodes[self._held] = self._rest[self._held]
            for _ in range(most):
                forces, pulls = self._forces(nodes - self._rest, ties, contractions)
                step = share * stiffness.solve(forces.reshape(-1, 1)).reshape(forces.shape)
                step[self._held] = 0.0
                largest = np.abs(step).max()
                if not largest < np.ptp(self._rest, axis=0).max():
                    break
                nodes, ties = nodes + step, ties + 0.5 * pulls / self._tie_stiffness
                if largest < share * REST_TOLERANCE and np.abs(pulls).max(initial=0.0) < max_pull:
                    return (self._markers(), nodes) if self._is_upright(nodes) else None
        return None

    def _dofs(self, names: list[str]) -> np.ndarray:
        """Index of each degree of freedom of some bodies, (bodies, dim)."""
        mujoco, model = self._engine, self._model
        numbers = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) for name in names]
        return model.body_dofadr[numbers][:, None] + np.arange(self._rest.shape[1])

    def _forces(self, moves: Nodes, ties: Points, contractions: Vector) -> tuple[Nodes, Points]:
        """Forces on nodes, with those that ties pass on, and forces on ties [N]."""
        mujoco, model, data = self._engine, self._model, self._data
        data.qpos[self._node_dofs] = moves[self._free]
        data.qpos[self._tie_dofs] = self._weights @ moves + ties
        data.ctrl[:] = contractions[self._winches]
        for compute in (mujoco.mj_fwdPosition, mujoco.mj_fwdVelocity, mujoco.mj_fwdActuation):
            compute(model, data)
        found = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
        pulls, forces = found[self._tie_dofs], np.zeros_like(moves)
        forces[self._free] = found[self._node_dofs]
        forces += self._weights.T @ pulls
        forces[self._held] = 0.0
        return forces, pulls

    def _markers(self) -> Points:
        self._engine.mj_kinematics(self._model, self._data)
        return self._data.site_xpos[self._sites][:, : self._rest.shape[1]].copy()

    def _is_upright(self, nodes: Nodes) -> bool:
        """Return True if no element is inverted."""
        corners = nodes[self._robot.body.mesh.elements]
        return bool((np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all())
