"""What a fit leaves behind for predictions: covariance, what was held fixed, and what the model left out.

A `PredictionBasis` is made of a fit once (`basis_of`), kept in the file `fit.json` of its folder,
and read back (`load_basis`). Predictions need nothing else of the measurements (`prediction`).
"""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float

from laticauda.identify.held_fixed import (
    HeldNumber,
    follow_held_numbers,
    list_held_numbers,
    with_numbers,
)
from laticauda.identify.information import invert_information
from laticauda.identify.leaving_out import LeftOut
from laticauda.identify.model import predict
from laticauda.identify.model_error import (
    ModelError,
    measure_error_of_groups,
    measure_model_error,
)
from laticauda.identify.problem import DataBlock, Problem
from laticauda.identify.result import Fit
from laticauda.identify.unknowns import NUISANCE
from laticauda.motion.gaits import Gait
from laticauda.robot import GAITS, Robot
from laticauda.scenarios import Scenario, Start
from laticauda.values import BadArgument, TrialFileError, to_json, to_plain

KEY_OF_BASIS = "prediction"
"""Key of the basis in the file."""
FILE = "fit.json"
"""Name of the file in the folder of an identification."""
KEY_OF_CHECKSUM = "sha256"
"""Key of the SHA-256 of all else in the file."""
SCENARIO_FILE = "scenario.toml"
"""Name of the file with the robot and the water of the first trial, with the fitted values."""
GAIT_NUMBERS = ("amplitude", "frequency", "phase_shift")
"""Numbers of a gait whose measured range is kept."""
_PATH = "center_of_mass"
_VELOCITY = "forward_velocity"


@dataclass(frozen=True, kw_only=True)
class FittedNumber:
    """A number that was fitted."""

    name: str
    """Dotted name, without the scope."""
    scope: str
    """Kind of gait for which it holds; "" for all."""
    value: float
    """Fitted value."""
    is_log: bool
    """Whether its coordinate is its logarithm."""
    tied: Mapping[str, float] = field(default_factory=dict[str, float])
    """Powers of the numbers that follow it, by name."""


@dataclass(frozen=True, kw_only=True)
class LeftOutErrors:
    """How far the model was off in a figure that it did not see."""

    by_measurement: ModelError
    """With one measurement left out at a time."""
    by_group: ModelError | None
    """With one group left out at a time; None: there are too few groups."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A kind of trial that was measured."""

    gait: str
    """Kind of the gait."""
    has_fin: bool
    """Whether the robot had its fin."""

    @classmethod
    def of(cls, robot: Robot, gait: Gait) -> "Setting":
        """Return that of a robot and a gait."""
        return cls(gait=gait.kind, has_fin=robot.caudal_fin is not None)


@dataclass(frozen=True, kw_only=True, eq=False)
class PredictionBasis:
    """All that a prediction with an interval needs to know of a fit."""

    fitted: tuple[FittedNumber, ...]
    """Fitted numbers of robot and water."""
    covariance: Float[np.ndarray, "n_fitted n_fitted"]
    """Covariance of the errors of their coordinates."""
    held_numbers: tuple[HeldNumber, ...]
    """Numbers that were held fixed although they are not known."""
    following: Float[np.ndarray, "n_fitted n_held"]
    """By how much the fitted coordinates follow the numbers held fixed."""
    left_out: Mapping[str, LeftOutErrors]
    """Errors of the model by name of the figure."""
    confidence: float
    """Confidence of the intervals [-]."""
    duration: float
    """Duration of the first trial [s]."""
    settings: tuple[Setting, ...]
    """Kinds of trials that were measured."""
    ranges: Mapping[str, tuple[float, float]]
    """Smallest and largest measured value of a gait's numbers, by name [rad, rad/s]."""
    assumed: tuple[str, ...] = ()
    """What was assumed about the measurements, in sentences."""

    def to_table(self) -> dict[str, Any]:
        """Return this in the form of JSON."""
        table = asdict(self)
        table["covariance"] = self.covariance.tolist()
        table["following"] = self.following.tolist()
        return to_plain(table)

    @classmethod
    def of_table(cls, table: Mapping[str, Any]) -> "PredictionBasis":
        """Return the basis that `to_table` wrote.

        Args:
            table: Its table.

        Raises:
            KeyError, TypeError, ValueError: If it is not such a table.
        """
        fitted = tuple(FittedNumber(**entry) for entry in table["fitted"])
        held_numbers = tuple(HeldNumber(**entry) for entry in table["held_numbers"])
        shape = len(fitted), len(held_numbers)
        return cls(
            fitted=fitted,
            covariance=np.array(table["covariance"], dtype=float).reshape(shape[0], shape[0]),
            held_numbers=held_numbers,
            following=np.array(table["following"], dtype=float).reshape(shape),
            left_out={name: _read_errors(entry) for name, entry in table["left_out"].items()},
            confidence=float(table["confidence"]),
            duration=float(table["duration"]),
            settings=tuple(Setting(**entry) for entry in table["settings"]),
            ranges={name: (low, high) for name, (low, high) in table["ranges"].items()},
            assumed=tuple(table["assumed"]),
        )


def _read_errors(table: Mapping[str, Any]) -> LeftOutErrors:
    by_group = None
    if table["by_group"] is not None:
        by_group = ModelError(**table["by_group"])
    return LeftOutErrors(by_measurement=ModelError(**table["by_measurement"]), by_group=by_group)


def load_basis(folder: str | Path) -> PredictionBasis:
    """Read what `laticauda identify` left behind for predictions.

    Args:
        folder: Folder of an identification.

    Raises:
        TrialFileError: If there is none, or it is damaged, or of an older version.
    """
    file = Path(folder) / FILE
    try:
        results = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        rule = "must be the folder that `laticauda identify` wrote"
        raise TrialFileError(f"{folder}: {rule}; it has no {FILE}.") from None
    except (OSError, ValueError) as error:
        raise TrialFileError(f"{file}: cannot be read: {error}") from None
    if not _is_intact(results):
        reason = "it is damaged: its checksum is wrong; run `laticauda identify` again"
        raise TrialFileError(f"{file}: {reason}.")
    table = _table_of(results)
    if table is None:
        reason = "holds no basis of predictions; run `laticauda identify` again"
        raise TrialFileError(f"{file}: {reason}.")
    try:
        return PredictionBasis.of_table(table)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise TrialFileError(
            f"{file}: `{KEY_OF_BASIS}` is not what laticauda wrote: {error!r}."
        ) from None


def with_checksum(results: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of the file with a checksum of it.

    Args:
        results: Results of an identification, as far as JSON can hold them.
    """
    return {**results, KEY_OF_CHECKSUM: _checksum_of(results)}


def _checksum_of(results: Mapping[str, Any]) -> str:
    """Return the SHA-256 of a file's content, however it is laid out in lines."""
    return hashlib.sha256(to_json(results, None).encode()).hexdigest()


def _is_intact(results: object) -> bool:
    """Return whether what was read from a file has the checksum that stands in it; older files have none."""
    if not isinstance(results, dict):
        return True
    table = cast("dict[str, Any]", results)
    if KEY_OF_CHECKSUM not in table:
        return True
    others = {name: entry for name, entry in table.items() if name != KEY_OF_CHECKSUM}
    return table[KEY_OF_CHECKSUM] == _checksum_of(others)


def _table_of(results: object) -> Mapping[str, Any] | None:
    """Return the table of the basis in what was read from a file; None: there is none."""
    if not isinstance(results, dict):
        return None
    table = cast("dict[str, Any]", results).get(KEY_OF_BASIS)
    if not isinstance(table, dict):
        return None
    return cast("dict[str, Any]", table)


def basis_of(fit: Fit, by_group: LeftOut | None = None) -> PredictionBasis:
    """Return what predictions need to know of a fit; it costs one more derivative of all measurements.

    Args:
        fit: The fit.
        by_group: Predictions by group, from `leave_out`, if there are some.
    """
    problem = fit.problem
    held_numbers = list_held_numbers(problem)
    jacobian, jacobian_of_held = _differentiate(fit, held_numbers)
    residuals_jacobian = np.vstack([jacobian, problem.prior_slopes(fit.best)])
    without_priors = np.zeros((problem.n_priors, len(held_numbers)))
    following = follow_held_numbers(
        residuals_jacobian, np.vstack([jacobian_of_held, without_priors]), problem.sizes
    )
    sigmas = np.array([number.sigma for number in held_numbers])
    unabsorbed = jacobian_of_held + jacobian @ following
    by_held = np.sqrt(np.sum((unabsorbed * sigmas) ** 2, axis=1))
    shown = [
        k for k, unknown in enumerate(problem.unknowns) if unknown.parameter.name not in NUISANCE
    ]
    covariance = fit.covariance[np.ix_(shown, shown)] * _factor_on_covariance(fit)
    return PredictionBasis(
        fitted=tuple(_fitted_number(fit, k) for k in shown),
        covariance=covariance,
        held_numbers=held_numbers,
        following=following[shown],
        left_out=_measure_errors(fit, residuals_jacobian, by_held, by_group),
        confidence=fit.method.confidence,
        duration=problem.scenarios[0].duration,
        settings=_list_settings(problem.scenarios),
        ranges=_ranges_of_gaits(problem.scenarios),
        assumed=list_assumptions(problem),
    )


def first_scenario(fit: Fit) -> Scenario:
    """Return the first trial with the fitted values, straight and at rest at the origin.

    Args:
        fit: The fit.
    """
    scenario = fit.problem.scenarios_at(fit.best)[0]
    return replace(scenario, start=Start())


def list_assumptions(problem: Problem) -> tuple[str, ...]:
    """Return what was assumed about the measurements, in sentences.

    Args:
        problem: Measurements and unknowns.
    """
    sentences = [measurement.assumed for measurement in problem.measurements]
    return tuple(dict.fromkeys(filter(None, sentences)))


def _differentiate(
    fit: Fit, held_numbers: Sequence[HeldNumber]
) -> tuple[Float[np.ndarray, "n_data n_unknowns"], Float[np.ndarray, "n_data n_held"]]:
    """Compute the derivatives of the predictions, in standard deviations of the noise that applies."""
    problem = with_numbers(fit.problem, held_numbers)
    values = np.concatenate([fit.best, [number.value for number in held_numbers]])
    noise = (fit.used_noise_factor * problem.sigma)[:, np.newaxis]
    jacobian = predict(problem, values).jacobian / noise * problem.slopes(values)
    n_unknowns = len(fit.problem.unknowns)
    return jacobian[:, :n_unknowns], jacobian[:, n_unknowns:]


def _factor_on_covariance(fit: Fit) -> float:
    """Return what makes the covariance that of errors that are normal.

    Noise that is known to be smaller than the residuals leaves the rest to the model, whose error
    moves the fitted numbers as noise would. Noise that is estimated makes the errors those of
    Student's t, whose variance is degrees / (degrees - 2).
    """
    degrees = fit.degrees_of_freedom
    if not fit.method.estimates_noise:
        if not math.isfinite(fit.noise_factor):
            return 1.0
        return max(1.0, fit.noise_factor) ** 2
    if degrees <= 2.0:
        return fit.method.quantile(degrees) ** 2 / fit.method.quantile(math.inf) ** 2
    return degrees / (degrees - 2.0)


def _fitted_number(fit: Fit, k: int) -> FittedNumber:
    """Return unknown k of a fit, which must hold for other trials, too.

    Raises:
        ValueError: If it is that of a group or of a single measurement.
    """
    unknown = fit.problem.unknowns[k]
    if unknown.scope and unknown.scope not in GAITS:
        rule = f"must hold for other trials, too, got `{unknown.name}`, of `{unknown.scope}` alone"
        raise BadArgument("fit", rule)
    return FittedNumber(
        name=unknown.parameter.name,
        scope=unknown.scope,
        value=float(fit.best[k]),
        is_log=unknown.is_log,
        tied=dict(unknown.tied),
    )


def _list_settings(scenarios: Sequence[Scenario]) -> tuple[Setting, ...]:
    settings = [Setting.of(scenario.robot, scenario.gait) for scenario in scenarios]
    return tuple(dict.fromkeys(settings))


def _ranges_of_gaits(scenarios: Sequence[Scenario]) -> dict[str, tuple[float, float]]:
    ranges: dict[str, tuple[float, float]] = {}
    for name in GAIT_NUMBERS:
        values = [float(getattr(scenario.gait, name)) for scenario in scenarios]
        ranges[name] = (min(values), max(values))
    return ranges


# ---- how far the model was off -------------------------------------------------------------------


class _Numbers(NamedTuple):
    """What is known of each measured number beside its value and noise."""

    leverage: Float[np.ndarray, " n_data"]
    """Its share in its own fitted value [-]."""
    by_held: Float[np.ndarray, " n_data"]
    """Standard deviation of its residual by the numbers held fixed, in its unit."""


def _measure_errors(
    fit: Fit,
    jacobian: Float[np.ndarray, "n_residuals n_unknowns"],
    by_held: Float[np.ndarray, " n_data"],
    by_group: LeftOut | None,
) -> dict[str, LeftOutErrors]:
    """Return the errors of what was left out by figure; of a path, those of the distance along it."""
    problem = fit.problem
    numbers = _Numbers(
        leverage=_leverage(problem, jacobian),
        by_held=by_held * fit.used_noise_factor * problem.sigma,
    )
    blocks_by_figure: dict[str, list[DataBlock]] = {}
    for block in problem.data_blocks:
        is_above_zero = not block.is_series and problem.observed[block.numbers.start] > 0.0
        if is_above_zero and fit.predictions[block.numbers.start] > 0.0:
            blocks_by_figure.setdefault(block.name, []).append(block)
    errors: dict[str, LeftOutErrors] = {}
    for figure, blocks in blocks_by_figure.items():
        errors[figure] = _errors_of_figure(fit, blocks, numbers, by_group)
    if _VELOCITY not in errors:
        paths = [block for block in problem.data_blocks if block.name == _PATH]
        if paths:
            errors[_VELOCITY] = LeftOutErrors(
                by_measurement=_error_of_paths(fit, paths), by_group=None
            )
    return errors


def _leverage(
    problem: Problem, jacobian: Float[np.ndarray, "n_residuals n_unknowns"]
) -> Float[np.ndarray, " n_data"]:
    """Return the share of each measured number in its own fitted value."""
    scaled = jacobian * problem.sizes
    covariance = invert_information(scaled.T @ scaled)
    data = scaled[: problem.observed.size]
    return np.clip(np.sum((data @ covariance) * data, axis=1), 0.0, 1.0)


def _errors_of_figure(
    fit: Fit,
    blocks: Sequence[DataBlock],
    numbers: _Numbers,
    by_group: LeftOut | None,
) -> LeftOutErrors:
    """Return the errors of one figure, which is above 0 in all blocks."""
    problem = fit.problem
    positions = [block.numbers.start for block in blocks]
    observed = problem.observed[positions]
    leverage = numbers.leverage[positions]
    residuals = np.log(fit.predictions[positions] / observed)
    remaining = np.maximum(1.0 - leverage, np.finfo(float).eps)
    noise = problem.sigma[positions] / observed
    for n, block in enumerate(blocks):
        if problem.measurements[block.owner].assumed:
            noise[n] = 0.0  # nobody stated it: all scatter counts as the model's
    by_held = numbers.by_held[positions] / observed
    explained = np.sqrt(noise**2 + by_held**2 / remaining)
    error_of_groups = None
    if by_group is not None:
        predicted = by_group.predictions[positions]
        groups = {problem.groups[block.owner] for block in blocks}
        if np.all(predicted > 0.0):
            off = np.log(predicted / observed)
            error_of_groups = measure_error_of_groups(off, explained, len(groups))
    return LeftOutErrors(
        by_measurement=measure_model_error(residuals / remaining, leverage, explained),
        by_group=error_of_groups,
    )


def _error_of_paths(fit: Fit, blocks: Sequence[DataBlock]) -> ModelError:
    """Return the errors of the distance from the first to the last sample of each path.

    The paths take part in the fit; each has its share in as many numbers as were fitted.
    """
    problem = fit.problem
    off: list[float] = []
    noise: list[float] = []
    for block in blocks:
        measured = _distance(problem.observed[block.numbers])
        predicted = _distance(fit.predictions[block.numbers])
        off.append(math.log(predicted / measured))
        noise.append(float(math.sqrt(2.0) * block.sigma / measured))
    n_fitted = sum(unknown.parameter.name not in NUISANCE for unknown in problem.unknowns)
    share = min(1.0 - float(np.finfo(float).eps), n_fitted / len(blocks))
    leverage = np.full(len(blocks), share)
    return measure_model_error(np.array(off) / (1.0 - share), leverage, np.array(noise))


def _distance(samples: Float[np.ndarray, " n"]) -> float:
    """Return the distance between the first and the last point of a path."""
    path = samples.reshape(-1, 2)
    return float(np.hypot(*(path[-1] - path[0])))
