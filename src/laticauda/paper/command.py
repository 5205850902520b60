"""`laticauda reproduce`: the paper's experiments in simulation, as one folder with a report and a printed summary."""

import os
from collections import Counter
from typing import TYPE_CHECKING, Any, Literal

from laticauda.cli import command, scene, tables
from laticauda.cli.command import show_progress
from laticauda.cli.flags import File, Folder
from laticauda.scenarios import loop_in_words
from laticauda.values.quantities import option, quantity, value_class

if TYPE_CHECKING:
    from laticauda.paper.efficiency import EfficiencyStudy
    from laticauda.paper.path_following import PathFollowingStudy
    from laticauda.paper.report.reproduce import Reproduction

HEADS = {"lateral_undulation": "lateral", "eel_like": "eel-like"}
"""Short names of the gaits, for the terminal."""
FORMAT = "{desc} {n_fmt} of {total_fmt} |{bar}| {remaining} left"


@value_class
class Reproduce(command.Command):
    """Repeat the paper's experiments in simulation, and compare them with measurements on the robot.

    Locomotion efficiency (Table 1, Figs. 4 to 11), path following (Table 2, Figs. 12 to 23), and a
    verdict on each of the claims. Figures (PNG and PDF), tables (CSV), trials (netCDF) and
    report.html, which needs no network, go into one folder. For example: laticauda reproduce
    --joints prescribed --output reproduction
    """

    only: Literal["efficiency", "path-following"] | None = option(
        "Run only this half of the paper", default=None
    )
    model: Literal["planar", "spatial"] = option(
        "Body model; `spatial` (MuJoCo) takes minutes", default="planar"
    )
    joints: str | None = option(
        "Joint law; that of the parameters, or prescribed, if omitted", default=None
    )
    parameters: str | None = option(
        "Preset or parameter file: its water and robots replace the paper's, which are still shown for comparison",
        default=None,
    )
    repeats: File = option(
        "Repeated measurements (CSV: gait, config, alpha_deg, omega_deg_s, delta_deg, v_m_s, P_avg_W) to show in the "
        "figures of the efficiency study with their scatter",
        default=None,
    )
    workers: int | None = quantity(
        "", "Number of worker processes; one per core if omitted", ge=1, default=None
    )
    output: Folder = option(
        "Output folder, created if missing; same-named files are replaced", default="reproduction"
    )

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        from laticauda.paper.efficiency import load_repeats
        from laticauda.paper.report.reproduce import paper_experiments, reproduce
        from laticauda.robot import load_parameters, load_water

        parameters = None if self.parameters is None else load_parameters(self.parameters)
        settings = paper_experiments(parameters)
        joints = (
            self.joints or (parameters.joints if parameters is not None else None) or "prescribed"
        )
        repeats = () if self.repeats is None else load_repeats(self.repeats)
        scene.warn_of_compiling(load_water("paper-lateral"))
        bar = show_progress(FORMAT)
        done = reproduce(
            self.output,
            settings,
            only=self.only,
            model=self.model,
            joints=joints,
            repeats=repeats,
            workers=os.cpu_count() or 1 if self.workers is None else self.workers,
            progress=lambda what, done, total: bar(done, total, what),
        )
        return command.Outcome(facts=facts_of(done), text=as_text(done))


def facts_of(done: "Reproduction") -> dict[str, Any]:
    """Return for JSON what was run, the errors [%] by predictor, the verdicts, and the files.

    Args:
        done: What was run and written.
    """
    from laticauda.values.packaging import __version__

    results = done.results
    found: dict[str, Any] = {"status": "All runs reached their end."}
    if (study := results.get("efficiency")) is not None:
        errors = _errors(study, "numbers_fitted", "leave_one_out", "leave_one_group_out")
        found["efficiency"] = {
            "settings": study.how,
            "n_runs": study.settings.n_runs,
            "errors": errors,
        }
    if (study := results.get("path_following")) is not None:
        errors = _errors(study, "numbers_fitted_to_table1")
        found["path_following"] = {
            "settings": study.how,
            "errors": errors,
            "trials": _trials(study),
        }
    return found | {
        "claims": Counter(claim.verdict for claim in done.claims),
        "output": str(done.folder),
        "files": done.files,
        "version": __version__,
    }


def as_text(done: "Reproduction") -> str:
    """Return as text the errors by predictor, the verdicts on the paper's claims, and the location of the report.

    Args:
        done: What was run and written.
    """
    results = done.results
    parts: list[str] = []
    if (study := results.get("efficiency")) is not None:
        parts += [
            f"Locomotion efficiency, {study.settings.n_runs} runs, {study.how['joints']} joints.\n"
            "Mean error of the forward velocity over the measured rows of the paper's Table 1 [%]:",
            _table(study, "leave_one_out"),
        ]
    if (study := results.get("path_following")) is not None:
        limit = study.settings.accepted_error
        held = sum(
            case.run.last_third_rms is not None and case.run.last_third_rms < limit
            for case in study.cases
        )
        parts += [
            f"Path following, {study.how['joints']} joints, {loop_in_words(study.how)}: "
            f"{held} of {len(study.cases)} trials keep\nthe mean error under {100 * limit:g} cm in their last third. "
            "Mean error of the forward velocity over the paper's Table 2 [%]:",
            _table(study),
        ]
    verdicts = Counter(claim.verdict for claim in done.claims)
    parts.append(
        f"The paper's claims: {', '.join(f'{verdict} {count}' for verdict, count in verdicts.items())}."
    )
    parts.append(f"{len(done.files)} files in {done.folder}; open {done.folder / 'report.html'}")
    return "\n\n".join(parts)


def _errors(
    study: "EfficiencyStudy | PathFollowingStudy", fitted: str, *more: str
) -> dict[str, Any]:
    """Return by predictor the number of fitted parameters, and the errors."""
    from laticauda.paper.scores import score_study

    groups = [group.name for group in study.settings.groups]
    return {
        score.name: {
            fitted: score.n_fitted,
            "mape_percent": score.overall,
            "mape_percent_by_group": dict(zip(groups, score.by_group, strict=True)),
            **{f"{name}_percent": getattr(score, name) for name in more},
        }
        for score in score_study(study)
    }


def _trials(study: "PathFollowingStudy") -> list[dict[str, Any]]:
    return [
        {
            "group": case.group.name,
            "case": case.measured.case,
            "measured_velocity": case.measured.forward_velocity,
            "forward_velocity": case.run.forward_velocity,
            "last_third_rms": case.run.last_third_rms,
            **case.run.figures,
        }
        for case in study.cases
    ]


def _table(study: "EfficiencyStudy | PathFollowingStudy", left_out: str = "") -> str:
    """Return a table of the errors, one predictor per line."""
    from laticauda.paper.scores import score_study

    heads = [
        f"{HEADS[group.gait]}, fin" if group.has_fin else HEADS[group.gait]
        for group in study.settings.groups
    ]
    rows = [["", "all rows", *heads, *(["rows left out"] if left_out else [])]]
    for score in score_study(study):
        values = [score.overall, *score.by_group, *([getattr(score, left_out)] if left_out else [])]
        rows.append([score.title, *map(tables.format_number, values)])
    return tables.aligned(rows, right=range(1, len(rows[0])))
