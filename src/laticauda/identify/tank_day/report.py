"""Results of a tank day as text, as plain values, and as files that another lab can read."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from laticauda.identify.result import Fit
from laticauda.identify.tank_day.evaluation import Evaluation
from laticauda.identify.tank_day.folder import DAY, Day
from laticauda.values import files, packaging

IDENTIFIED = "{value:.4g} ({low:.4g} to {high:.4g}) {unit}"
"""Form of an identified number."""


def format_evaluation(evaluation: Evaluation) -> str:
    """Format an evaluation as readable text.

    Args:
        evaluation: Evaluation from `evaluate`.
    """
    best_law = next(iter(evaluation.fits))
    lines = [*evaluation.verdict, "", f"With `{best_law}`, and 95 % intervals:"]
    for row in evaluation.numbers:
        number = "not identified"
        if row["value"] is not None:
            number = IDENTIFIED.format(**row)
        lines.append(f"{row['name']:<30} {number}")
    return "\n".join(lines)


def write_result(folder: Path, day: Day, evaluation: Evaluation) -> list[str]:
    """Write files that another lab can read: trials, robot, loads, parameter file and summary.

    Args:
        folder: Folder of the tank day; the files go to its subfolder `result`.
        day: Contents of the folder, from `load_day`.
        evaluation: Evaluation from `evaluate`.

    Returns:
        Names of the files.

    Raises:
        StorageFailed: If they cannot be written.
    """
    result_folder = folder / "result"
    result_folder.mkdir(exist_ok=True)
    for name, trial in day.trials.items():
        trial.save(result_folder / f"{name}.nc")
    for name in (DAY, "robot.toml", "tows.csv"):
        files.write(result_folder / name, (folder / name).read_bytes())
    best = next(iter(evaluation.fits.values()))
    parameters = best.parameters("tank-day", f"{day.robot.name}, tank day")
    if evaluation.joints is not None:
        joints = evaluation.joints
        identified_law = joints.problem.scenarios_at(joints.best)[0].model.joints
        parameters = replace(parameters, joints=identified_law)
    parameters.save(result_folder / "parameters.toml")
    files.write(result_folder / "summary.md", format_evaluation(evaluation) + "\n")
    summary = files.to_json(tabulate_evaluation(evaluation))
    files.write(result_folder / "summary.json", summary + "\n")
    return sorted(file.name for file in result_folder.iterdir())


def tabulate_evaluation(evaluation: Evaluation) -> dict[str, Any]:
    """Return an evaluation as plain values.

    Args:
        evaluation: Evaluation from `evaluate`.
    """
    laws = {
        name: _tabulate_law(fit, evaluation.odds[name]) for name, fit in evaluation.fits.items()
    }
    return {
        "laws": laws,
        "numbers": list(evaluation.numbers),
        "verdict": list(evaluation.verdict),
        "version": packaging.__version__,
    }


def _tabulate_law(fit: Fit, odds_against: float) -> dict[str, Any]:
    table = fit.table()
    return {
        "odds_against": odds_against,
        "chi2": fit.chi2,
        "numbers": fit.problem.observed.size,
        "parameters": [table[k] for k in fit.problem.of_interest],
    }
