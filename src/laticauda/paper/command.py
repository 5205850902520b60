"""`laticauda reproduce`: the paper's experiments in one folder, with a printed summary."""

import os
from collections import Counter
from typing import TYPE_CHECKING, Any, Literal

from laticauda.cli import command, scene, tables
from laticauda.cli.flags import ColumnNames, File, Folder
from laticauda.cli.progress import show_progress
from laticauda.cli.shared_options import column_option, read_columns
from laticauda.scenarios import loop_in_words
from laticauda.values import option, quantity, value_class

if TYPE_CHECKING:
    from laticauda.paper.efficiency import EfficiencyStudy
    from laticauda.paper.path_following import FollowingCase, PathFollowingStudy
    from laticauda.paper.report.reproduce import Reproduction
    from laticauda.paper.scores import Score
    from laticauda.paper.settings import Group

HEADS = {"lateral_undulation": "lateral", "eel_like": "eel-like"}
"""Short names of the gaits, for the terminal."""
PROGRESS_FORMAT = "{desc} {n_fmt} of {total_fmt} |{bar}| {remaining} left"
"""Line that shows the progress, for tqdm."""


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
        "Preset or parameter file: its water and robots replace the paper's, which are still shown "
        "for comparison",
        default=None,
    )
    repeats: File = option(
        "Repeated measurements (CSV: gait, config, alpha_deg, omega_deg_s, delta_deg, v_m_s, "
        "P_avg_W) to show in the figures of the efficiency study with their scatter",
        default=None,
    )
    column: ColumnNames = column_option("--repeats")
    workers: int | None = quantity(
        "", "Number of worker processes; one per core if omitted", ge=1, default=None
    )
    output: Folder = option(
        "Output folder, created if missing; same-named files are replaced", default="reproduction"
    )

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        from laticauda.paper.repeats import Repeat, load_repeats
        from laticauda.paper.report.reproduce import plan_experiments, reproduce
        from laticauda.robot import load_parameters, load_water

        parameters = None
        joints = self.joints
        if self.parameters is not None:
            parameters = load_parameters(self.parameters)
            joints = joints or parameters.joints
        columns = read_columns(self.column, self.repeats, "repeats")
        repeats: tuple[Repeat, ...] = ()
        if self.repeats is not None:
            repeats = load_repeats(self.repeats, columns)
        n_workers = self.workers
        if n_workers is None:
            n_workers = os.cpu_count() or 1
        scene.warn_of_compiling(load_water("paper-lateral"))
        bar = show_progress(PROGRESS_FORMAT)
        reproduction = reproduce(
            self.output,
            plan_experiments(parameters),
            only=self.only,
            model=self.model,
            joints=joints or "prescribed",
            repeats=repeats,
            workers=n_workers,
            progress=lambda activity, n_done, n_total: bar(n_done, n_total, activity),
        )
        return command.Outcome(facts=facts_of(reproduction), text=as_text(reproduction))


# ---- JSON ----------------------------------------------------------------------------------------


def facts_of(reproduction: "Reproduction") -> dict[str, Any]:
    """Return for JSON what was run, the errors [%] by predictor, the verdicts, and the files.

    Args:
        reproduction: What was run and written.
    """
    from laticauda.values import __version__

    facts: dict[str, Any] = {"status": "All runs reached their end."}
    efficiency = reproduction.results.get("efficiency")
    if efficiency is not None:
        facts["efficiency"] = _facts_of_efficiency(efficiency)
    path_following = reproduction.results.get("path_following")
    if path_following is not None:
        facts["path_following"] = _facts_of_path_following(path_following)
    facts["claims"] = Counter(claim.verdict for claim in reproduction.claims)
    facts["output"] = str(reproduction.folder)
    facts["files"] = reproduction.files
    facts["version"] = __version__
    return facts


def _facts_of_efficiency(study: "EfficiencyStudy") -> dict[str, Any]:
    from laticauda.paper.scores import score_study

    errors: dict[str, Any] = {}
    for score in score_study(study):
        errors[score.name] = {
            "numbers_fitted": score.n_fitted,
            **_facts_of_errors(study, score),
            "leave_one_out_percent": score.leave_one_out,
            "leave_one_group_out_percent": score.leave_one_group_out,
        }
    return {
        "settings": study.trial_settings,
        "n_runs": study.settings.n_runs,
        "errors": errors,
    }


def _facts_of_path_following(study: "PathFollowingStudy") -> dict[str, Any]:
    from laticauda.paper.scores import score_study

    errors: dict[str, Any] = {}
    for score in score_study(study):
        errors[score.name] = {
            "numbers_fitted_to_table1": score.n_fitted,
            **_facts_of_errors(study, score),
        }
    return {
        "settings": study.trial_settings,
        "errors": errors,
        "trials": [_facts_of_case(case) for case in study.cases],
    }


def _facts_of_errors(
    study: "EfficiencyStudy | PathFollowingStudy", score: "Score"
) -> dict[str, Any]:
    """Return the errors of a predictor, of all rows and by group [%]."""
    groups = [group.name for group in study.settings.groups]
    return {
        "mape_percent": score.overall,
        "mape_percent_by_group": dict(zip(groups, score.by_group, strict=True)),
    }


def _facts_of_case(case: "FollowingCase") -> dict[str, Any]:
    return {
        "group": case.group.name,
        "case": case.measured.case,
        "measured_velocity": case.measured.forward_velocity,
        "forward_velocity": case.run.forward_velocity,
        "last_third_rms": case.run.last_third_rms,
        **case.run.figures,
    }


# ---- text ----------------------------------------------------------------------------------------


def as_text(reproduction: "Reproduction") -> str:
    """Return as text the errors by predictor, the verdicts, and the location of the report.

    Args:
        reproduction: What was run and written.
    """
    paragraphs: list[str] = []
    efficiency = reproduction.results.get("efficiency")
    if efficiency is not None:
        paragraphs += _summarize_efficiency(efficiency)
    path_following = reproduction.results.get("path_following")
    if path_following is not None:
        paragraphs += _summarize_path_following(path_following)
    verdicts = _summarize_claims(reproduction)
    if verdicts:
        paragraphs.append("\n".join(verdicts))
    folder = reproduction.folder
    paragraphs.append(f"{len(reproduction.files)} files in {folder}; open {folder / 'report.html'}")
    return "\n\n".join(paragraphs)


def _summarize_claims(reproduction: "Reproduction") -> list[str]:
    """Return a sentence on the verdicts, and one for each of the project's own models."""
    from laticauda.paper.claims import summarize_verdicts

    sentences: list[str] = []
    if reproduction.claims:
        sentences.append(f"The paper's claims: {summarize_verdicts(reproduction.claims)}.")
    for model, claims in reproduction.own_claims.items():
        sentences.append(f"With {model}: {summarize_verdicts(claims)}.")
    return sentences


def _summarize_efficiency(study: "EfficiencyStudy") -> list[str]:
    joints = study.trial_settings["joints"]
    introduction = (
        f"Locomotion efficiency, {study.settings.n_runs} runs, {joints} joints.\n"
        "Mean error of the forward velocity over the measured rows of the paper's Table 1 [%]:"
    )
    return [introduction, _format_errors(study, with_rows_left_out=True)]


def _summarize_path_following(study: "PathFollowingStudy") -> list[str]:
    joints = study.trial_settings["joints"]
    loop = loop_in_words(study.trial_settings)
    limit = study.settings.accepted_error
    rms_errors = [case.run.last_third_rms for case in study.cases]
    n_below = sum(error is not None and error < limit for error in rms_errors)
    introduction = (
        f"Path following, {joints} joints, {loop}: "
        f"{n_below} of {len(study.cases)} trials keep\n"
        f"the mean error under {100 * limit:g} cm in their last third. "
        "Mean error of the forward velocity over the paper's Table 2 [%]:"
    )
    return [introduction, _format_errors(study, with_rows_left_out=False)]


def _format_errors(
    study: "EfficiencyStudy | PathFollowingStudy", *, with_rows_left_out: bool
) -> str:
    """Return a table of the errors, one predictor per line."""
    from laticauda.paper.scores import score_study

    heads = ["", "all rows", *(_head_of(group) for group in study.settings.groups)]
    if with_rows_left_out:
        heads.append("rows left out")
    lines = [heads]
    for score in score_study(study):
        errors: list[float | None] = [score.overall, *score.by_group]
        if with_rows_left_out:
            errors.append(score.leave_one_out)
        lines.append([score.title, *(tables.format_number(error) for error in errors)])
    return tables.align_columns(lines, right=range(1, len(heads)))


def _head_of(group: "Group") -> str:
    """Return the title of a group's column."""
    if group.has_fin:
        return f"{HEADS[group.gait]}, fin"
    return HEADS[group.gait]
