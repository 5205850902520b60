"""`laticauda reproduce`: the paper's experiments in simulation, as one folder with a report."""

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli.flags import Switch, Text, choice, default
from laticauda.cli.swim import COMPILING
from laticauda.cli.tables import aligned, number

if TYPE_CHECKING:
    from laticauda.reports import Reproduction

FOLDER = "reproduction"
FORMAT = "{desc} {n_fmt} of {total_fmt} |{bar}| {remaining} left"


@dataclass(frozen=True, kw_only=True)
class Reproduce:
    """Repeat the paper's experiments in simulation, and put them beside what was measured on the robot.

    So far: the efficiency study, Figs. 4 to 11 and Table 1. Figures (PNG and PDF), tables (CSV), data (netCDF) and
    report.html, which needs no network, go into one folder. For example: laticauda reproduce --joints prescribed
    --output reproduction
    """

    only: Annotated[str | None, choice("efficiency"), default("all")] = None
    """Run this study only."""
    joints: Annotated[str | None, choice("prescribed", "pd", "servo"), default("prescribed")] = None
    """How the joints follow the gait: exactly, by the published simulations' law, or as the real robot's servos do."""
    output: Annotated[Text, tyro.conf.arg(metavar="DIR"), default(FOLDER)] = None
    """The folder; made if need be, files of the same names are replaced."""
    json: Switch = False
    """Print one JSON object instead of the table."""

    def __call__(self) -> int:
        """Run, write, print, and return the exit status."""
        from laticauda.errors import SimulationFailed
        from laticauda.reports import reproduce

        folder = FOLDER if self.output is None else self.output
        _warn_of_compiling()
        show = _progress()
        try:
            done = reproduce(folder, only=self.only, joints=self.joints or "prescribed", progress=show)
        except SimulationFailed as error:
            print(error, file=sys.stderr)
            return 1
        except ValueError as error:
            raise ValueError(str(error).replace("`folder`", "--output")) from error
        print(_as_json(done) if self.json else _as_text(done))
        return 0


def _warn_of_compiling() -> None:
    from laticauda.robot import load_water
    from laticauda.simulate import needs_compiling

    if needs_compiling(load_water("paper-lateral")):
        print(COMPILING, file=sys.stderr, flush=True)


def _progress() -> Callable[[str, int, int], None]:
    """A bar on standard error for each part of the work, if that is a terminal."""
    bars: dict[str, Any] = {}

    def show(what: str, done: int, total: int) -> None:
        if not sys.stderr.isatty():
            return
        if what not in bars:
            from tqdm import tqdm

            bars[what] = tqdm(total=total, desc=what, bar_format=FORMAT, leave=False, file=sys.stderr)
        bars[what].update(done - bars[what].n)
        if done >= total:
            bars[what].close()

    return show


def _as_json(done: "Reproduction") -> str:
    """What was run, the errors [%] by predictor, and the files."""
    from laticauda.studies import scores

    study = done.efficiency
    groups = [group.name for group in study.settings.groups]
    errors = {
        score.name: {
            "numbers_fitted": score.n_fitted,
            "mape_percent": score.overall,
            "mape_percent_by_group": dict(zip(groups, score.by_group, strict=True)),
            "leave_one_out_percent": score.leave_one_out,
            "leave_one_group_out_percent": score.leave_one_group_out,
        }
        for score in scores(study)
    }
    found = {
        "status": "All runs reached their end.",
        "settings": study.how,
        "efficiency": {"n_runs": study.settings.n_runs, "errors": errors},
        "output": str(done.folder),
        "files": done.files,
        "version": study.version,
    }
    return json.dumps(found, indent=2, allow_nan=False)


def _as_text(done: "Reproduction") -> str:
    """The errors by predictor, and where the report is."""
    from laticauda.studies import scores

    study = done.efficiency
    rows = [["", "all rows", *(group.name for group in study.settings.groups), "rows left out"]]
    for score in scores(study):
        left_out = "-" if score.leave_one_out is None else number(score.leave_one_out)
        name = score.name if score.n_fitted is None else f"null model: {score.name}"
        rows.append([name, number(score.overall), *map(number, score.by_group), left_out])
    return (
        f"Locomotion efficiency, {study.settings.n_runs} runs, {study.how['joints']} joints.\n"
        "Mean error of the forward velocity over the measured rows of the paper's Table 1 [%]:\n\n"
        f"{aligned(rows, right=range(1, len(rows[0])))}\n\n"
        f"{len(done.files)} files in {done.folder}; open {done.folder / 'report.html'}"
    )
