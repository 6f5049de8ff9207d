"""`SamplePlan`: which poses of a robot are sampled; the contractions of a sample follow from its number alone."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from math import ceil, isfinite

import numpy as np

from hydrostat.arrays import Float, Int, Vector
from hydrostat.errors import InputError
from hydrostat.learning.known_contact import contact_facts
from hydrostat.robot import Contact, PinDrive, Robot, robot_hash
from hydrostat.simulation import Simulation
from hydrostat.sobol import draw_sobol

Rows = Float[np.ndarray, "samples winches"]
Points = Float[np.ndarray, "samples dimensions"]
Winches = Sequence[Sequence[int]]


class SamplingScheme(StrEnum):
    """Distribution of the contractions."""

    BOX = "box"  # each winch between its release and its travel
    ANTAGONIST = "antagonist"  # of two winches that work against one another only one takes in (thesis 5.3.2)
    FACES = "faces"  # as box, but each winch is left at 0 in half of the samples
    TENSION = "tension"  # as box, let out until no cable pulls harder than allowed

    def contractions(self, points: Points, low: Vector, high: Vector, pairs: Winches) -> Rows:
        """Return the contractions [m] for points in the unit cube.

        Args:
            points: points in the unit cube (samples, dimensions).
            low: least contraction of each winch [m].
            high: largest contraction of each winch [m].
            pairs: winch indices of each antagonistic pair; a winch without a partner stands alone.
        """
        if self is SamplingScheme.ANTAGONIST:
            return _against(points, high, pairs)
        box = low + points[:, : len(low)] * (high - low)
        return np.where(points[:, len(low) :] < 0.5, box, 0.0) if self is SamplingScheme.FACES else box


def dimensions(draw: SamplingScheme, pairs: Winches, winches: int) -> int:
    """Return the number of random numbers that a sample needs."""
    return {SamplingScheme.ANTAGONIST: len(pairs), SamplingScheme.FACES: 2 * winches}.get(draw, winches)


def shared_numbers(rows: Rows, high: Vector, pairs: Winches) -> Points:
    """Return the unit-cube points (samples, pairs) that `SamplingScheme.ANTAGONIST` maps to these contractions."""
    shares = rows / np.where(high > 0, high, 1.0)
    columns = [
        shares[:, one] if not other else 0.5 + 0.5 * (shares[:, one] - shares[:, other[0]]) for one, *other in pairs
    ]
    return np.stack(columns, axis=1)


def antagonists(moves: Float[np.ndarray, "winches coordinates"]) -> tuple[tuple[int, ...], ...]:
    """Return antagonistic pairs, whose markers move in opposite directions, then the single winches.

    Each winch of a pair is the best partner of the other.

    Args:
        moves: displacements of the markers for the contraction of each winch, one row each [m].
    """
    lengths = np.linalg.norm(moves, axis=1, keepdims=True)
    ways = moves / np.where(lengths > 0, lengths, 1.0)
    cosines = ways @ ways.T
    np.fill_diagonal(cosines, 1.0)
    partner: Int[np.ndarray, " winches"] = np.argmin(cosines, axis=1)
    groups: list[tuple[int, ...]] = []
    opposite = -0.3  # Cosine of the ways of markers below which two winches work against one another
    for winch, other in enumerate(partner):
        paired = partner[other] == winch and cosines[winch, other] < opposite
        if not paired:
            groups.append((winch,))
        elif winch < other:
            groups.append((winch, int(other)))
    return tuple(groups)


def _against(points: Points, high: Vector, pairs: Winches) -> Rows:
    """Contractions of which only one of each pair is above 0: the first above the middle, the second below it."""
    rows = np.zeros((len(points), len(high)))
    for column, winches in enumerate(pairs):
        value = points[:, column]
        if len(winches) == 1:
            rows[:, winches[0]] = value * high[winches[0]]
            continue
        one, other = winches
        rows[:, one] = np.maximum(2 * value - 1, 0) * high[one]
        rows[:, other] = np.maximum(1 - 2 * value, 0) * high[other]
    return rows


@dataclass(frozen=True, kw_only=True, eq=False)
class SamplePlan:
    """Plan for sampling a robot. Equal plans give equal bytes, on any number of workers.

    Attributes:
        robot: robot to sample; with contact if the samples include it.
        count: number of samples.
        seed: random seed.
        draws: sampling schemes, which take turns from sample to sample.
        shard: number of samples in one file.
        nodes: True to keep the positions of all nodes.
        tension: maximum cable tension [N]; for `SamplingScheme.TENSION`.
        pairs: winch indices of antagonistic pairs and of single winches; for `SamplingScheme.ANTAGONIST`.

    Raises:
        InputError: a count below 1, no sampling scheme, or a scheme without its limit.
    """

    robot: Robot
    count: int
    seed: int = 0
    draws: Sequence[SamplingScheme] = (SamplingScheme.BOX,)
    shard: int = 64
    nodes: bool = False
    tension: float | None = None
    pairs: tuple[tuple[int, ...], ...] = field(default=())

    def __post_init__(self) -> None:
        for name in ("count", "shard"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} must be 1 or more, not {getattr(self, name)}")
        if self.seed < 0:
            raise InputError(f"seed must be 0 or more, not {self.seed}")
        if not self.draws:
            raise InputError(f"no sampling strategy. Available: {', '.join(SamplingScheme)}.")
        if SamplingScheme.ANTAGONIST in self.draws:
            PinDrive.require_none(self.robot.drives, "strategy antagonist")
        if not self.robot.num_controls or not self.robot.markers:
            raise InputError(f"robot {self.robot.name!r} needs at least one winch or drive, and one marker")
        limited = self.tension is not None and isfinite(self.tension) and self.tension > 0
        if SamplingScheme.TENSION in self.draws and not limited:
            raise InputError("strategy tension needs a maximum cable tension, e.g. 10 N")

    @property
    def shards(self) -> int:
        """Number of files."""
        return ceil(self.count / self.shard)

    def numbers(self, shard: int) -> range:
        """Return the indices of the samples in a file."""
        return range(shard * self.shard, min((shard + 1) * self.shard, self.count))

    def draw_of(self, number: int) -> SamplingScheme:
        """Return the sampling scheme of a sample."""
        return self.draws[number % len(self.draws)]

    def contractions(self, numbers: range) -> Rows:
        """Return contractions in winch order [m], then drive values, before the tension limit shortens any."""
        rows = np.zeros((len(numbers), self.robot.num_controls))
        low, high = self.robot.control_limits
        for place, draw in enumerate(self.draws):
            mine = [number for number in numbers if number % len(self.draws) == place]
            if mine:
                points = self._points(place, mine[0] // len(self.draws), len(mine))
                rows[np.array(mine) - numbers.start] = draw.contractions(points, low, high, self.pairs)
        return rows

    def _points(self, place: int, first: int, count: int) -> Float[np.ndarray, "samples dims"]:
        """Return scrambled Sobol points of one of the sampling schemes."""
        size = dimensions(self.draws[place], self.pairs, self.robot.num_controls)
        random = np.random.Generator(np.random.PCG64(np.random.SeedSequence([self.seed, place])))
        return draw_sobol(size, count, random, first=first)

    def facts(self) -> dict[str, object]:
        """Return the metadata that determines every byte, for the manifest."""
        robot, controls = self.robot, (*self.robot.winches, *self.robot.drives)
        low, high = robot.control_limits
        return {
            "robot": robot.name,
            "physics": physics_hash(robot),
            **contact_facts(robot)._asdict(),
            "count": self.count,
            "seed": self.seed,
            "draws": [str(draw) for draw in self.draws],
            "shard": self.shard,
            "tension_slopes": True,
            "nodes": self.nodes,
            "tension": self.tension,
            "pairs": [[robot.winches[winch].name for winch in pair] for pair in self.pairs],
            "winches": [control.name for control in controls],
            "drives": {drive.name: drive.unit for drive in robot.drives},
            "release": (-low).tolist(),
            "travel": high.tolist(),
            "markers": [marker.name for marker in robot.markers],
            "cables": [cable.name for cable in robot.cables],
            "sensors": [head for sensor in robot.sensors for head in sensor.heads(robot.body.mesh.dim)],
            "noise": [sensor.noise for sensor in robot.sensors],
            "dim": robot.body.mesh.dim,
            "node_count": len(robot.body.mesh.nodes),
            "size": robot.body.mesh.size,
        }

    @staticmethod
    def of_robot(
        robot: Robot,
        count: int,
        *,
        contact: bool = False,
        seed: int = 0,
        draws: Sequence[SamplingScheme] = (SamplingScheme.BOX,),
        shard: int = 64,
        nodes: bool = False,
        tension: float | None = None,
    ) -> "SamplePlan":
        """Plan samples of a robot; finds the antagonistic pairs from one pose for each winch.

        Args:
            robot: robot to sample.
            count: number of samples.
            contact: True to add self-contact even if the robot has none.
            seed: random seed.
            draws: sampling schemes, which take turns from sample to sample.
            shard: number of samples in one file.
            nodes: True to keep the positions of all nodes.
            tension: maximum cable tension [N]; for `SamplingScheme.TENSION`.

        Raises:
            InputError: as for `SamplePlan`.
        """
        if contact and robot.contact is None:
            robot = replace(robot, contact=Contact())
        plan = SamplePlan(
            robot=robot, count=count, seed=seed, draws=tuple(draws), shard=shard, nodes=nodes, tension=tension
        )
        if SamplingScheme.ANTAGONIST not in plan.draws:
            return plan
        simulation, winches = Simulation(robot), len(robot.winches)
        travel = np.array([winch.travel for winch in robot.winches])
        little = 0.2  # Share of its travel by which each winch shows where it moves the markers
        rows = np.vstack([np.zeros(winches), little * np.diag(travel)])
        markers = simulation.solve_batch(rows, jacobians=False, threads=1).markers.reshape(winches + 1, -1)
        return replace(plan, pairs=antagonists(np.nan_to_num(markers[1:] - markers[0])))


def physics_hash(robot: Robot) -> str:
    """Return the SHA-256 hash of all data that determine poses, except contact, name and target poses."""
    bare = replace(robot, name="robot", poses={}, contact=None, sensors=())
    made = b"" if robot.body.content else robot.body.mesh.nodes.tobytes() + robot.body.mesh.elements.tobytes()
    sized = [pin.stiffness for pin in robot.pins if pin.is_sized]  # in no robot.toml
    return hashlib.sha256(robot_hash(bare).encode() + made + np.array(sized).tobytes()).hexdigest()
