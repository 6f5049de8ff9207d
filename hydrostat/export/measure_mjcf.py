"""`measure_mjcf`: error of the MuJoCo model of a robot against hydrostat; it needs MuJoCo."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import InputError
from hydrostat.export.mjcf import mjcf_text
from hydrostat.export.mjcf_tuning import MjcfTuning
from hydrostat.progress import Progress
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.sobol import draw_sobol
from hydrostat.units import plural
from hydrostat.version import install_command

SHARES = (1.0, 0.5, 0.25, 0.125)  # shares of the travel that are measured, until all poses settle
RAMP, MAX_STEPS = 300, 3000  # steps in which controls grow to their values, and after which a pose has not settled
REST_TOLERANCE, REST_STEPS = 2e-7, 50  # largest movement in one step [m] at rest, and number of such steps in a row


@dataclass(frozen=True, kw_only=True)
class MjcfError:
    """Error of a MuJoCo model in poses of random contractions.

    Attributes:
        share: largest share of the travel at which all poses settled; None: none did at an eighth of it.
        num_poses: number of poses.
        error: root mean square of the distances of the markers from those of hydrostat [m].
        largest: largest of these distances [m].
        travel: root mean square of the distances of the markers from rest [m].
    """

    share: float | None
    num_poses: int
    error: float = 0.0
    largest: float = 0.0
    travel: float = 0.0

    @property
    def range_share(self) -> float:
        """Share of the travel that controls should allow: the smallest that was tried if no pose settled."""
        return SHARES[-1] if self.share is None else self.share

    def describe(self) -> str:
        """Sentence with the figures, or a warning where no pose settled."""
        if self.share is None:
            return f"warning: did not settle at {100 * SHARES[-1]:g} % of the travel. Do not use this model"
        return (
            f"markers off by {1e3 * self.error:.2g} mm rms, {1e3 * self.largest:.2g} mm at most, of "
            f"{1e3 * self.travel:.2g} mm rms, in {plural(self.num_poses, 'pose')} of random contractions up to "
            f"{100 * self.share:g} % of the travel, the range of its controls"
        )


def measure_mjcf(
    robot: Robot,
    num_poses: int = 5,
    *,
    tuning: MjcfTuning | None = None,
    shares: Sequence[float] = SHARES,
    progress: Progress | None = None,
) -> MjcfError:
    """Measure the marker error of a robot's MuJoCo model in poses of random contractions, settled in time.

    Contractions are scrambled Sobol points up to a share of the travel of each winch. If an element inverts or a
    pose does not settle, the next smaller share is measured.

    Args:
        robot: robot with markers and winches.
        num_poses: number of poses.
        tuning: parameters that differ from the robot's, found by `fit_mjcf`.
        shares: shares of the travel, in the order of the attempts.
        progress: callback with the number of measured poses.

    Raises:
        InputError: MuJoCo is not installed, no poses, a robot without markers, or a robot that `mjcf_text` rejects.
    """
    if find_spec("mujoco") is None:
        raise InputError(f"MuJoCo is not installed: {install_command('export')}")
    if num_poses < 1:
        raise InputError(f"num_poses must be 1 or more, not {num_poses}")
    if not robot.markers or not robot.winches:
        raise InputError("measuring a model needs a [[marker]] and a [[winch]]. Add them.")
    settled = SettledModel(robot, tuning)
    travels = np.array([winch.travel for winch in robot.winches])
    draws = draw_sobol(len(travels), num_poses, np.random.default_rng(0)) * travels
    rest = settled.simulation.marker_anchors.positions(robot.body.mesh.nodes)
    for share in shares:
        pairs = []
        for number, contractions in enumerate(share * draws):
            pose = settled.simulation.solve(contractions, strict=False)
            places = settled.find_markers(contractions) if pose.result.converged else None
            if places is None:
                break
            pairs.append((places, settled.simulation.marker_anchors.positions(pose.nodes)))
            if progress is not None:
                progress(f"measuring {100 * share:g} % of the travel", number + 1, num_poses)
        if len(pairs) == num_poses:
            there, wanted = np.array(pairs).transpose(1, 0, 2, 3)
            error, moved = np.linalg.norm(there - wanted, axis=2), np.linalg.norm(wanted - rest, axis=2)
            given = {"error": _rms(error), "largest": float(error.max()), "travel": _rms(moved)}
            return MjcfError(share=share, num_poses=num_poses, **given)
    return MjcfError(share=None, num_poses=num_poses)


def _rms(values: Points) -> float:
    return float(np.sqrt(np.mean(values**2)))


class SettledModel:
    """Poses of a MuJoCo model at rest."""

    def __init__(self, robot: Robot, tuning: MjcfTuning | None) -> None:
        import mujoco  # type: ignore[import-not-found]

        self._engine: Any = mujoco
        self.simulation = Simulation(robot)
        self._robot, self._model = robot, mujoco.MjModel.from_xml_string(mjcf_text(robot, tuning=tuning))
        order = {winch.name: index for index, winch in enumerate(robot.winches)}
        self._winches = [order[cable.winch] for cable in robot.cables]
        names = [f"node_{node}" for node in range(len(robot.body.mesh.nodes))]
        numbers = np.array([mujoco.mj_name2id(self._model, mujoco.mjtObj.mjOBJ_BODY, name) for name in names])
        self._free, self._bodies = numbers >= 0, numbers[numbers >= 0]

    def find_markers(self, contractions: Vector) -> Points | None:
        """Positions of the markers [m] once the model stands still; None if it does not, or an element inverts."""
        mujoco, model, robot = self._engine, self._model, self._robot
        data = mujoco.MjData(model)
        with _without_warnings(mujoco):
            is_still = self._settle(data, contractions)
        if not is_still:
            return None
        mujoco.mj_kinematics(model, data)
        nodes = robot.body.mesh.nodes.copy()
        nodes[self._free] = data.xpos[self._bodies, : nodes.shape[1]]
        corners = nodes[robot.body.mesh.elements]
        if (np.linalg.det(corners[:, 1:] - corners[:, :1]) <= 0).any():
            return None
        sites = [data.site(f"marker {marker.name}").xpos[: nodes.shape[1]] for marker in robot.markers]
        return np.array(sites)

    def _settle(self, data: Any, contractions: Vector) -> bool:
        """Step until nothing moves; return False if that does not happen."""
        mujoco, model, num_still = self._engine, self._model, 0
        for step in range(MAX_STEPS):
            data.ctrl[:] = min(1.0, (step + 1) / RAMP) * contractions[self._winches]
            mujoco.mj_step(model, data)
            if not np.isfinite(data.qvel).all() or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
                return False
            is_slow = step >= RAMP and np.abs(data.qvel).max() * model.opt.timestep < REST_TOLERANCE
            num_still = num_still + 1 if is_slow else 0  # an oscillation is slow where it turns
            if num_still == REST_STEPS:
                return True
        return False


@contextmanager
def _without_warnings(mujoco: Any) -> Iterator[None]:
    """Keep MuJoCo from printing warnings: poses that do not settle are found by their motion."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
