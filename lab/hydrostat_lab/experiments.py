"""`EXPERIMENTS`: what the thesis tried with reinforcement learning, item by item (its section 5.4)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hydrostat_lab.curriculum import MASTERED, Curriculum
from hydrostat_lab.hindsight_ddpg import DdpgOptions, Epochs


@dataclass(frozen=True, kw_only=True)
class Run:
    """One way to learn within an experiment.

    Attributes:
        options: options of the method.
        horizon: actions of an episode (T).
        random_start: True if episodes begin in a random pose.
    """

    options: DdpgOptions
    horizon: int = 1
    random_start: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Ran:
    """Result of a run: epochs, and distances [cm] after each action of the best policies, (horizon, seeds, tests)."""

    run: Run
    epochs: Epochs
    best: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Claim:
    """Something that the thesis says: that a number of each seed is above a bound.

    Attributes:
        text: statement, with its number in the list of the thesis's statements.
        measure: the number of each seed, of the runs by their names.
        above: the bound.
        unit: unit of the number, for people.
    """

    text: str
    measure: Callable[[Mapping[str, Ran]], np.ndarray]
    above: float = 0.0
    unit: str = ""


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """Runs that are compared, and what is claimed of them.

    Attributes:
        title: title of the experiment.
        runs: ways to learn, by their names.
        claims: claims of the thesis, or of its readers.
        shown: quantity that the picture shows over the actions: "success", "distance" or "tolerance".
    """

    title: str
    runs: Mapping[str, Run]
    claims: Sequence[Claim] = field(default_factory=tuple)
    shown: Sequence[str] = ("success", "distance")


def speed(ran: Ran) -> np.ndarray:
    """Mean success over all epochs, of each seed: the area below its curve."""
    return ran.epochs.success.mean(axis=0)


def final(ran: Ran) -> np.ndarray:
    """Success of each seed in its last epochs, a tenth of all."""
    return ran.epochs.success[-max(1, len(ran.epochs.success) // 10) :].mean(axis=0)


def least(ran: Ran) -> np.ndarray:
    """Smallest tolerance that each seed mastered [cm]; infinite where it mastered none."""
    mastered = np.where(ran.epochs.success >= MASTERED, ran.epochs.tolerance, np.inf)
    return mastered.min(axis=0)


def error(ran: Ran) -> np.ndarray:
    """Mean distance of each seed's best policy after its last action [cm]."""
    return ran.best[-1].mean(axis=1)


_PAPER = DdpgOptions()
SMALL = DdpgOptions(layers=(30,) * 4, shaped=True)
_SPARSE = replace(SMALL, shaped=False)
_FREE = replace(SMALL, penalty=0.0, cut=False)
_SHRINKING = replace(SMALL, curriculum=Curriculum.TENTH)


def _faster(one: str, other: str) -> Callable[[Mapping[str, Ran]], np.ndarray]:
    """By how much one run's mean success is above another's."""
    return lambda ran: speed(ran[one]) - speed(ran[other])


def _nearer(one: str, other: str) -> Callable[[Mapping[str, Ran]], np.ndarray]:
    """By how many millimeters one run's best policies are nearer than another's."""
    return lambda ran: 10.0 * (error(ran[other]) - error(ran[one]))


def _finer(one: str, other: str) -> Callable[[Mapping[str, Ran]], np.ndarray]:
    """By how many millimeters the smallest tolerance that one run mastered is below another's."""
    return lambda ran: 10.0 * (_clip_lengths(least(ran[other])) - _clip_lengths(least(ran[one])))


def _first_action(ran: Mapping[str, Ran]) -> np.ndarray:
    """Share of tests that the first action of T=10 brings within the tolerance."""
    return (ran["T=10"].best[0] < ran["T=10"].run.options.tolerance).mean(axis=1)


def _lengths(options: DdpgOptions, layers: str) -> Experiment:
    """Experiment on episodes of one action, five and ten (R79, R80; Fig 5.8 has one and ten)."""
    return Experiment(
        title=f"episodes of one action, five and ten, with as many actions in all; {layers}, sparse",
        runs={f"T={horizon}": Run(options=options, horizon=horizon) for horizon in (1, 5, 10)},
        claims=(
            Claim(text="T=10 learns faster than T=1 (N13)", measure=_faster("T=10", "T=1")),
            Claim(text="T=1 ends above 0.9 (N13)", measure=lambda ran: final(ran["T=1"]), above=MASTERED),
            Claim(text="T=10 ends above 0.9 (N13)", measure=lambda ran: final(ran["T=10"]), above=MASTERED),
            Claim(text="T=10 arrives with its first action (N13)", measure=_first_action, above=MASTERED),
        ),
    )


def _curricula(options: DdpgOptions, layers: str) -> Experiment:
    """Experiment on schedules that make the tolerance smaller (Fig 5.9)."""
    tenth = replace(options, curriculum=Curriculum.TENTH)
    ways = {
        "a: halved": replace(options, curriculum=Curriculum.HALVE),
        "b: less a tenth": tenth,
        "c: b, critic 0.01": replace(tenth, late_critic_rate=1e-2),
        "d: current error": replace(options, curriculum=Curriculum.CURRENT),
    }
    return Experiment(
        title=f"the tolerance is made smaller when nine of ten tests succeed; {layers}, sparse, T=5",
        runs={name: Run(options=each, horizon=5) for name, each in ways.items()},
        claims=(
            Claim(
                text="b masters smaller tolerances than a (R83)",
                measure=_finer("b: less a tenth", "a: halved"),
                unit="mm",
            ),
            _stuck("c does not master 8.1 mm (R83)", "c: b, critic 0.01"),
            Claim(
                text="d masters smaller tolerances than b (F10, proposed)",
                measure=_finer("d: current error", "b: less a tenth"),
                unit="mm",
            ),
        ),
        shown=("success", "tolerance"),
    )


def _critics() -> Experiment:
    """Experiment on the other readings of curriculum c: its rate from the start, Adam begun again, begun at 8.1 mm."""
    tenth = replace(_SPARSE, curriculum=Curriculum.TENTH)
    ways = {
        "from the start": replace(tenth, critic_rate=1e-2),
        "Adam from step 0": replace(tenth, late_critic_rate=1e-2, reset_adam=True),
        "begun at 8.1 mm": replace(tenth, critic_rate=1e-2, tolerance=0.81),
    }
    return Experiment(
        title="other readings of curriculum c of Fig 5.9, critic 0.01; 4 x 30, sparse, T=5",
        runs={name: Run(options=each, horizon=5) for name, each in ways.items()},
        claims=(
            _stuck("with its rate from the start, c does not master 8.1 mm (R83)", "from the start"),
            _stuck("with Adam's steps from 0, c does not master 8.1 mm (R83, E57)", "Adam from step 0"),
            Claim(
                text="begun at 8.1 mm, c masters it (R83)",
                measure=lambda ran: ran["begun at 8.1 mm"].epochs.success.max(axis=0),
                above=MASTERED,
            ),
        ),
        shown=("success", "tolerance"),
    )


def _stuck(text: str, run: str) -> Claim:
    """Claim that the least tolerance that a run masters is above 8.1 mm."""
    return Claim(text=text, measure=lambda ran: 10.0 * _clip_lengths(least(ran[run])), above=8.101, unit="mm")


EXPERIMENTS: Mapping[str, Experiment] = {
    "figure-5.8": _lengths(_PAPER, "3 x 256"),
    "figure-5.8-small": _lengths(_SPARSE, "4 x 30"),
    "figure-5.9": _curricula(_PAPER, "3 x 256"),
    "figure-5.9-small": _curricula(_SPARSE, "4 x 30"),
    "figure-5.9-critic": _critics(),
    "figure-5.10": Experiment(
        title="tolerances, and errors of the best policies (Figs 5.10, 5.11); 4 x 30, shaped",
        runs={"T=1": Run(options=_SHRINKING), "T=5": Run(options=_SHRINKING, horizon=5)},
        claims=(
            Claim(
                text="T=5 masters smaller tolerances than T=1 (N14)",
                measure=_finer("T=5", "T=1"),
                unit="mm",
            ),
            Claim(text="T=5 ends nearer than T=1 (N15)", measure=_nearer("T=5", "T=1"), unit="mm"),
            Claim(
                text="errors are below the tolerance in most epochs (N15)",
                measure=lambda ran: np.concatenate([_below(ran["T=1"]), _below(ran["T=5"])]),
                above=0.5,
            ),
        ),
        shown=("tolerance", "distance"),
    ),
    "figure-5.12": Experiment(
        title="episodes from rest, and from poses at random; 4 x 30, shaped, T=5",
        runs={
            "from rest": Run(options=_SHRINKING, horizon=5),
            "from anywhere": Run(options=_SHRINKING, horizon=5, random_start=True),
        },
        claims=(
            Claim(
                text="from anywhere it comes as near as from rest, within 1 mm (R85)",
                measure=_nearer("from anywhere", "from rest"),
                above=-1.0,
                unit="mm",
            ),
        ),
    ),
    "table-noise": Experiment(
        title="noise of actions 0.01, 0.1 and 0.2 (E47); 4 x 30, shaped, T=1",
        runs={f"noise {noise:g}": Run(options=replace(SMALL, noise=noise)) for noise in (0.01, 0.1, 0.2)},
        claims=(
            Claim(text="0.1 ends nearer than 0.01 (E47)", measure=_nearer("noise 0.1", "noise 0.01"), unit="mm"),
            Claim(text="0.2 ends nearer than 0.01 (E47)", measure=_nearer("noise 0.2", "noise 0.01"), unit="mm"),
        ),
    ),
    "table-reward": Experiment(
        title="shaped and sparse rewards; what penalty and cut targets do (E54); 4 x 30",
        runs={
            "shaped, T=1": Run(options=SMALL),
            "sparse, T=1": Run(options=_SPARSE),
            "shaped, free, T=1": Run(options=_FREE),
            "shaped, T=5": Run(options=SMALL, horizon=5),
            "shaped, free, T=5": Run(options=_FREE, horizon=5),
        },
        claims=(
            Claim(text="shaped learns faster than sparse (R87)", measure=_faster("shaped, T=1", "sparse, T=1")),
            Claim(
                text="without penalty and cut T=1 ends nearer (E54)",
                measure=_nearer("shaped, free, T=1", "shaped, T=1"),
                unit="mm",
            ),
            Claim(
                text="then T=5 still ends nearer than T=1 (E54)",
                measure=_nearer("shaped, free, T=5", "shaped, free, T=1"),
                unit="mm",
            ),
        ),
    ),
}
"""By their names for `hydrostat reproduce`."""


def _clip_lengths(lengths: np.ndarray) -> np.ndarray:
    """Tolerances [cm] where none was mastered: more than the first."""
    return np.where(np.isfinite(lengths), lengths, 1.0 / 0.9)


def _below(ran: Ran) -> np.ndarray:
    """Share of epochs in which the mean distance is below the tolerance, of each seed."""
    return (ran.epochs.distance < ran.epochs.tolerance).mean(axis=0)
