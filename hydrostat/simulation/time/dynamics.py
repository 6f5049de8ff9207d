"""`Dynamics`: motion of a robot in time."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.geometry import Anchors
from hydrostat.given import check_not_negative, check_number, check_type
from hydrostat.mechanics import (
    SCHEMES,
    Assembly,
    Energy,
    FactorizedHessian,
    InertiaEnergy,
    MaxwellBranches,
    NewtonOptions,
    NewtonResult,
    RoundOff,
    ViscousMetrics,
    minimize,
)
from hydrostat.robot import Robot
from hydrostat.simulation.body_physics import BodyPhysics
from hydrostat.simulation.contraction_profile import ContractionProfile
from hydrostat.simulation.controls import contraction_values, split_controls
from hydrostat.simulation.statics.history_equilibrium import find_history_equilibrium
from hydrostat.simulation.time.motion import Motion

PinShifts = Mapping[int, Vector]
"""Displacement of pins from their rest positions [m], by pin index; other pins stay where they are."""


@dataclass(frozen=True, kw_only=True)
class StepOptions:
    """Options for time integration.

    Attributes:
        scheme: name of a scheme in `SCHEMES`.
        drag: mass-proportional (Rayleigh) damping, alpha [1/s]: force per mass and velocity; 0 for none.
        halvings: maximum number of times a step is halved if its minimization fails.

    Raises:
        InputError: an unknown scheme, a negative drag, or a negative number of halvings.
    """

    scheme: str = "sdirk2"
    drag: float = 0.0
    halvings: int = 5

    def __post_init__(self) -> None:
        if self.scheme not in SCHEMES:
            raise InputError(f'unknown scheme "{self.scheme}". Allowed: {", ".join(SCHEMES)}.')
        check_not_negative("drag", self.drag, "1/s")
        check_type(self.halvings, int, "halvings must be a whole number of 0 or more")
        if self.halvings < 0:
            raise InputError(f"halvings must be 0 or more, not {self.halvings}")


@dataclass(frozen=True, eq=False)
class _MotionState:
    """Time-dependent state, or its rate of change."""

    nodes: Nodes
    velocities: Nodes
    metrics: ViscousMetrics

    def plus(self, step: float, rate: "_MotionState") -> "_MotionState":
        return _MotionState(
            self.nodes + step * rate.nodes,
            self.velocities + step * rate.velocities,
            self.metrics + step * rate.metrics,
        )


class Dynamics:
    """Steps in time as minimizations, from a state of motion to the next (E4, E5)."""

    def __init__(
        self,
        robot: Robot,
        body: BodyPhysics,
        statics: Assembly,
        tensions: Callable[[Nodes, Vector, Vector], Vector],
        markers: Anchors,
        options: NewtonOptions,
    ) -> None:
        """Take the robot's physics at rest, functions for tensions and markers, and the Newton options."""
        material = robot.body.material
        self.robot, self.masses = robot, body.inertias
        self._statics, self._tensions, self._markers, self._options = statics, tensions, markers, options
        self.obstacles = body.obstacles  # indices of their energies
        self._guides, self._load_paths, self._begin = body.guides, body.load_paths, body.rest_unknowns
        self._warp = body.warp
        branches = [(branch.modulus * branch.time, branch.time) for branch in material.relaxation]
        branches += [(material.viscosity, 0.0)] if material.viscosity else []
        viscosities, times = np.array(branches).reshape(-1, 2).T.copy()
        self.memory = MaxwellBranches(body.rest_unknowns, body.elastic, viscosities=viscosities, times=times)
        self._round_off = body.round_off(max((cable.stiffness for cable in robot.cables), default=0.0))
        rest = self.motion_at_rest(body.rest_unknowns, np.zeros(robot.num_controls), None, None)
        begin = _state(rest)
        moving = self._energies(begin, 1.0, 0.0, list(statics.energies))[len(statics.energies) :]
        self._assembly = statics.with_added_energies(moving, control_count=robot.num_controls)

    def motion_at_rest(
        self, nodes: Nodes, contractions: Vector, velocities: Nodes | None, history: Vector | None
    ) -> Motion:
        """Return a motion that starts at `nodes`, with relaxed viscous branches and the given `history`."""
        nodes = np.concatenate([nodes, self._begin[len(nodes) :]])  # statics has no rows of obstacles on a path
        history = self._statics.history if history is None else history
        still, shape = np.zeros_like(nodes), self.robot.body.mesh.nodes.shape
        if velocities is not None and not (velocities.shape == shape and np.isfinite(velocities).all()):
            raise InputError(f"velocities must be finite, {shape}, not {velocities.shape}")
        begin = still.copy()
        begin[: shape[0]] = 0.0 if velocities is None else velocities
        state = _MotionState(nodes, begin, self.memory.relax_fully(nodes))
        shifts = np.zeros((len(self.robot.pins), nodes.shape[1]))
        return self._motion(0.0, (contractions, shifts, history), state, still, None)

    def step(
        self, motion: Motion, contractions: Vector, dt: float, options: StepOptions, pin_shifts: PinShifts
    ) -> Motion:
        """Return the motion after `dt` [s], while contractions and pins move evenly to their final values.

        Raises:
            InputError: a step that is not above 0, or a pin that is not there.
            NotConvergedError: not even the smallest steps converged; its text says why.
        """
        if not isinstance(motion, Motion):
            raise InputError(
                f"a step goes on from a motion, not from {type(motion).__name__}: call "
                "`simulation.motion_at_rest(pose)`"
            )
        if not (np.isfinite(dt) and dt > 0):
            raise InputError(f"the time step must be above 0 s, not {dt:g}")
        shifts = self._shifts(motion, pin_shifts)
        result, iterations = None, 0
        for halvings in range(options.halvings + 1):
            at, parts = motion, 2**halvings
            for part in range(1, parts + 1):
                share = part / parts
                goal = (1 - share) * motion.controls + share * contractions
                places = (1 - share) * motion.pin_shifts + share * shifts
                at, result = self._advance(at, goal, places, dt / parts, options)
                iterations += result.iterations
                if not result.converged:
                    break
            if result is not None and result.converged:
                return replace(at, time=motion.time + dt, result=replace(result, iterations=iterations))
        assert result is not None
        raise NotConvergedError(
            f"no step found at {motion.time:.4g} s, not even one of {dt / 2**options.halvings:.2g} s: {result.status}; "
            f"try another time step (force left over {result.residual:.2g} N, allowed {result.allowed:.2g} N)",
            result,
        )

    def play(
        self, profile: ContractionProfile, seconds: float, dt: float, start: Motion, options: StepOptions
    ) -> Iterator[Motion]:
        """Yield the motion under a contraction profile: its start, then each step.

        Raises:
            InputError: a duration or a time step that is not above 0.
        """
        check_number("duration", seconds, "s")
        check_number("time step", dt, "s")
        if not (seconds > 0 and dt > 0):
            raise InputError(f"duration and time step must be above 0 s, not {seconds:g} and {dt:g}")
        motion, begin, steps = start, start.time, max(1, ceil(seconds / dt - 1e-9))
        yield motion
        for step in range(1, steps + 1):
            end = begin + seconds * step / steps
            motion = self.step(motion, contraction_values(self.robot, profile.at(end)), end - motion.time, options, {})
            yield motion

    def energies_at(self, motion: Motion) -> list[Energy]:
        """Energies of statics at an instant of a motion: pins, guides and loads as then, after its history."""
        nodes = _stack_rows(motion.nodes, motion, 0)
        return self._remembering(motion.history, nodes, motion.controls, motion.pin_shifts, motion.time)

    def _advance(
        self, motion: Motion, goal: Vector, shifts: Points, dt: float, options: StepOptions
    ) -> tuple[Motion, NewtonResult]:
        """Take one step; return the motion and its last minimization. If that failed, the motion is invalid."""
        begin = _state(motion)
        end, rates = begin, []
        acceleration = _stack_rows(motion.accelerations, motion, 2)
        history, at = motion.history, motion.controls
        result, iterations = None, 0
        for *weights, diagonal in SCHEMES[options.scheme].table:
            base, step = begin, diagonal * dt
            for weight, rate in zip(weights, rates, strict=True):
                base = base.plus(weight * dt, rate)
            base = replace(base, metrics=self.memory.sound(base.metrics, end.metrics))
            share = sum(weights) + diagonal
            controls = (1 - share) * motion.controls + share * goal
            places = (1 - share) * motion.pin_shifts + share * shifts
            statics = self._remembering(history, end.nodes, at, places, motion.time + share * dt)
            energies = self._energies(base, step, options.drag, statics)
            assembly, result = self._minimize(energies, controls, base, end.nodes, acceleration, step)
            iterations += result.iterations
            if not result.converged:
                return motion, replace(result, iterations=iterations)
            history, at = assembly.with_advanced_history(result.nodes, controls).history, controls
            velocities = (result.nodes - base.nodes) / step
            end = _MotionState(result.nodes, velocities, self.memory.relax_step(base.metrics, result.nodes, step))
            acceleration = (velocities - base.velocities) / step
            rates.append(_MotionState(velocities, acceleration, (end.metrics - base.metrics) / step))
        assert result is not None
        counted = replace(result, iterations=iterations, stiffness=None)
        return self._motion(motion.time + dt, (goal, shifts, history), end, acceleration, counted), counted

    def _remembering(
        self, history: Vector, nodes: Nodes, contractions: Vector, shifts: Points, instant: float
    ) -> list[Energy]:
        """Energies of statics at an instant [s], with pins, guides and loads as then, after the given `history`."""
        statics = self._statics.with_history(history, nodes, contractions) if len(history) else self._statics
        energies = list(statics.energies)
        for slot, obstacle in self._guides.items():
            place, axes = obstacle.shift(instant), np.eye(len(obstacle.at))
            energies[slot] = energies[slot].with_target(place, axes)  # type: ignore[attr-defined]
        for slot, load in self._load_paths.items():
            energies[slot] = energies[slot].with_load(load.share_at(instant))
        return [energy.with_supports_moved(shifts) for energy in energies] if shifts.any() else energies

    def _energies(self, base: _MotionState, step: float, drag: float, statics: list[Energy]) -> list[Energy]:
        """Those of statics, inertia, and the viscous branches if there are any."""
        energies = list(statics)
        braked = 1 + drag * step
        energies.append(InertiaEnergy(base.nodes + step / braked * base.velocities, self.masses * (braked / step**2)))
        if len(self.memory):
            energies.append(self.memory.energy(base.metrics, step))
        return energies

    def _minimize(
        self,
        energies: list[Energy],
        controls: Vector,
        base: _MotionState,
        before: Nodes,
        acceleration: Nodes,
        step: float,
    ) -> tuple[Assembly, NewtonResult]:
        """One stage, from whichever guess has the least energy; and the energies in balance with it."""
        assembly = self._assembly.with_terms(energies)
        flown = base.nodes + step * base.velocities
        guesses = [flown + step**2 * acceleration, flown, before]
        near = assembly.with_active_terms(before)
        guesses = [before + near.largest_step(before, guess - before) * (guess - before) for guess in guesses]
        values = [assembly.with_active_terms(guess).value(guess, controls) for guess in guesses]
        start = guesses[int(np.argmin(values))]
        noise = self._noise(step)

        def relax(assembly: Assembly, nodes: Nodes, known: FactorizedHessian | None, tolerance: float) -> NewtonResult:
            options = replace(self._options, tolerance=max(tolerance, self._options.tolerance))
            return minimize(
                assembly, nodes, controls, round_off=noise, options=options, warp=self._warp, stiffness=known
            )

        return find_history_equilibrium(assembly, (start, None), controls, relax, noise.force)

    def _noise(self, step: float) -> RoundOff:
        """Rounding errors in a step, including inertia and viscous forces."""
        body = self.robot.body
        scale = 0.0
        if len(self.memory):
            scale = 2 * self.memory.modulus(step) * float(body.mesh.volumes.sum()) * (body.thickness or 1.0)
        inertia = float(self.masses.max()) / step**2 * max(body.mesh.size, float(np.abs(body.mesh.nodes).max()))
        return RoundOff(
            force=self._round_off.force + 1e-13 * scale / body.mesh.size + 1e-15 * inertia,
            energy=self._round_off.energy + 1e-15 * scale + 1e-19 * inertia,
        )

    def _shifts(self, motion: Motion, given: PinShifts) -> Points:
        shifts = motion.pin_shifts.copy()
        for index, shift in given.items():
            if not 0 <= index < len(shifts):
                raise InputError(f"unknown pin {index}. Pins are counted from 0, and there are {len(shifts)}.")
            if np.shape(shift) != shifts[index].shape or not np.isfinite(shift).all():
                raise InputError(f"the shift of pin {index} must be {shifts.shape[1]} finite numbers [m]")
            shifts[index] = shift
        return shifts

    def _motion(
        self,
        time: float,
        held: tuple[Vector, Points, Vector],
        state: _MotionState,
        accelerations: Nodes,
        result: NewtonResult | None,
    ) -> Motion:
        """Return the full record of an instant; `held` are controls, pin shifts and history."""
        (contractions, shifts, history), nodes = held, state.nodes
        places = self._markers.positions(nodes)
        statics = self._remembering(history, nodes, contractions, shifts, time)
        count = len(self.robot.body.mesh.nodes)
        carried = (nodes[count:], state.velocities[count:], accelerations[count:])
        return Motion(
            robot=self.robot,
            time=time,
            **split_controls(self.robot, contractions),
            pin_shifts=shifts,
            nodes=nodes[:count],
            velocities=state.velocities[:count],
            accelerations=accelerations[:count],
            carried=carried if len(carried[0]) else None,
            metrics=state.metrics,
            markers={marker.name: place for marker, place in zip(self.robot.markers, places, strict=True)},
            tensions=self._tensions(nodes, contractions, history),
            kinetic=float(0.5 * self.masses @ (state.velocities**2).sum(axis=1)),
            potential=sum(energy.with_active_terms(nodes).value(nodes, contractions) for energy in statics)
            + self.memory.compute_stored_energy(state.metrics, nodes),
            history=history,
            result=result,
        )


def _state(motion: Motion) -> _MotionState:
    """State of motion of all unknowns."""
    return _MotionState(_stack_rows(motion.nodes, motion, 0), _stack_rows(motion.velocities, motion, 1), motion.metrics)


def _stack_rows(rows: Nodes, motion: Motion, part: int) -> Nodes:
    """Rows of the nodes, and those of the obstacles that move."""
    return rows if motion.carried is None else np.concatenate([rows, motion.carried[part]])
