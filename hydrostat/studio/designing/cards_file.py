"""`cards_content`, `read_cards`: networks to choose from as bytes, so that a crash of the studio does not lose them."""

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from hydrostat.design import BuildCost
from hydrostat.errors import InputError
from hydrostat.fabrication import Demand
from hydrostat.robot import Body, Cable, CableSide, PoseTarget, Robot, Winch
from hydrostat.studio.designing.design_work import Candidate, PoseResult

MAX_BYTES = 8_000_000  # more bytes than these are not kept: cards that would go beyond are left out, the last first

_PLAIN = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class ReachRecord(BaseModel):
    """A `PoseResult`, with lists for arrays."""

    model_config = _PLAIN

    pose: PoseTarget
    nodes: list[list[float]]
    contractions: list[float]
    tensions: list[float]
    places: dict[str, tuple[float, ...]]
    errors: dict[str, float]
    error: float


class CardRecord(BaseModel):
    """A `Candidate` without the body, with lists for arrays."""

    model_config = _PLAIN

    winches: tuple[Winch, ...]
    cables: tuple[Cable, ...]
    face: CableSide | None
    reaches: tuple[ReachRecord, ...]
    error: float
    built: float
    craft: BuildCost
    complete: bool
    solved: tuple[str, ...]  # what the loads below are of, in words
    tensions: list[float]  # the largest of each cable [N]
    torques: list[float]  # the largest of each winch [N m]
    taken: list[list[float]]  # least and most cable of each winch [m]
    torque: float | None = None  # torque limit of the design [N m]


class CardsFile(BaseModel):
    """All of it."""

    model_config = _PLAIN

    format: Literal[1] = 1
    body: str  # that the networks are of
    cards: tuple[CardRecord, ...]


def cards_content(candidates: Sequence[Candidate]) -> bytes:
    """Candidates for one body, the best of the latest design first, as JSON; empty without any."""
    records: list[CardRecord] = []
    left = MAX_BYTES
    for candidate in candidates:
        record = _record(candidate)
        left -= len(record.model_dump_json())
        if left < 0:
            break
        records.append(record)
    if not records:
        return b""
    body = body_stamp(candidates[0].source.body)
    return CardsFile(body=body, cards=tuple(records)).model_dump_json().encode()


def read_cards(content: bytes, robot: Robot) -> list[Candidate]:
    """Candidates of a robot, numbered from 1; none where the bytes are of another body (InputError: damaged)."""
    try:
        file = CardsFile.model_validate_json(content)
        if file.body != body_stamp(robot.body):
            return []
        return [_candidate(record, robot, number) for number, record in enumerate(file.cards, start=1)]
    except ValueError as error:  # also of pydantic, and of lists of other lengths
        raise InputError(f"networks from an earlier session cannot be read: {error}".splitlines()[0]) from None


def body_stamp(body: Body) -> str:
    """Fingerprint of the nodes of a body."""
    return hashlib.sha256(np.ascontiguousarray(body.mesh.nodes).tobytes()).hexdigest()


def _record(candidate: Candidate) -> CardRecord:
    robot, demand = candidate.robot, candidate.demand
    return CardRecord(
        winches=robot.winches,
        cables=robot.cables,
        face=robot.face,
        reaches=tuple(map(_reach_record, candidate.reaches)),
        error=float(candidate.error),
        built=float(candidate.expected_error),
        craft=candidate.craft,
        complete=candidate.complete,
        solved=demand.poses,
        tensions=demand.tensions.tolist(),
        torques=demand.torques.tolist(),
        taken=demand.taken.tolist(),
        torque=candidate.torque,
    )


def _reach_record(reach: PoseResult) -> ReachRecord:
    return ReachRecord(
        pose=reach.pose,
        nodes=reach.nodes.tolist(),
        contractions=reach.contractions.tolist(),
        tensions=reach.tensions.tolist(),
        places=reach.places,
        errors={name: float(error) for name, error in reach.errors.items()},
        error=float(reach.error),
    )


def _candidate(record: CardRecord, robot: Robot, number: int) -> Candidate:
    demand = Demand(
        poses=record.solved,
        tensions=np.array(record.tensions),
        torques=np.array(record.torques),
        taken=np.array(record.taken).reshape(-1, 2),
    )
    return Candidate(
        number=number,
        source=robot,
        robot=replace(robot.with_network(record.winches, record.cables), face=record.face),
        reaches=tuple(_reach(reach, robot) for reach in record.reaches),
        error=record.error,
        expected_error=record.built,
        craft=record.craft,
        demand=demand,
        complete=record.complete,
        torque=record.torque,
    )


def _reach(record: ReachRecord, robot: Robot) -> PoseResult:
    """With arrays (InputError: of other shapes than the body)."""
    nodes = np.array(record.nodes)
    if nodes.shape != robot.body.mesh.nodes.shape:
        raise InputError("networks from an earlier session are of another body")
    return PoseResult(
        pose=record.pose,
        nodes=nodes,
        contractions=np.array(record.contractions),
        tensions=np.array(record.tensions),
        places=record.places,
        errors=record.errors,
        error=record.error,
    )
