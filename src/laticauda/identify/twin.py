"""What the 3D twin says about measurements: trial by trial, with differences for derivatives."""

import numpy as np

from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.identify.seeing import SAMPLE_INTERVAL, Raw, Values, interpolated, seen, starts_of
from laticauda.simulate.runner import Progress
from laticauda.simulate.swimming import swim
from laticauda.trial import Trial

DIFFERENCE = 1e-3  # a step of the differences, as a share of what is a large change


def by_differences(
    problem: Problem, values: Values, jacobian: bool, progress: Progress | None
) -> tuple[np.ndarray, np.ndarray | None, dict[str, str]]:
    """Predictions, their Jacobian by central differences if asked for, what diverged; arguments as for `predict`."""
    total = 1 + 2 * len(problem.unknowns) * jacobian
    predicted, failures = _in_space(problem, values)
    columns: list[np.ndarray] = []
    for k, unknown in enumerate(problem.unknowns if jacobian else ()):
        step = DIFFERENCE * unknown.slope(float(values[k])) * unknown.size
        ends = np.clip(values[k] + np.array([-step, step]), unknown.lower, unknown.upper)
        moved = np.repeat(values[np.newaxis], 2, axis=0)
        moved[:, k] = ends
        behind, ahead = (_in_space(problem, at)[0] for at in moved)
        columns.append((ahead - behind) / (ends[1] - ends[0]))
        if progress is not None:
            progress((3 + 2 * k) / total)
    return predicted, np.stack(columns, axis=1) if jacobian else None, failures


def _in_space(problem: Problem, values: Values) -> tuple[np.ndarray, dict[str, str]]:
    starts, failures = starts_of(problem, values), dict[str, str]()
    parts: list[np.ndarray] = []
    for i, setting in enumerate(problem.apply(values)):
        measurement = problem.measurements[i]
        trial = swim(
            setting.robot,
            setting.gait,
            measurement.duration,
            environment=setting.environment,
            model="spatial",
            start=starts[i],
            sample_interval=SAMPLE_INTERVAL,
            **problem.options,
        )
        if trial.succeeded:
            parts.append(seen(measurement, _raw_of(trial, measurement), problem.side(i, values)))
        else:
            failures[measurement.name] = trial.status
            parts.append(np.full(int(np.sum(problem.owner == i)), np.nan))
    return np.concatenate(parts), failures


def _raw_of(trial: Trial, measurement: Measurement) -> Raw:
    """What a trial gave, in the plane."""
    end = trial.center_of_mass[-1]
    raw: Raw = {"x": end[0], "y": end[1], "heading": trial.heading[-1]}
    raw |= {name: getattr(trial, name) for name in measurement.figures if name not in raw}
    if measurement.time is not None:
        for name in dict.fromkeys(("heading", *measurement.series)):
            values = getattr(trial, name)
            values = values[:, :2] if name == "center_of_mass" else values
            raw[f"{name} series"] = interpolated(trial.time, values, measurement.time)
    return raw
