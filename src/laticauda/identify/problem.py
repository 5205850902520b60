"""An identification as a value: which measurements, which unknowns, and how they belong together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import compress
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.errors import BadArgument, at_least_one, instance, optional_import
from laticauda.identify import unknowns
from laticauda.identify.measurements import Measurement
from laticauda.identify.unknowns import NUISANCE, SIMULATED, ResolvedUnknown, Unknown
from laticauda.interfaces import Resumed, Start
from laticauda.quantities import several
from laticauda.robot import Robot
from laticauda.scenarios import Model, Scenario, model_of
from laticauda.simulate.numbers import Parameter, changed

_RARE = 5e-4  # of all cases a chi^2 is below its range, and above it
SAMPLE_INTERVAL = 0.05  # of the logs that series are interpolated from [s]


class Place(NamedTuple):
    """Where a measured figure, or a measured series, stands among the data."""

    owner: int
    """Number of its measurement."""
    what: str
    """Name of the figure or series."""
    is_series: bool
    """Which of the two."""
    at: slice
    """Its numbers."""
    sigma: float
    """Standard deviation of the noise of each."""

    @property
    def size(self) -> int:
        """How many they are."""
        return self.at.stop - self.at.start


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """Measurements and unknowns that fit together; made by `make_problem`."""

    measurements: tuple[Measurement, ...]
    """What was measured; the scenario of each has the model by which all of them are simulated."""
    unknowns: tuple[ResolvedUnknown, ...]
    """What is looked for."""
    moves: Bool[np.ndarray, "n_measurements n_unknowns"]
    """Whether a measurement depends on an unknown."""
    threads: int | None
    """How many compute."""

    @cached_property
    def places(self) -> tuple[Place, ...]:
        """Where every figure and every series stands among the data: measurement by measurement, its figures first."""
        found: list[Place] = []
        at = 0
        for owner, one in enumerate(self.measurements):
            for is_series, every in enumerate((one.figures, one.series)):
                for name, (values, sigma) in every.items():
                    here = slice(at, at + np.size(values))
                    found.append(Place(owner, name, bool(is_series), here, sigma))
                    at = here.stop
        return tuple(found)

    @cached_property
    def observed(self) -> Float[np.ndarray, " n_data"]:
        """All measured numbers in the order of `places`; without the bias of selection."""
        parts: list[Any] = []
        for one in self.places:
            m = self.measurements[one.owner]
            parts.append(m.series[one.what][0].ravel() if one.is_series else [m.without_bias(one.what)])
        return np.concatenate(parts)

    @cached_property
    def sigma(self) -> Float[np.ndarray, " n_data"]:
        """Standard deviation of the noise of each."""
        return np.concatenate([np.full(one.size, one.sigma) for one in self.places])

    @cached_property
    def owner(self) -> Int[np.ndarray, " n_data"]:
        """Number of the measurement that each belongs to."""
        return np.concatenate([np.full(one.size, one.owner) for one in self.places])

    @cached_property
    def scenarios(self) -> tuple[Scenario, ...]:
        """By measurement: what it is simulated with, apart from what is identified."""
        return tuple(one.scenario for one in self.measurements)

    @property
    def groups(self) -> tuple[str, ...]:
        """By measurement: the name of its group."""
        return tuple(one.group for one in self.measurements)

    @property
    def model(self) -> Model:
        """By which model all of them are simulated."""
        return self.scenarios[0].model

    @property
    def names(self) -> tuple[str, ...]:
        """Of the unknowns."""
        return tuple(unknown.name for unknown in self.unknowns)

    @property
    def start(self) -> Float[np.ndarray, " n_unknowns"]:
        """Where the search begins, as values."""
        return np.array([unknown.start for unknown in self.unknowns])

    @property
    def sizes(self) -> Float[np.ndarray, " n_unknowns"]:
        """What is a large change of each coordinate."""
        return np.array([unknown.size for unknown in self.unknowns])

    @property
    def of_interest(self) -> list[int]:
        """Numbers of the unknowns that figures and tables show: all but where single trials began."""
        return [k for k, one in enumerate(self.unknowns) if not one.parameter.name.startswith("start.")]

    @property
    def without_starts(self) -> "Problem":
        """The same without unknowns of where single trials began."""
        keep = self.of_interest
        return replace(self, unknowns=tuple(self.unknowns[k] for k in keep), moves=self.moves[:, keep])

    def values_of(self, x: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """The values of coordinates."""
        return np.array([unknown.value(float(at)) for unknown, at in zip(self.unknowns, x, strict=True)])

    def named(self, x: Float[np.ndarray, " n_unknowns"]) -> dict[str, float]:
        """The values of coordinates by name."""
        return dict(zip(self.names, self.values_of(x).tolist(), strict=True))

    def x_of(self, values: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """The coordinates of values."""
        return np.array([unknown.x(float(value)) for unknown, value in zip(self.unknowns, values, strict=True)])

    def slopes(self, values: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """dq/dx of every unknown."""
        return np.array([unknown.slope(float(value)) for unknown, value in zip(self.unknowns, values, strict=True)])

    def prior_residuals(self, values: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_priors"]:
        """What the priors add to the residuals."""
        pairs = [(value, unknown.prior) for value, unknown in zip(values, self.unknowns, strict=True)]
        return np.array([(value - prior[0]) / prior[1] for value, prior in pairs if prior is not None])

    def prior_slopes(self, values: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, "n_priors n_unknowns"]:
        """The derivatives of those to the coordinates."""
        found = [
            np.eye(len(self.unknowns))[k] * unknown.slope(float(values[k])) / unknown.prior[1]
            for k, unknown in enumerate(self.unknowns)
            if unknown.prior is not None
        ]
        return np.reshape(found, (len(found), len(self.unknowns)))

    def information(self, jacobian: Float[np.ndarray, "n_residuals n_unknowns"]) -> Float[np.ndarray, "n n"]:
        """J^T J of the data alone, without the rows of the priors, which come after those of the data."""
        data = jacobian[: self.observed.size]
        return data.T @ data

    def part(self, members: Sequence[int]) -> "Problem":
        """The same with some of its measurements only, by number; the unknowns stay, whether seen or not."""
        return replace(self, measurements=tuple(self.measurements[i] for i in members), moves=self.moves[list(members)])

    def scenarios_at(self, values: Float[np.ndarray, " n_unknowns"]) -> tuple[Scenario, ...]:
        """What each measurement is simulated with at these values; what is alike stays one object."""
        made: dict[object, Scenario] = {}
        found: list[Scenario] = []
        for i, scenario in enumerate(self.scenarios):
            start, wanted = scenario.start, dict[str, float]()
            for unknown, value, moves in zip(self.unknowns, values, self.moves[i], strict=True):
                name = unknown.parameter.name
                if moves and name in SIMULATED:
                    start = shifted(start, name, float(value))
                elif moves and name not in NUISANCE:
                    wanted |= unknowns.with_tied(scenario, name, float(value), unknown.tied)
            key = id(scenario.robot), id(scenario.environment), tuple(wanted.items())
            if key not in made:
                made[key] = changed(scenario, wanted)
            body = made[key]
            found.append(replace(body, motion=scenario.motion, start=start, duration=scenario.duration))
        return tuple(found)

    def nuisance(self, i: int, values: np.ndarray) -> dict[str, Any]:
        """The values of `NUISANCE` for a measurement, as far as they are identified."""
        return {
            unknown.parameter.name: values[k]
            for k, unknown in enumerate(self.unknowns)
            if self.moves[i, k] and unknown.parameter.name in NUISANCE
        }


def make_problem(
    measurements: Sequence[Measurement],
    wanted: Sequence["str | Unknown"] | Mapping[str, tuple[float, float]],
    robot: Robot | None = None,
    *,
    threads: int | None = None,
    **changes: Any,
) -> Problem:
    """Bring measurements and unknowns together, and check that they fit.

    Args:
        measurements: At least one, no name twice.
        wanted: What is looked for.
        robot: What has to have swum, with or without its fin; None: what the first measurement says.
        threads: How many compute.
        changes: Of the models of all scenarios, see `laticauda.scenarios.ModelChanges`, and `model`.

    Raises:
        ValueError: If they do not.
    """
    given = _checked(measurements)
    _check_one_body(given, robot or given[0].scenario.robot)
    given = _by_one_model(given, _common_model(given, **changes))
    scenarios = tuple(one.scenario for one in given)
    known = unknowns.known_numbers(scenarios)
    scopes = [{m.scenario.gait.kind, m.group, m.name} for m in given]
    asked = unknowns.as_unknowns(wanted)
    names = [unknowns.split_name(unknown, scopes, known) for unknown in asked]
    moves = dependence(names, scopes, known)
    seen = [[*compress(zip(scenarios, known, strict=True), moved)] for moved in moves.T]
    resolved = tuple(unknowns.resolve(one, *name, of) for one, name, of in zip(asked, names, seen, strict=True))
    return with_starts(Problem(measurements=given, unknowns=resolved, moves=moves, threads=threads))


def with_starts(problem: Problem) -> Problem:
    """The same with where every trial began among the unknowns, as far as nobody looks for it already.

    Args:
        problem: Measurements and unknowns.
    """
    added: list[tuple[int, ResolvedUnknown]] = []
    for i, one in enumerate(problem.measurements):
        known = {unknown.parameter.name for k, unknown in enumerate(problem.unknowns) if problem.moves[i, k]}
        for name, prior in one.starts.items():
            what: Any = {"parameter": NUISANCE[name], "start": 0.0, "prior": prior, "is_log": False, "size": 0.1}
            if name not in known:
                added.append((i, ResolvedUnknown(name=f"{one.name}.{name}", scope=one.name, **what)))
    own = np.array([[i == j for j, _ in added] for i in range(len(problem.measurements))], dtype=bool)
    every = (*problem.unknowns, *(unknown for _, unknown in added))
    return replace(problem, unknowns=every, moves=np.hstack([problem.moves, own]))


def other_measurements(problem: Problem, measurements: Sequence[Measurement]) -> Problem:
    """The same unknowns, seen by other measurements, of which no number counts.

    Args:
        problem: The unknowns.
        measurements: Whatever their names are; unknowns of single measurements are none of theirs.
    """
    renamed = [replace(m, name=f"{i}: {m.name}") for i, m in enumerate(measurements)]
    others = _by_one_model(renamed, problem.model)
    scenarios = [one.scenario for one in others]
    names = [(unknown.scope, unknown.parameter.name) for unknown in problem.unknowns]
    moves = dependence(names, [{one.gait.kind} for one in scenarios], unknowns.known_numbers(scenarios))
    return replace(problem, measurements=others, moves=moves)


def _by_one_model(measurements: Sequence[Measurement], model: Model) -> tuple[Measurement, ...]:
    how: Any = {"model": model, "sample_interval": SAMPLE_INTERVAL}
    return tuple(replace(one, scenario=replace(one.scenario, **how)) for one in measurements)


def dependence(
    split: Sequence[tuple[str, str]], scopes: Sequence[set[str]], known: Sequence[Mapping[str, Parameter]]
) -> Bool[np.ndarray, "n_measurements n_unknowns"]:
    """Which measurements depend on which unknowns.

    Where a number is looked for in general and for some, the general one leaves those alone.

    Args:
        split: By unknown, its scope and its name without that.
        scopes: By measurement, what it may be called.
        known: By measurement, the numbers that it has.

    Raises:
        ValueError: If two unknowns are the same number of a measurement.
    """
    moves = np.array(
        [
            [name in numbers and (not scope or scope in mine) for scope, name in split]
            for mine, numbers in zip(scopes, known, strict=True)
        ]
    ).reshape(len(known), len(split))
    for k, (scope, name) in enumerate(split):
        for j, (other_scope, other) in enumerate(split):
            if j != k and other == name and scope and not other_scope:
                moves[:, j] &= ~moves[:, k]
    for k, (scope, name) in enumerate(split):
        twice = [j for j, (_, other) in enumerate(split) if j != k and other == name and any(moves[:, j] & moves[:, k])]
        if twice:
            raise BadArgument(
                "parameters",
                f"must say once per measurement what `{name}` is for, got both `{scope}` and `{split[twice[0]][0]}`",
            )
    return moves


def shifted(start: Start | Resumed, name: str, value: float) -> Start:
    """A start with one number added: identified starts are what is to be added to the stated ones.

    Args:
        start: As it is stated.
        name: Of the number, one of `SIMULATED`.
        value: What is added.
    """
    assert isinstance(start, Start)  # as measurements check
    field = name.removeprefix("start.")
    return replace(start, **{field: getattr(start, field) + value})


def _common_model(measurements: Sequence[Measurement], model: Model | str | None = None, **changes: Any) -> Model:
    """The model that all measurements are simulated with."""
    models = [model_of(model or m.scenario.model, **changes) for m in measurements]
    for measurement, one in zip(measurements, models, strict=True):
        if one != models[0]:
            raise BadArgument("measurements", f"must be of one model, got another one in `{measurement.name}`")
    return models[0]


def _checked(measurements: Sequence[Measurement]) -> tuple[Measurement, ...]:
    every = several(lambda name, one: instance(name, one, Measurement), "a list", (), "measurements", measurements)
    at_least_one("measurements", every, "Measurement")
    names = [measurement.name for measurement in every]
    for name in names:
        if names.count(name) > 1:
            raise BadArgument("measurements", f"must have different names, got `{name}` twice")
    return every


def _check_one_body(measurements: Sequence[Measurement], body: Robot) -> None:
    """Refuse trials of another robot: fin, tether and what else is mounted may differ, the body may not."""
    for measurement in measurements:
        other = measurement.scenario.robot
        if other.modules != body.modules or other.joints != body.joints:
            rule = f"must be of one body, with or without fin; `{measurement.name}` is of robot `{other.name}`"
            raise BadArgument("measurements", f"{rule}, whose modules or joints are not those of `{body.name}`")


def warnings_of(problem: Problem, chi2: float, degrees: float, lags: Mapping[str, float], widening: float) -> list[str]:
    """What is odd about measurements and fit, though nothing is wrong; a sentence each.

    Args:
        problem: Measurements and unknowns.
        chi2: Of data and priors, in the noise as stated; nan if that is estimated [-].
        degrees: Of freedom [-].
        lags: Correlation of the noise from sample to sample, of series that show one [-].
        widening: How many times as wide it makes the widest interval [-].
    """
    found: list[str] = []
    special = optional_import("Identification", "scipy", "identify", "scipy.special")
    square = max(lags.values(), default=0.0) ** 2
    share = (1.0 - square) / (1.0 + square)  # with such noise chi^2 scatters as if there were so many fewer numbers
    half = 0.5 * share * max(degrees, 1.0)
    low, high = (2.0 * special.gammaincinv(half, end) / share for end in (_RARE, 1.0 - _RARE))
    if degrees > 0.0 and (chi2 < low or chi2 > high):
        found.append(
            f"chi^2 out of range: {chi2:.4g} at {degrees:.0f} degrees of freedom, where the stated noise gives "
            f"{low:.4g} to {high:.4g} in 99.9 % of all cases: it or the model is wrong, and the intervals with it."
        )
    if lags:
        words = ", ".join(f"{lag:.2f} ({name})" for name, lag in lags.items())
        found.append(
            f"correlated residuals: from sample to sample the noise has a correlation of {words}; intervals are up to "
            f"{widening:.2g} times as wide for it."
        )
    frictions = [one.name for one in problem.unknowns if one.parameter.name.endswith("tangential_friction")]
    if frictions and not any(one.coasts for one in problem.measurements):
        found.append(
            f"no coast-down: `{frictions[0]}` makes up for whatever the model lacks of thrust and drag; it is the "
            "water's only where a straight robot that coasts is among the data."
        )
    gaits = {(s.gait, s.robot.caudal_fin, s.environment) for s in problem.scenarios}
    if len(gaits) == 1 and len(problem.scenarios) > 1:
        found.append("All measurements are of the same gait with the same robot: they are one measurement, repeated.")
    return found
