"""An identification as a value: which measurements, which unknowns, and how the model is run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.errors import instance
from laticauda.identify.measurements import Measurement, group_of
from laticauda.identify.settling import applies, let_the_special_win, settled, split_name, with_tied
from laticauda.identify.unknowns import SIDE, Settled, Unknown, as_unknowns
from laticauda.robot import Robot
from laticauda.scenarios import Scenario, default_water, preset_water
from laticauda.simulate.numbers import Parameter, changed, parameters


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """Measurements and unknowns that fit together; made by `problem`."""

    measurements: tuple[Measurement, ...]
    """What was measured."""
    unknowns: tuple[Settled, ...]
    """What is looked for."""
    settings: tuple[Scenario, ...]
    """By measurement: what it is simulated with, apart from what is identified."""
    groups: tuple[str, ...]
    """By measurement: the name of its group."""
    moves: Bool[np.ndarray, "n_measurements n_unknowns"]
    """Whether a measurement depends on an unknown."""
    model: str
    """planar or spatial."""
    options: Mapping[str, Any]
    """How it is run: joints, dt, offset_bandwidth, ramp."""
    threads: int | None
    """How many compute."""

    @cached_property
    def observed(self) -> Float[np.ndarray, " n_data"]:
        """All measured numbers, measurement by measurement: figures, then series; without the bias of selection."""
        return np.concatenate([_flat(measurement) for measurement in self.measurements])

    @cached_property
    def sigma(self) -> Float[np.ndarray, " n_data"]:
        """Standard deviation of the noise of each."""
        parts: list[np.ndarray] = []
        for measurement in self.measurements:
            parts.append(np.array([sigma for _, sigma in measurement.figures.values()]))
            parts += [np.full(values.size, sigma) for values, sigma in measurement.series.values()]
        return np.concatenate(parts)

    @cached_property
    def owner(self) -> Int[np.ndarray, " n_data"]:
        """Number of the measurement that each belongs to."""
        sizes = [_flat(measurement).size for measurement in self.measurements]
        return np.repeat(np.arange(len(sizes)), sizes)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the unknowns."""
        return tuple(unknown.name for unknown in self.unknowns)

    @property
    def start(self) -> Float[np.ndarray, " n_unknowns"]:
        """Where the search begins, as values."""
        return np.array([unknown.start for unknown in self.unknowns])

    def values_of(self, x: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """The values of coordinates."""
        return np.array([unknown.value(float(at)) for unknown, at in zip(self.unknowns, x, strict=True)])

    def x_of(self, values: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """The coordinates of values."""
        return np.array([unknown.x(float(value)) for unknown, value in zip(self.unknowns, values, strict=True)])

    def part(self, members: Sequence[int]) -> "Problem":
        """The same with some of its measurements only, by number; the unknowns stay, whether seen or not."""
        return replace(
            self,
            measurements=tuple(self.measurements[i] for i in members),
            settings=tuple(self.settings[i] for i in members),
            groups=tuple(self.groups[i] for i in members),
            moves=self.moves[list(members)],
        )

    def apply(self, values: Float[np.ndarray, " n_unknowns"]) -> tuple[Scenario, ...]:
        """What each measurement is simulated with at these values; what is alike stays one object."""
        made: dict[object, Scenario] = {}
        found: list[Scenario] = []
        for i, setting in enumerate(self.settings):
            wanted: dict[str, float] = {}
            for k, unknown in enumerate(self.unknowns):
                if self.moves[i, k] and unknown.parameter.name not in SIDE:
                    wanted |= with_tied(setting, unknown.parameter.name, float(values[k]), unknown.tied)
            key = id(setting.robot), id(setting.environment), tuple(wanted.items())
            if key not in made:
                made[key] = changed(setting, wanted)
            found.append(replace(made[key], motion=setting.motion))
        return tuple(found)

    def side(self, i: int, values: np.ndarray) -> dict[str, Any]:
        """The values of `SIDE` for a measurement, as far as they are identified."""
        return {
            unknown.parameter.name: values[k]
            for k, unknown in enumerate(self.unknowns)
            if self.moves[i, k] and unknown.parameter.name in SIDE
        }


def problem(
    measurements: Sequence[Measurement],
    robot: Robot | None,
    wanted: Sequence["str | Unknown"] | Mapping[str, tuple[float, float]],
    *,
    model: str = "planar",
    options: Mapping[str, Any] | None = None,
    threads: int | None = None,
) -> Problem:
    """Put measurements and unknowns together, and check that they fit.

    Args:
        measurements: At least one, no name twice.
        robot: What swam where a measurement does not say it; None: all say it.
        wanted: What is looked for.
        model: planar or spatial.
        options: How it is run.
        threads: How many compute.

    Raises:
        ValueError: If they do not.
    """
    given = _checked(measurements)
    settings = tuple(_setting(measurement, robot) for measurement in given)
    _check_one_body([measurement.name for measurement in given], [setting.robot for setting in settings], robot)
    groups = tuple(group_of(m, s.robot) for m, s in zip(given, settings, strict=True))
    known = _known(settings)
    scopes = [
        {measurement.gait.kind, group, measurement.name} for measurement, group in zip(given, groups, strict=True)
    ]
    names = [split_name(unknown, scopes, known) for unknown in as_unknowns(wanted)]
    moves = np.array(
        [[applies(scope, name, scopes[i], known[i]) for scope, name in names] for i in range(len(given))]
    ).reshape(len(given), len(names))
    let_the_special_win(moves, names)
    found = tuple(
        settled(unknown, *names[k], settings, known, moves[:, k]) for k, unknown in enumerate(as_unknowns(wanted))
    )
    return Problem(
        measurements=given,
        unknowns=found,
        settings=settings,
        groups=groups,
        moves=moves,
        model=model,
        options=dict(options or {}),
        threads=threads,
    )


def _known(settings: Sequence[Scenario]) -> list[dict[str, Parameter]]:
    """The numbers that each measurement has, by name; the same dictionary for what is alike."""
    made: dict[object, dict[str, Parameter]] = {}
    for setting in settings:
        key = id(setting.robot), id(setting.environment)
        if key not in made:
            made[key] = parameters(setting, each=True) | SIDE
    return [made[id(setting.robot), id(setting.environment)] for setting in settings]


def _flat(measurement: Measurement) -> np.ndarray:
    figures = [measurement.without_bias(name) for name in measurement.figures]
    return np.concatenate([figures, *(values.ravel() for values, _ in measurement.series.values())])


def _checked(measurements: Sequence[Measurement]) -> tuple[Measurement, ...]:
    if isinstance(measurements, Measurement) or not len(measurements):
        raise ValueError("`measurements` must be a list of at least one Measurement, got none.")
    seen: set[str] = set()
    for i, measurement in enumerate(measurements):
        instance(f"measurements[{i}]", measurement, Measurement)
        if measurement.name in seen:
            raise ValueError(f"`measurements` must have different names, got `{measurement.name}` twice.")
        seen.add(measurement.name)
    return tuple(measurements)


def _setting(measurement: Measurement, robot: Robot | None) -> Scenario:
    body = measurement.robot or robot
    if body is None:
        raise ValueError(f"`robot` must be given, because the measurement `{measurement.name}` does not say what swam.")
    environment = measurement.environment or preset_water(default_water(measurement.gait))
    return Scenario(robot=body, motion=measurement.gait, environment=environment)


def _check_one_body(names: Sequence[str], robots: Sequence[Robot], robot: Robot | None) -> None:
    """Refuse trials of another robot: fin, tether and what else is mounted may differ, the body may not."""
    body = robot or robots[0]
    for name, other in zip(names, robots, strict=True):
        if other.modules != body.modules or other.joints != body.joints:
            raise ValueError(
                f"`measurements` must be of one body, with or without fin; `{name}` is of robot `{other.name}`, whose "
                f"modules or joints are not those of `{body.name}`."
            )
