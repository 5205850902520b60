"""Identification problem: the measurements, the unknowns, and the dependence between them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import compress
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.identify import unknowns
from laticauda.identify.measurements import Measurement
from laticauda.identify.unknowns import NUISANCE, SIMULATED, ResolvedUnknown, Unknown
from laticauda.models.simulate.numbers import Parameter, change_parameters
from laticauda.robot import Robot
from laticauda.scenarios import Model, Scenario, model_of
from laticauda.scenarios.interfaces import Resumed, Start
from laticauda.values.checks import check_instance, check_not_empty
from laticauda.values.errors import BadArgument
from laticauda.values.optional import optional_import
from laticauda.values.quantities import check_items

_RARE = 5e-4  # probability that chi^2 is below its range, and that it is above
SAMPLE_INTERVAL = 0.05  # of the logs that series are interpolated from [s]


class Place(NamedTuple):
    """Position of a measured figure or series in the data."""

    owner: int
    """Index of its measurement."""
    what: str
    """Name of the figure or series."""
    is_series: bool
    """Whether it is a series."""
    at: slice
    """Slice of the data that holds its numbers."""
    sigma: float
    """Standard deviation of the noise of each number."""

    @property
    def size(self) -> int:
        """Number of its data."""
        return self.at.stop - self.at.start


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """Measurements and unknowns that match; created by `make_problem`."""

    measurements: tuple[Measurement, ...]
    """The measurements; the scenario of each has the model with which all of them are simulated."""
    unknowns: tuple[ResolvedUnknown, ...]
    """Unknowns to be identified."""
    moves: Bool[np.ndarray, "n_measurements n_unknowns"]
    """Whether each measurement depends on each unknown."""
    threads: int | None
    """Number of threads."""

    @cached_property
    def places(self) -> tuple[Place, ...]:
        """Positions of all figures and series in the data, measurement by measurement, figures first."""
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
        """All measured numbers in the order of `places`, without the selection bias."""
        parts: list[Any] = []
        for one in self.places:
            m = self.measurements[one.owner]
            parts.append(
                m.series[one.what][0].ravel() if one.is_series else [m.without_bias(one.what)]
            )
        return np.concatenate(parts)

    @cached_property
    def sigma(self) -> Float[np.ndarray, " n_data"]:
        """Standard deviation of the noise of each measured number."""
        return np.concatenate([np.full(one.size, one.sigma) for one in self.places])

    @cached_property
    def owner(self) -> Int[np.ndarray, " n_data"]:
        """Index of the measurement to which each measured number belongs."""
        return np.concatenate([np.full(one.size, one.owner) for one in self.places])

    @cached_property
    def scenarios(self) -> tuple[Scenario, ...]:
        """Scenario with which each measurement is simulated, apart from the identified values."""
        return tuple(one.scenario for one in self.measurements)

    @property
    def groups(self) -> tuple[str, ...]:
        """Name of the group of each measurement."""
        return tuple(one.group for one in self.measurements)

    @property
    def model(self) -> Model:
        """Model with which all measurements are simulated."""
        return self.scenarios[0].model

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return tuple(unknown.name for unknown in self.unknowns)

    @property
    def start(self) -> Float[np.ndarray, " n_unknowns"]:
        """Values at which the search starts."""
        return np.array([unknown.start for unknown in self.unknowns])

    @property
    def sizes(self) -> Float[np.ndarray, " n_unknowns"]:
        """Size of a large change of each coordinate."""
        return np.array([unknown.size for unknown in self.unknowns])

    @property
    def of_interest(self) -> list[int]:
        """Indices of the unknowns shown in figures and tables: all but the start states of single trials."""
        return [
            k for k, one in enumerate(self.unknowns) if not one.parameter.name.startswith("start.")
        ]

    @property
    def without_starts(self) -> "Problem":
        """The same problem without the unknown start states of single trials."""
        keep = self.of_interest
        return replace(
            self, unknowns=tuple(self.unknowns[k] for k in keep), moves=self.moves[:, keep]
        )

    def values_of(self, x: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """Return the values at given coordinates."""
        return np.array(
            [unknown.value(float(at)) for unknown, at in zip(self.unknowns, x, strict=True)]
        )

    def named(self, x: Float[np.ndarray, " n_unknowns"]) -> dict[str, float]:
        """Return the values at given coordinates by name."""
        return dict(zip(self.names, self.values_of(x).tolist(), strict=True))

    def x_of(self, values: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """Return the coordinates of given values."""
        return np.array(
            [unknown.x(float(value)) for unknown, value in zip(self.unknowns, values, strict=True)]
        )

    def slopes(self, values: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """Return dq/dx of every unknown."""
        return np.array(
            [
                unknown.slope(float(value))
                for unknown, value in zip(self.unknowns, values, strict=True)
            ]
        )

    def prior_residuals(
        self, values: Float[np.ndarray, " n_unknowns"]
    ) -> Float[np.ndarray, " n_priors"]:
        """Return the residuals of the priors."""
        pairs = [
            (value, unknown.prior) for value, unknown in zip(values, self.unknowns, strict=True)
        ]
        return np.array(
            [(value - prior[0]) / prior[1] for value, prior in pairs if prior is not None]
        )

    def prior_slopes(
        self, values: Float[np.ndarray, " n_unknowns"]
    ) -> Float[np.ndarray, "n_priors n_unknowns"]:
        """Return the derivatives of the prior residuals with respect to the coordinates."""
        found = [
            np.eye(len(self.unknowns))[k] * unknown.slope(float(values[k])) / unknown.prior[1]
            for k, unknown in enumerate(self.unknowns)
            if unknown.prior is not None
        ]
        return np.reshape(found, (len(found), len(self.unknowns)))

    def information(
        self, jacobian: Float[np.ndarray, "n_residuals n_unknowns"]
    ) -> Float[np.ndarray, "n n"]:
        """Return J^T J of the data alone, without the rows of the priors, which follow those of the data."""
        data = jacobian[: self.observed.size]
        return data.T @ data

    def part(self, members: Sequence[int]) -> "Problem":
        """Return the problem with only the measurements of these indices; all unknowns stay, whether seen or not."""
        return replace(
            self,
            measurements=tuple(self.measurements[i] for i in members),
            moves=self.moves[list(members)],
        )

    def scenarios_at(self, values: Float[np.ndarray, " n_unknowns"]) -> tuple[Scenario, ...]:
        """Return the scenario of each measurement at the given values; equal parts stay one object."""
        made: dict[object, Scenario] = {}
        found: list[Scenario] = []
        for i, scenario in enumerate(self.scenarios):
            start, wanted = scenario.start, dict[str, float]()
            for unknown, value, moves in zip(self.unknowns, values, self.moves[i], strict=True):
                name = unknown.parameter.name
                if moves and name in SIMULATED:
                    start = shift_start(start, name, float(value))
                elif moves and name not in NUISANCE:
                    wanted |= unknowns.with_tied(scenario, name, float(value), unknown.tied)
            key = id(scenario.robot), id(scenario.environment), tuple(wanted.items())
            if key not in made:
                made[key] = change_parameters(scenario, wanted)
            body = made[key]
            found.append(
                replace(body, motion=scenario.motion, start=start, duration=scenario.duration)
            )
        return tuple(found)

    def nuisance(self, i: int, values: np.ndarray) -> dict[str, Any]:
        """Return the values of those `NUISANCE` parameters of a measurement that are identified."""
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
    """Combine measurements and unknowns into a problem, and check that they match.

    Args:
        measurements: At least one, with different names.
        wanted: Unknowns to be identified.
        robot: Robot that must have swum, with or without its fin; None: that of the first
            measurement.
        threads: Number of threads.
        changes: Changes of the models of all scenarios (see `laticauda.scenarios.ModelChanges`),
            and `model`.

    Raises:
        ValueError: If they do not match.
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
    resolved = tuple(
        unknowns.resolve(one, *name, of) for one, name, of in zip(asked, names, seen, strict=True)
    )
    return with_starts(Problem(measurements=given, unknowns=resolved, moves=moves, threads=threads))


def with_starts(problem: Problem) -> Problem:
    """Return the problem with the start state of every trial among the unknowns, where it is not one already.

    Args:
        problem: Measurements and unknowns.
    """
    added: list[tuple[int, ResolvedUnknown]] = []
    for i, one in enumerate(problem.measurements):
        known = {
            unknown.parameter.name
            for k, unknown in enumerate(problem.unknowns)
            if problem.moves[i, k]
        }
        for name, prior in one.starts.items():
            what: Any = {
                "parameter": NUISANCE[name],
                "start": 0.0,
                "prior": prior,
                "is_log": False,
                "size": 0.1,
            }
            if name not in known:
                added.append(
                    (i, ResolvedUnknown(name=f"{one.name}.{name}", scope=one.name, **what))
                )
    own = np.array(
        [[i == j for j, _ in added] for i in range(len(problem.measurements))], dtype=bool
    )
    every = (*problem.unknowns, *(unknown for _, unknown in added))
    return replace(problem, unknowns=every, moves=np.hstack([problem.moves, own]))


def other_measurements(problem: Problem, measurements: Sequence[Measurement]) -> Problem:
    """Return a problem with the same unknowns and other measurements, whose measured numbers are not used.

    Args:
        problem: Provides the unknowns.
        measurements: The other measurements, with any names; unknowns of single measurements do not
            apply to them.
    """
    renamed = [replace(m, name=f"{i}: {m.name}") for i, m in enumerate(measurements)]
    others = _by_one_model(renamed, problem.model)
    scenarios = [one.scenario for one in others]
    names = [(unknown.scope, unknown.parameter.name) for unknown in problem.unknowns]
    moves = dependence(
        names, [{one.gait.kind} for one in scenarios], unknowns.known_numbers(scenarios)
    )
    return replace(problem, measurements=others, moves=moves)


def _by_one_model(measurements: Sequence[Measurement], model: Model) -> tuple[Measurement, ...]:
    how: Any = {"model": model, "sample_interval": SAMPLE_INTERVAL}
    return tuple(replace(one, scenario=replace(one.scenario, **how)) for one in measurements)


def dependence(
    split: Sequence[tuple[str, str]],
    scopes: Sequence[set[str]],
    known: Sequence[Mapping[str, Parameter]],
) -> Bool[np.ndarray, "n_measurements n_unknowns"]:
    """Determine which measurements depend on which unknowns.

    If a number is identified both in general and for a scope, the general one does not apply to
    that scope.

    Args:
        split: Scope of each unknown, and its name without the scope.
        scopes: Scopes to which each measurement belongs.
        known: Numbers of each measurement, by name.

    Raises:
        ValueError: If two unknowns stand for the same number of a measurement.
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
        twice = [
            j
            for j, (_, other) in enumerate(split)
            if j != k and other == name and any(moves[:, j] & moves[:, k])
        ]
        if twice:
            raise BadArgument(
                "parameters",
                f"must list `{name}` once per measurement at most, got both `{scope}` and `{split[twice[0]][0]}`",
            )
    return moves


def shift_start(start: Start | Resumed, name: str, value: float) -> Start:
    """Return a start with one number shifted: identified starts are offsets from the stated ones.

    Args:
        start: Start as stated.
        name: Name of the number, one of `SIMULATED`.
        value: Offset to add.
    """
    assert isinstance(start, Start)  # ensured by the measurements
    field = name.removeprefix("start.")
    return replace(start, **{field: getattr(start, field) + value})


def _common_model(
    measurements: Sequence[Measurement], model: Model | str | None = None, **changes: Any
) -> Model:
    """Return the model with which all measurements are simulated."""
    models = [model_of(model or m.scenario.model, **changes) for m in measurements]
    for measurement, one in zip(measurements, models, strict=True):
        if one != models[0]:
            raise BadArgument(
                "measurements", f"must all be of one model, got another one in `{measurement.name}`"
            )
    return models[0]


def _checked(measurements: Sequence[Measurement]) -> tuple[Measurement, ...]:
    every = check_items(
        lambda name, one: check_instance(name, one, Measurement),
        "a list",
        (),
        "measurements",
        measurements,
    )
    check_not_empty("measurements", every, "Measurement")
    names = [measurement.name for measurement in every]
    for name in names:
        if names.count(name) > 1:
            raise BadArgument("measurements", f"must have different names, got `{name}` twice")
    return every


def _check_one_body(measurements: Sequence[Measurement], body: Robot) -> None:
    """Reject trials of another robot: the fin, tether and other mounted parts may differ, the body may not."""
    for measurement in measurements:
        other = measurement.scenario.robot
        if other.modules != body.modules or other.joints != body.joints:
            rule = f"must be of one body, with or without fin; `{measurement.name}` is of robot `{other.name}`"
            raise BadArgument(
                "measurements", f"{rule}, whose modules or joints are not those of `{body.name}`"
            )


def warnings_of(
    problem: Problem, chi2: float, degrees: float, lags: Mapping[str, float], widening: float
) -> list[str]:
    """Return a sentence for everything unusual, though not invalid, about the measurements and the fit.

    Args:
        problem: Measurements and unknowns.
        chi2: Chi^2 of data and priors, for the noise as stated; nan if that is estimated [-].
        degrees: Degrees of freedom [-].
        lags: Sample-to-sample correlation of the noise, for series that show one [-].
        widening: Largest factor by which this correlation widens an interval [-].
    """
    found: list[str] = []
    special = optional_import("Identification", "scipy", "identify", "scipy.special")
    square = max(lags.values(), default=0.0) ** 2
    share = (1.0 - square) / (
        1.0 + square
    )  # with such noise, chi^2 scatters as for this fraction of the numbers
    half = 0.5 * share * max(degrees, 1.0)
    low, high = (2.0 * special.gammaincinv(half, end) / share for end in (_RARE, 1.0 - _RARE))
    if degrees > 0.0 and (chi2 < low or chi2 > high):
        found.append(
            f"chi^2 out of range: {chi2:.4g} at {degrees:.0f} degrees of freedom, where the stated noise gives "
            f"{low:.4g} to {high:.4g} in 99.9 % of all cases: it or the model is wrong, and so are the intervals."
        )
    if lags:
        words = ", ".join(f"{lag:.2f} ({name})" for name, lag in lags.items())
        found.append(
            f"correlated residuals: the noise has a sample-to-sample correlation of {words}, which widens intervals by "
            f"a factor of up to {widening:.2g}."
        )
    frictions = [
        one.name for one in problem.unknowns if one.parameter.name.endswith("tangential_friction")
    ]
    if frictions and not any(one.coasts for one in problem.measurements):
        found.append(
            f"no coast-down: `{frictions[0]}` makes up for any thrust or drag that the model lacks; it belongs to the "
            "water only if a straight coasting robot is among the data."
        )
    gaits = {(s.gait, s.robot.caudal_fin, s.environment) for s in problem.scenarios}
    if len(gaits) == 1 and len(problem.scenarios) > 1:
        found.append(
            "All measurements are of the same gait with the same robot: they are one measurement, repeated."
        )
    return found
