"""`Mimicry`: poses of a robot with glove readings while a person mimicked them, or while the robot wore it."""

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.files import replace_file
from hydrostat.teleop.ridge import Ridge, Table, fit_ridge, folded_error, left_out_error
from hydrostat.version import install_command


class Mimicry:
    """Pairs of sensor readings and robot outputs: contractions or fingertip positions.

    Pairs come from a person who mimics the robot, or from a robot that wears the glove. A pose may have several rows;
    cross-validation leaves them out together.

    Attributes:
        sensors: sensor names.
        outputs: output names.
        poses: pose index of each row.
        stamps: time of each row, since 1970 [s].
    """

    def __init__(self, sensors: Sequence[str], outputs: Sequence[str]) -> None:
        """No pairs yet."""
        self.sensors, self.outputs = tuple(sensors), tuple(outputs)
        self.poses: list[int] = []
        self.stamps: list[float] = []
        self._inputs: list[Vector] = []
        self._answers: list[Vector] = []

    @property
    def inputs(self) -> Table:
        """Sensor values of the pairs (rows, sensors)."""
        return np.array(self._inputs).reshape(-1, len(self.sensors))

    @property
    def answers(self) -> Table:
        """Robot outputs of the pairs (rows, outputs)."""
        return np.array(self._answers).reshape(-1, len(self.outputs))

    def add(self, pose: int, sensors: Vector, answer: Vector, stamp: float = 0.0) -> None:
        """Add a pair of a pose (InputError: wrong size, or not finite)."""
        if sensors.shape != (len(self.sensors),) or answer.shape != (len(self.outputs),):
            raise InputError(f"a pair has {len(self.sensors)} sensors and {len(self.outputs)} outputs")
        if not (np.isfinite(sensors).all() and np.isfinite(answer).all()):
            raise InputError("sensors and outputs must be finite")
        self.poses.append(pose)
        self.stamps.append(stamp)
        self._inputs.append(sensors.copy())
        self._answers.append(answer.copy())

    def forget(self, pose: int) -> None:
        """Remove a pose."""
        for index in reversed(range(len(self.poses))):
            if self.poses[index] == pose:
                del self.poses[index], self.stamps[index], self._inputs[index], self._answers[index]

    def learn(self) -> Ridge:
        """Fit a ridge regression from sensors to outputs (InputError: fewer than two poses)."""
        return fit_ridge(self.inputs, self.answers, self.poses)

    def errors(self, known: Ridge) -> tuple[float, float]:
        """Return the root-mean-square errors of leave-one-pose-out and five-fold cross-validation."""
        table = self.inputs, self.answers, self.poses, known.penalty
        return left_out_error(*table), folded_error(*table)

    def next_pose(self, candidates: Table) -> int:
        """Return the index of the candidate to mimic next: it maximizes the determinant of the information (D-optimal).

        The information is that of an affine map between candidates (rows, outputs) and sensors; no sensor model is
        needed.
        """
        known = np.column_stack([np.ones(len(self.poses)), self.answers])
        ways = np.column_stack([np.ones(len(candidates)), candidates])
        least = 1e-3 * max(float(np.mean(ways**2)), 1e-12)
        information = known.T @ known + least * np.eye(known.shape[1])
        return int(np.argmax(np.einsum("ij,ij->i", ways, np.linalg.solve(information, ways.T).T)))

    def save(self, path: Path) -> Path:
        """Write the pairs as a text table, one row for each."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["pose", "time_s", *(f"sensor {name}" for name in self.sensors), *self.outputs])
        for pose, stamp, sensors, answer in zip(self.poses, self.stamps, self._inputs, self._answers, strict=True):
            writer.writerow([pose, repr(stamp), *map(repr, sensors.tolist()), *map(repr, answer.tolist())])
        return replace_file(path, text.getvalue().encode())

    @classmethod
    def open(cls, path: Path) -> "Mimicry":
        """Read a table of pairs (InputError: not such a table; names the line)."""
        try:
            rows = list(csv.reader(path.read_text("utf-8").splitlines()))
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: cannot be read ({error})") from None
        if not rows or rows[0][:2] != ["pose", "time_s"]:
            raise InputError(f"{path}: is no table of mimicked poses; its first columns are pose and time_s")
        heads = rows[0][2:]
        sensors = [name.removeprefix("sensor ") for name in heads if name.startswith("sensor ")]
        made = cls(sensors, heads[len(sensors) :])
        for count, row in enumerate(rows[1:], 2):
            try:
                stamp, *cells = [float(cell) for cell in row[1:]]
                values = np.array(cells)
                made.add(int(row[0]), values[: len(sensors)], values[len(sensors) :], stamp)
            except (ValueError, IndexError, InputError) as error:
                raise InputError(f"{path}, line {count}: {error}") from None
        return made

    def write_mcap(self, path: Path) -> Path:
        """Write pairs as MCAP with JSON schemas for Foxglove and ROS 2, one channel each for glove and robot.

        Args:
            path: path of the file.

        Raises:
            InputError: the package mcap is missing.
        """
        try:
            from mcap.writer import Writer
        except ModuleNotFoundError:
            raise InputError(f"MCAP files need mcap; install it: {install_command('teleop')}") from None
        buffer = io.BytesIO()
        writer = Writer(buffer)
        writer.start(library="hydrostat")
        tables = {"glove": (self.sensors, self.inputs), "robot": (self.outputs, self.answers)}
        for topic, (names, rows) in tables.items():
            numbers = {"pose": {"type": "integer"}} | {name: {"type": "number"} for name in names}
            schema = json.dumps({"type": "object", "properties": numbers}).encode()
            known = writer.register_schema(f"hydrostat.{topic}", "jsonschema", schema)
            channel = writer.register_channel(f"/{topic}", "json", known)
            for pose, row, stamp in zip(self.poses, rows.tolist(), self.stamps, strict=True):
                data = json.dumps({"pose": pose} | dict(zip(names, row, strict=True))).encode()
                when = round(1e9 * stamp)
                writer.add_message(channel, when, data, when)
        writer.finish()
        return replace_file(path, buffer.getvalue())
