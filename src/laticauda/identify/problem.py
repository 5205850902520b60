"""An identification as a value: which measurements, which unknowns, and how the model is run."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.errors import instance, nearest
from laticauda.gaits import Gait
from laticauda.identify.measurements import Measurement, group_of
from laticauda.identify.unknowns import SIDE, Settled, Unknown, as_unknowns, size_of
from laticauda.robot import Environment, Robot
from laticauda.simulate.parameters import Parameter, changed, look_up, parameters, value_of
from laticauda.simulate.swimming import default_water, preset_water

RANGE = 100.0  # a number on a log scale may be so many times its start, or its start so many times it
_HALVINGS = 60


class Setting(NamedTuple):
    """What a measurement is simulated with."""

    robot: Robot
    gait: Gait
    environment: Environment


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """Measurements and unknowns that fit together; made by `problem`."""

    measurements: tuple[Measurement, ...]
    """What was measured."""
    unknowns: tuple[Settled, ...]
    """What is looked for."""
    settings: tuple[Setting, ...]
    """By measurement: what it is simulated with, apart from what is identified."""
    groups: tuple[str, ...]
    """By measurement: the name of its group."""
    moves: Bool[np.ndarray, "n_measurements n_unknowns"]
    """Whether a measurement depends on an unknown."""
    model: str
    """planar or spatial."""
    options: Mapping[str, Any]
    """How it is run: joints, dt, offset_bandwidth, ramp, fluid_law."""
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

    def without(self, left_out: Sequence[int]) -> "Problem":
        """The same without some measurements, by number."""
        kept = [i for i in range(len(self.measurements)) if i not in set(left_out)]
        return self._with(kept, range(len(self.unknowns)))

    def only(self, unknowns: Sequence[int]) -> "Problem":
        """The same with some of its unknowns, by number; the others stay at their starts, wherever those are."""
        return self._with(range(len(self.measurements)), unknowns)

    def _with(self, rows: Sequence[int], columns: Sequence[int]) -> "Problem":
        from dataclasses import replace

        return replace(
            self,
            measurements=tuple(self.measurements[i] for i in rows),
            settings=tuple(self.settings[i] for i in rows),
            groups=tuple(self.groups[i] for i in rows),
            unknowns=tuple(self.unknowns[k] for k in columns),
            moves=self.moves[np.ix_(list(rows), list(columns))],
        )

    def apply(self, values: Float[np.ndarray, " n_unknowns"]) -> tuple[Setting, ...]:
        """What each measurement is simulated with at these values; what is alike stays one object."""
        made: dict[object, Setting] = {}
        found: list[Setting] = []
        for i, setting in enumerate(self.settings):
            wanted = {
                unknown.parameter.name: float(values[k])
                for k, unknown in enumerate(self.unknowns)
                if self.moves[i, k] and unknown.parameter.name not in SIDE
            }
            key = id(setting.robot), id(setting.environment), tuple(wanted.items())
            if key not in made:
                made[key] = Setting(*changed(*setting, wanted))
            found.append(made[key]._replace(gait=setting.gait))
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
    split = [_split(unknown, scopes, known) for unknown in as_unknowns(wanted)]
    moves = np.array(
        [[_applies(scope, name, scopes[i], known[i]) for scope, name in split] for i in range(len(given))]
    ).reshape(len(given), len(split))
    _let_the_special_win(moves, split)
    settled = tuple(
        _settled(unknown, *split[k], settings, known, moves[:, k]) for k, unknown in enumerate(as_unknowns(wanted))
    )
    return Problem(
        measurements=given,
        unknowns=settled,
        settings=settings,
        groups=groups,
        moves=moves,
        model=model,
        options=dict(options or {}),
        threads=threads,
    )


def _known(settings: Sequence[Setting]) -> list[dict[str, Parameter]]:
    """The numbers that each measurement has, by name; the same dictionary for what is alike."""
    made: dict[object, dict[str, Parameter]] = {}
    for setting in settings:
        key = id(setting.robot), id(setting.environment)
        if key not in made:
            made[key] = parameters(*setting, each=True) | SIDE
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


def _setting(measurement: Measurement, robot: Robot | None) -> Setting:
    body = measurement.robot or robot
    if body is None:
        raise ValueError(f"`robot` must be given, because the measurement `{measurement.name}` does not say what swam.")
    environment = measurement.environment or preset_water(default_water(measurement.gait))
    return Setting(body, measurement.gait, environment)


def _check_one_body(names: Sequence[str], robots: Sequence[Robot], robot: Robot | None) -> None:
    """Refuse trials of another robot: fin, tether and what else is mounted may differ, the body may not."""
    body = robot or robots[0]
    for name, other in zip(names, robots, strict=True):
        if other.modules != body.modules or other.joints != body.joints:
            raise ValueError(
                f"`measurements` must be of one body, with or without fin; `{name}` is of robot `{other.name}`, whose "
                f"modules or joints are not those of `{body.name}`."
            )


def _split(unknown: Unknown, scopes: Sequence[set[str]], known: Sequence[Mapping[str, Parameter]]) -> tuple[str, str]:
    """The scope of an unknown's name and the rest.

    Raises:
        ValueError: If no measurement has such a number.
    """
    name = unknown.name
    if any(name in names for names in known):
        return "", name
    for scope in sorted({scope for some in scopes for scope in some}, key=len, reverse=True):
        rest = name.removeprefix(f"{scope}.")
        if rest != name:
            mine = [names for some, names in zip(scopes, known, strict=True) if scope in some]
            if not any(rest in names for names in mine):
                _refuse(rest, mine, f"for `{scope}`")
            return scope, rest
    _refuse(name, known, "of the measurements' robot and water")
    raise AssertionError


def _refuse(name: str, known: Sequence[Mapping[str, Parameter]], whose: str) -> None:
    every = {key: parameter for names in known for key, parameter in names.items()}
    try:
        look_up(name, every, "parameters")
    except ValueError as err:
        hint = str(err).partition("; the nearest are ")[2]
        side = nearest(name, tuple(SIDE))
        words = f"; the nearest are {hint}" if hint else side or "."
        raise ValueError(f"`parameters` must name numbers {whose}, got {name!r}{words}") from None


def _applies(scope: str, name: str, scopes: set[str], known: Mapping[str, Parameter]) -> bool:
    return name in known and (not scope or scope in scopes)


def _let_the_special_win(moves: np.ndarray, split: Sequence[tuple[str, str]]) -> None:
    """Where a number is looked for in general and for some, the general one leaves those alone."""
    for k, (scope, name) in enumerate(split):
        for j, (other_scope, other) in enumerate(split):
            if j != k and other == name and scope and not other_scope:
                moves[:, j] &= ~moves[:, k]
    for k, (scope, name) in enumerate(split):
        twice = [
            j for j, (_, other) in enumerate(split) if j != k and other == name and (moves[:, j] & moves[:, k]).any()
        ]
        if twice:
            raise ValueError(
                f"`parameters` must say once per measurement what `{name}` is for, got both `{scope}` and "
                f"`{split[twice[0]][0]}`."
            )


def _settled(
    unknown: Unknown,
    scope: str,
    name: str,
    settings: Sequence[Setting],
    known: Sequence[Mapping[str, Parameter]],
    applies: np.ndarray,
) -> Settled:
    """An unknown with everything filled in."""
    if not applies.any():
        raise ValueError(f"`parameters` must leave something to `{unknown.name}`: more special ones take all of it.")
    first = int(np.argmax(applies))
    setting, parameter = settings[first], known[first][name]
    if name.startswith("gait."):
        raise ValueError(
            f"`parameters` must not be of the gait, which is what was asked for, got `{unknown.name}`; what the joints "
            "make of it is the actuator's, `robot.joint.actuator`."
        )
    if parameter.is_whole:
        raise ValueError(f"`parameters` must be numbers that may change a little, got `{unknown.name}`, a count.")
    start = unknown.start
    if start is None:
        start = 0.0 if name in SIDE else value_of(name, *setting, argument="parameters")
        start = start if unknown.lower is None else max(start, unknown.lower)
        start = start if unknown.upper is None else min(start, unknown.upper)
    is_allowed = _rule(name, setting)
    for end, value in (("start", start), ("lower", unknown.lower), ("upper", unknown.upper)):
        if value is not None:
            is_allowed(value, f"`{end}` of `{unknown.name}` must be in the range of the field, got {value:g}")
    may_be_less = name in SIDE or _is_fine(is_allowed, -1e-9 * max(1.0, abs(start)))
    is_log = unknown.scale == "log" if unknown.scale else start > 0.0 and not may_be_less
    if is_log and start <= 0.0:
        raise ValueError(f"`start` of `{unknown.name}` must be > 0 on a log scale, got {start:g}.")
    low, high = (start / RANGE, start * RANGE) if is_log else (-math.inf if may_be_less else 0.0, math.inf)
    lower = _end(is_allowed, start, low) if unknown.lower is None else unknown.lower
    upper = _end(is_allowed, start, high) if unknown.upper is None else unknown.upper
    return Settled(
        name=unknown.name,
        scope=scope,
        parameter=parameter,
        start=start,
        lower=lower,
        upper=upper,
        prior=unknown.prior,
        is_log=is_log,
        size=1.0 if is_log else size_of(unknown, parameter.unit, start),
    )


def _rule(name: str, setting: Setting) -> Callable[[float, str], None]:
    """What raises a ValueError if a value is out of the range of its field."""

    def check(value: float, words: str) -> None:
        if name not in SIDE:
            try:
                changed(*setting, {name: value})
            except ValueError as err:
                raise ValueError(f"{words}: {err}") from None

    return check


def _is_fine(check: Callable[[float, str], None], value: float) -> bool:
    try:
        check(value, "")
    except ValueError:
        return False
    return True


def _end(check: Callable[[float, str], None], inside: float, end: float) -> float:
    """The farthest value towards `end` that the field allows."""
    reach = math.copysign(1e6 * max(1.0, abs(inside)), end) if math.isinf(end) else end
    if _is_fine(check, reach):
        return end
    good, bad = inside, reach
    for _ in range(_HALVINGS):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if _is_fine(check, middle) else (good, middle)
    return good
