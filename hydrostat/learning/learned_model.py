"""`LearnedModel`: networks that predict the markers of a robot and solve its inverse kinematics; its file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from math import dist, hypot
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.ik import IKStatus, Targets, named_targets
from hydrostat.learning.known_contact import check_contact
from hydrostat.learning.model_card import ModelCard
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.learning.portable_file import PortableFile
from hydrostat.learning.sample_plan import physics_hash
from hydrostat.mechanics import NewtonStatus
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Equilibrium
from hydrostat.units import quote


class Tier(StrEnum):
    """Source of an answer; each is better, and takes longer, than the one before."""

    NETWORK = "the inverse network"
    SEARCH = "search on the networks"
    STEP = "exact steps"
    EXACT = "inverse kinematics"


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedPose:
    """Contractions that bring markers near targets: what networks say of them, and what the simulator says.

    Attributes:
        target: requested target.
        tier: source of the answer.
        contractions: cable taken in [m], in the order of the model's winches.
        commands: the same by winch.
        markers: predicted position of each marker [m].
        tensions: predicted tension of each cable [N].
        errors: predicted distance of each requested marker from its target [m].
        spread: disagreement of the networks, root of the mean square [m]: their uncertainty.
        certified: distance of each from its target in the simulator [m]; None without a check.
        status: reason why the simulator ended: of an equilibrium, or, for `Tier.EXACT`, of inverse kinematics.
        pose: the equilibrium; None where there is none.
    """

    target: PoseTarget
    tier: Tier
    contractions: Vector
    commands: Mapping[str, float]
    markers: Mapping[str, np.ndarray]
    tensions: Mapping[str, float]
    errors: Mapping[str, float]
    spread: Mapping[str, float]
    certified: Mapping[str, float] | None = None
    status: NewtonStatus | IKStatus | None = None
    pose: Equilibrium | None = None

    def __repr__(self) -> str:
        """Return a description of one line."""
        sort = "expected" if self.certified is None else "certified"
        return f"<LearnedPose for {self.target.name!r} by {self.tier}: {1e3 * self.error:.3g} mm {sort} on average>"

    @property
    def error(self) -> float:
        """Mean distance of the markers from their targets [m]: certified where it is, else expected."""
        return float(np.mean(list((self.errors if self.certified is None else self.certified).values())))

    @property
    def uncertainty(self) -> float:
        """Mean spread of the markers that were asked for [m]."""
        return float(np.mean(list(self.spread.values())))

    def without_factors(self) -> "LearnedPose":
        """The same with a pose that keeps no factorized Hessian, to be kept with many others."""
        return replace(self, pose=None if self.pose is None else self.pose.without_factors())


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedModel:
    """Networks of one robot; `solve` needs neither the simulator nor PyTorch.

    The networks use normalized values: contractions from -1 to 1 over the travel of each winch, and outputs (markers,
    then tensions) minus their mean, divided by one scale for each quantity.

    Attributes:
        card: robot, samples, training and accuracy.
        low: least contraction of each winch [m].
        high: largest contraction of each winch [m].
        middle: mean of each output: marker coordinates [m], then tensions [N].
        unit: scale of each output, in the same units.
        forward: networks from contractions to outputs, trained separately; their spread estimates the uncertainty.
        inverse: network from markers to contractions; None if training was interrupted before it.
        known: contractions of the samples that a search can start from [m].
        reached: marker positions of these samples [m], one row for each.
    """

    card: ModelCard
    low: Vector
    high: Vector
    middle: Vector
    unit: Vector
    forward: Perceptrons
    inverse: Perceptrons | None
    known: Float[np.ndarray, "samples winches"]
    reached: Float[np.ndarray, "samples coordinates"]

    def __repr__(self) -> str:
        """Return a description of one line."""
        known = f"{len(self.card.winches)} winches, {len(self.card.markers)} markers"
        return f"<LearnedModel of {self.card.robot!r}: {known}, {1e3 * self.card.error:.3g} mm on average>"

    def check(self, robot: Robot) -> None:
        """Check that the model was trained for a robot.

        Raises:
            InputError: the model was trained for another robot, or with another contact setting.
        """
        if self.card.physics != physics_hash(robot):
            raise InputError(
                f"the model was learned of another robot than {robot.name!r} ({self.card.robot!r}, or what it was "
                f"before it was changed): sample and learn again"
            )
        check_contact(self.card.known_contact, robot)

    def predict(self, contractions: Vector) -> tuple[Vector, Vector]:
        """Predict marker coordinates [m], then tensions [N], at contractions [m]; also return their spread."""
        return self._predict_pose(self._winches(contractions))

    def jacobian(self, contractions: Vector) -> Float[np.ndarray, "coordinates winches"]:
        """Predict the Jacobian of the marker coordinates with respect to the contractions."""
        _, derivatives = self.forward.evaluate(self._scale_inputs(self._winches(contractions)))
        return (self.unit[:, None] * derivatives / self._half)[: self.card.coordinates]

    def predict_inverse(self, markers: Vector) -> Vector:
        """Return the contractions [m] of the inverse network for the coordinates of all markers [m], in marker order.

        Raises:
            InputError: no inverse network, or a wrong number of coordinates.
        """
        given, count = np.asarray(markers, dtype=float).ravel(), self.card.coordinates
        if given.shape != (count,) or not np.isfinite(given).all():
            raise InputError(f"markers must be {count} finite coordinates [m]")
        return self._apply_inverse(given)

    def solve(self, targets: Targets, *, search: bool = True) -> LearnedPose:
        """Compute contractions that move markers to targets.

        Args:
            targets: target positions [m]; markers without a target are free.
            search: True to refine the answer of the inverse network by a search on the forward networks. If a large
                error remains, the search also starts from the nearest samples. False is faster.

        Raises:
            InputError: no targets, an unknown marker, a target outside the space of the body, or `search=False` without
                an inverse network.
        """
        target = self._pose(targets)
        goal, asked = self._goal(target)
        whole = goal
        if len(target.targets) < len(self._rows):
            whole = np.where(asked, goal, self._nearest(goal, asked, 1)[1][0])
        if not search:
            return self.evaluate(target, self._apply_inverse(whole), Tier.NETWORK)
        return self.evaluate(target, self._search(whole, asked), Tier.SEARCH)

    def evaluate(self, target: PoseTarget, contractions: Vector, tier: Tier) -> LearnedPose:
        """Return an answer with the pose that the networks predict."""
        expected, spread = self._predict_pose(contractions)
        names, dim, count = self.card.markers, self.card.dim, self.card.coordinates
        places = expected[:count].reshape(-1, dim)
        found, doubted, goals = places.tolist(), spread[:count].reshape(-1, dim).tolist(), target.targets
        asked = [(row, name) for name, row in self._rows.items() if name in goals]
        return LearnedPose(
            target=target,
            tier=tier,
            contractions=contractions,
            commands=dict(zip(self.card.winches, contractions.tolist(), strict=True)),
            markers=dict(zip(names, places, strict=True)),
            tensions=dict(zip(self.card.cables, np.maximum(expected[count:], 0.0).tolist(), strict=True)),
            errors={name: dist(found[row], goals[name]) for row, name in asked},
            spread={name: hypot(*doubted[row]) for row, name in asked},
        )

    def _apply_inverse(self, markers: Vector) -> Vector:
        if self.inverse is None:
            raise InputError("the model has no inverse network: its learning was stopped before")
        count = self.card.coordinates
        raw, _ = self.inverse.average_members((markers - self.middle[:count]) / self.unit[:count])
        return self._apply_pairs(self._contractions(TANH_SCALE * np.tanh(raw)))

    def _predict_pose(self, contractions: Vector) -> tuple[Vector, Vector]:
        mean, spread = self.forward.average_members(self._scale_inputs(contractions))
        return self.middle + self.unit * mean, self.unit * spread

    def _search(self, goal: Vector, asked: np.ndarray) -> Vector:
        """Return the best local optimum, from the inverse network's answer and, if its error is large, from samples."""
        count = self.card.coordinates
        weights = np.zeros(len(self.unit))
        weights[:count] = asked * self.unit[:count]  # what is left is then in meters
        wanted = np.zeros(len(self.unit))
        wanted[:count] = (goal - self.middle[:count]) / self.unit[:count]
        usual = 3.0  # Ratio of a target's error to the mean error of the networks, above which it is unusual
        enough = asked.sum() / self.card.dim * (usual * self.card.error) ** 2
        starts = [] if self.inverse is None else [self._apply_inverse(goal)]
        best, least = np.zeros(len(self.low)), np.inf
        for start in [*starts, *self._nearest(goal, asked, _STARTS)[0]]:
            found, left = self.forward.descend(self._scale_inputs(start), wanted, weights, self._box(start))
            if left < least:
                best, least = found, left
            if least <= enough:
                break
        return self._contractions(best)

    def _apply_pairs(self, contractions: Vector) -> Vector:
        """Apply the antagonistic pairs of the samples: only one winch of a pair takes in, by the difference of both."""
        one, other = self._pairs
        if not len(one):
            return contractions
        shares = contractions / np.where(self.high > 0, self.high, 1.0)
        more, held = shares[one] - shares[other], contractions.copy()
        held[one], held[other] = np.maximum(more, 0.0) * self.high[one], np.maximum(-more, 0.0) * self.high[other]
        return held

    def _box(self, start: Vector) -> tuple[Vector, Vector] | None:
        """Bounds of a search from a start that obeys the pairs, so that it keeps obeying them; None without pairs."""
        one, other = self._pairs
        if not len(one):
            return None
        low, high = np.full(len(self.low), -1.0), np.ones(len(self.low))
        rest = self._scale_inputs(np.zeros(len(self.low)))
        both = np.r_[one, other]
        low[both] = rest[both]
        idle = np.where(start[one] > start[other], other, one)
        high[idle] = rest[idle]
        return low, high

    def _nearest(self, goal: Vector, asked: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Samples whose markers were nearest to what is asked: contractions, coordinates."""
        squares = np.square(self.reached[:, asked] - goal[asked]).sum(axis=1)
        best = np.argsort(squares, kind="stable")[:count] if count > 1 else squares.argmin(keepdims=True)
        return self.known[best], self.reached[best]

    def _pose(self, targets: Targets) -> PoseTarget:
        return (
            targets
            if isinstance(targets, PoseTarget)
            else PoseTarget(name="target", targets=dict(named_targets(targets)))
        )

    def _goal(self, target: PoseTarget) -> tuple[Vector, np.ndarray]:
        """Coordinates of all markers [m], NaN where nothing is asked for, and which of them are asked for."""
        rows, dim, targets = self._rows, self.card.dim, target.targets
        for name, point in targets.items():
            if name not in rows:
                raise InputError(f"unknown marker {quote(name)} of the model. Available: {', '.join(rows)}.")
            if len(point) != dim:
                raise InputError(f'target of marker "{name}" must be {dim} finite coordinates [m]')
        unknown = (np.nan,) * dim
        goal = np.array([targets.get(name, unknown) for name in rows], dtype=float).ravel()
        return goal, ~np.isnan(goal)

    def _winches(self, contractions: Vector) -> Vector:
        given = np.asarray(contractions, dtype=float)
        if given.shape != self.low.shape or not np.isfinite(given).all():
            raise InputError(f"contractions must be {len(self.low)} finite numbers [m]")
        return given

    def _scale_inputs(self, contractions: Vector) -> Vector:
        return (contractions - self._center) / self._half

    def _contractions(self, scaled: Vector) -> Vector:
        return np.minimum(np.maximum(self._center + self._half * scaled, self.low), self.high)

    @cached_property
    def _rows(self) -> Mapping[str, int]:
        """Return the index of the marker of this name."""
        return {name: row for row, name in enumerate(self.card.markers)}

    @cached_property
    def _pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """Winches of which samples had only one take in, as two rows of places."""
        return index_pairs(self.card.pairs, self.card.winches)

    @cached_property
    def _half(self) -> Vector:
        """Half of what each winch can take in [m]."""
        return 0.5 * span_of(self.low, self.high)

    @cached_property
    def _center(self) -> Vector:
        return self.low + self._half

    @staticmethod
    def load(path: str | Path) -> "LearnedModel":
        """Load a model that `LearnedModel.save` has written.

        Raises:
            InputError: no such file, a file that was changed after it was written, or a format that this version cannot
                read.
        """
        return _FILE.read(path, _model)

    def save(self, path: str | Path) -> Path:
        """Write the model to a file atomically (InputError: the file cannot be written)."""
        arrays = {name: getattr(self, name) for name in ("low", "high", "middle", "unit", "known", "reached")}
        for name in ("forward", "inverse"):
            network = getattr(self, name)
            if network is not None:
                arrays |= {f"{name}.sizes": network.sizes, f"{name}.numbers": network.numbers}
        return _FILE.write(path, self.card.as_json(), arrays)


def index_pairs(pairs: Sequence[Sequence[str]], winches: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Places of the first and of the second winch of each pair by name; groups of one are left out."""
    places = [(winches.index(group[0]), winches.index(group[1])) for group in pairs if len(group) == 2]
    one, other = np.array(places, dtype=int).reshape(-1, 2).T
    return one, other


def span_of(low: Vector, high: Vector) -> Vector:
    """From the least to the most that each winch takes in [m]; 1 where that is nothing."""
    return np.where(high > low, high - low, 1.0)


TANH_SCALE = 1.02
"""Factor on outputs of networks that end in tanh; outputs are then clipped to 1, so that they can reach the limits."""

_STARTS = 3
"""Samples that a search begins from where the inverse network's answer is not near enough."""


def _model(facts: dict[str, Any], arrays: dict[str, np.ndarray]) -> LearnedModel:
    """The model of its parts (ValueError: they do not fit one another)."""
    card = ModelCard.from_json(facts)
    winches, coordinates = len(card.winches), card.coordinates
    expected = coordinates + len(card.cables)
    forward = Perceptrons.of(arrays, "forward", winches, expected)
    inverse = Perceptrons.of(arrays, "inverse", coordinates, winches) if "inverse.sizes" in arrays else None
    samples = len(arrays["known"])
    shapes = {"low": (winches,), "high": (winches,), "middle": (expected,), "unit": (expected,)}
    shapes |= {"known": (samples, winches), "reached": (samples, coordinates)}
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            raise ValueError(f"array {name} has a wrong size")
    if not (winches and coordinates and samples):
        raise ValueError("it has no winch, no marker or no sample")
    if (arrays["low"] > arrays["high"]).any() or (arrays["unit"] <= 0).any():
        raise ValueError("its ranges or units are empty")
    return LearnedModel(card=card, forward=forward, inverse=inverse, **{name: arrays[name] for name in shapes})


_KINDS: dict[str, tuple[str, int]] = dict.fromkeys(("low", "high", "middle", "unit"), ("<f8", 1))
_KINDS |= dict.fromkeys(("known", "reached", "forward.numbers", "inverse.numbers"), ("<f4", 2))
_KINDS |= dict.fromkeys(("forward.sizes", "inverse.sizes"), ("<i8", 1))
"""Type and number of axes of each array; networks are learned in float32."""

_FILE = PortableFile(magic=b"HSMODEL1", word="model", writer="hydrostat learn", kinds=_KINDS)
