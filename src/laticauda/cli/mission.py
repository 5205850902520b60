"""`laticauda mission`: a robot on a mission, once, under drawn conditions, or many times."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from laticauda.cli.command import Command, Outcome
from laticauda.cli.flags import (
    BadFlag,
    File,
    FilmOutput,
    OutputFile,
    PictureOutput,
    PresetArgument,
    TrialOutput,
)
from laticauda.cli.progress import stored_trials
from laticauda.cli.scene import warn_of_compiling
from laticauda.cli.shared_options import (
    check_way_of_running,
    merge_option,
    scheduler_option,
    share_option,
)
from laticauda.cli.tables import wrap_rows
from laticauda.missions import (
    N_WORST,
    CampaignSummary,
    Conditions,
    MergedCampaign,
    Mission,
    MissionResult,
    MissionRow,
    change_scenario,
    draw_conditions,
    draw_map,
    draw_phases,
    film_mission,
    list_missions,
    load_mission,
    merge_campaign,
    run_campaign,
    run_mission,
    summarize_campaign,
)
from laticauda.models.simulate import connected
from laticauda.scenarios import MODELS, Model, Planar, Scenario
from laticauda.show.figures import save_figure
from laticauda.show.pictures import find_ffmpeg
from laticauda.studies import Share, parse_share
from laticauda.values import BadArgument, option, quantity, to_plain, value_class

NEVER_FAILING = ("battery",)
"""Sensors that do not fail in drawn conditions."""


@value_class
class RunMission(Command):
    """Run a mission: a table of phases by which a robot finds, inspects and docks, by its sensors alone.

    For example: laticauda mission net-inspection --seed 3 --plot map.png --diagram phases.png
    """

    name: PresetArgument = option(
        "A mission that comes with laticauda, or a TOML file; a list if omitted", default=None
    )
    model: Literal["planar", "spatial"] | None = option(
        "The model; if omitted, the file's", default=None
    )
    seed: int | None = quantity(
        "", "Draw water, start and failing sensors by this seed", ge=0, default=None
    )
    duration: float | None = quantity(
        "s", "Longest duration; if omitted, the file's", gt=0.0, default=None
    )
    runs: int | None = quantity("", "Run a campaign of so many seeds", ge=1, default=None)
    table: Annotated[File, OutputFile((".csv",))] = option(
        "Table of the campaign's runs, which a stopped campaign goes on with", default=None
    )
    scheduler: str | None = scheduler_option()
    share: str | None = share_option("table", "--table")
    merge: bool = merge_option("--table")
    films: int | None = quantity(
        "",
        "Film so many of the campaign's worst runs, beside its table",
        ge=1,
        le=N_WORST,
        default=None,
    )
    save: TrialOutput = option("Write the trial to this file", default=None)
    video: FilmOutput = option(
        "Write a film of the run from above (.mp4, .webp or .gif)", default=None
    )
    speed: float | None = quantity(
        "", "Playback speed of films; about 20 s of film if omitted", gt=0.0, default=None
    )
    plot: PictureOutput = option("Draw a map of the run to this file", default=None)
    diagram: PictureOutput = option("Draw the phases to this file", default=None)

    def run(self) -> Outcome:
        """Run, and write what is requested."""
        if self.name is None:
            missions = list_missions()
            return Outcome(facts={"missions": missions}, text="\n".join(missions))
        self._check_way_of_running()
        scenario = self._scenario(self.name)
        mission = scenario.motion
        assert isinstance(mission, Mission)
        if self.diagram is not None:
            save_figure(draw_phases(mission), self.diagram)
        if self.scheduler is None and not self.merge:
            warn_of_compiling(scenario.environment, scenario.model, scenario.robot)
        if self.runs is not None and self.table is not None:
            return self._run_campaign(scenario, range(self.runs), self.table)
        if self.seed is not None:
            conditions = _conditions_of(scenario)
            draw = draw_conditions(conditions, self.seed)
            scenario = change_scenario(scenario, conditions, draw)
        result = run_mission(scenario)
        if self.save is not None:
            result.trial.save(self.save)
        if self.plot is not None:
            save_figure(draw_map(result), self.plot)
        if self.video is not None:
            film_mission(result, speed=self.speed).save(self.video)
        return Outcome(facts=_facts_of(result), text=_describe(result))

    def _scenario(self, name: str) -> Scenario:
        """Return the mission with the chosen model and duration."""
        try:
            scenario = load_mission(name)
        except BadArgument as error:
            raise BadArgument("name", error.rule) from None
        if self.duration is not None:
            scenario = replace(scenario, duration=self.duration)
        if self.model is not None:
            scenario = replace(scenario, model=_as_model(scenario.model, self.model))
        return scenario

    def _check_way_of_running(self) -> None:
        """Refuse options that contradict each other."""
        if self.speed is not None and self.video is None and self.films is None:
            raise BadFlag("--speed must be given together with --video or --films.")
        if self.runs is None:
            if self.table is not None:
                raise BadFlag("--table must be given together with --runs.")
            of_campaigns = {
                "--scheduler": self.scheduler,
                "--share": self.share,
                "--merge": self.merge or None,
                "--films": self.films,
            }
            for flag in _typed(of_campaigns):
                raise BadFlag(f"{flag} must be given together with --runs.")
            return
        if self.table is None:
            raise BadFlag("--runs must be given together with --table FILE.csv.")
        of_one_run = {
            "--seed": self.seed,
            "--save": self.save,
            "--plot": self.plot,
            "--video": self.video,
        }
        for flag in _typed(of_one_run):
            raise BadFlag(f"{flag} must be left out with --runs: it is for one run only.")
        check_way_of_running(self.share, self.scheduler, merge=self.merge)
        if self.films is not None:
            if self.share is not None:
                raise BadFlag("--films must be left out with --share, and given with --merge.")
            find_ffmpeg()

    def _run_campaign(self, scenario: Scenario, seeds: range, table: str) -> Outcome:
        """Run a campaign, or a share of it, or merge its shares, and report what it shows."""
        if self.share is not None:
            return self._run_share(scenario, seeds, table, parse_share(self.share))
        if self.merge:
            merged = merge_campaign(table, seeds)
            if merged.n_done < len(seeds):
                return _report_unfinished(merged, seeds, table)
            rows = merged.rows
        else:
            rows = self._run_seeds(scenario, seeds, table)
        summary = summarize_campaign(rows)
        films = self._film_worst(scenario, summary.worst, Path(table))
        facts: dict[str, Any] = {**to_plain(asdict(summary)), "films": films}
        return Outcome(facts=facts, text="\n".join((_describe_campaign(summary), *films)))

    def _film_worst(self, scenario: Scenario, worst: Sequence[int], table: Path) -> list[str]:
        """Film the worst runs of a campaign, by their seeds, beside its table; return the files."""
        if self.films is None:
            return []
        conditions = _conditions_of(scenario)
        files: list[str] = []
        for seed in worst[: self.films]:
            draw = draw_conditions(conditions, seed)
            result = run_mission(change_scenario(scenario, conditions, draw))
            file = table.with_name(f"{table.stem}-{seed}.mp4")
            film_mission(result, speed=self.speed).save(file)
            files.append(str(file))
        return files

    def _run_seeds(
        self, scenario: Scenario, seeds: range, table: str, share: Share | None = None
    ) -> list[MissionRow]:
        """Run what is not stored yet of a campaign, or of a share; return all rows of its table."""
        conditions = _conditions_of(scenario)
        written = table if share is None else share.file(table)
        with stored_trials(written) as show, connected(self.scheduler) as client:
            return run_campaign(
                scenario, conditions, seeds, table, progress=show, client=client, share=share
            )

    def _run_share(self, scenario: Scenario, seeds: range, table: str, share: Share) -> Outcome:
        """Run a share, and report how many of the runs it has."""
        rows = self._run_seeds(scenario, seeds, table, share)
        status = f"Share {share}: {len(rows)} of {len(seeds)} runs are in {share.file(table)}."
        facts = {
            "status": status,
            "n_runs": len(seeds),
            "n_done": len(rows),
            "table": str(share.file(table)),
        }
        text = f"{status}\nWhen all shares are done: the same command with --merge for --share."
        return Outcome(facts=facts, text=text)


def _typed(values: Mapping[str, object]) -> list[str]:
    """Return the options that were typed, of some that have no value otherwise."""
    return [flag for flag, value in values.items() if value is not None]


def _report_unfinished(merged: MergedCampaign, seeds: range, table: str) -> Outcome:
    """Report which shares are missing in a table that they were merged in."""
    missing = ", ".join(str(share) for share in merged.unfinished)
    status = (
        f"{merged.n_done} of {len(seeds)} runs are in {table}: not finished yet are the shares "
        f"{missing}."
    )
    facts: dict[str, Any] = {
        "status": status,
        "n_runs": len(seeds),
        "n_done": merged.n_done,
        "unfinished": [asdict(share) for share in merged.unfinished],
        "table": table,
    }
    advice = "Run them, and merge again; or run the same command without --merge, which does the rest here."
    return Outcome(facts=facts, text=f"{status}\n{advice}", succeeded=False)


def _as_model(model: Model, name: str) -> Model:
    """Return the model of a name with all settings that it has in common with another one."""
    wanted = MODELS[name]
    if isinstance(model, wanted):
        return model
    settings = {field.name: getattr(model, field.name) for field in fields(Planar)}
    return wanted(**settings)


def _conditions_of(scenario: Scenario) -> Conditions:
    """Return the conditions in which any sensor may fail that a robot needs to find its way."""
    names = [sensor.name for sensor in scenario.model.sensors]
    return Conditions(failing=tuple(name for name in names if name not in NEVER_FAILING))


def _facts_of(result: MissionResult) -> dict[str, Any]:
    """Return what came of a run, for programs."""
    return {
        "docked": result.is_docked,
        "last_phase": result.last_phase,
        "duration": result.duration,
        "clearance": result.clearance,
        "share_seen": result.share_seen,
        "largest_error": result.largest_error,
        "changes": [change._asdict() for change in result.changes],
    }


def _describe(result: MissionResult) -> str:
    """Return what came of a run, for people."""
    changes = [
        f"{change.time:7.1f} s  {change.before} -> {change.after}: {change.reason}"
        for change in result.changes
    ]
    ended = f"in `{result.last_phase}` after {result.duration:.1f} s"
    if result.is_docked:
        ended = f"docked after {result.duration:.1f} s"
    rows = [
        ("ended", ended),
        ("position", _describe_error(result.largest_error)),
    ]
    if math.isfinite(result.clearance):
        rows.insert(1, ("clearance", f"{result.clearance:.2f} m from anything but docks"))
    if result.share_seen is not None:
        rows.append(("net seen", f"{100.0 * result.share_seen:.0f} %"))
    return "\n".join(changes) + "\n\n" + wrap_rows(rows)


def _describe_error(largest_error: float) -> str:
    """Return how far off the position was believed to be, for people."""
    if math.isnan(largest_error):
        return "never known to 1 m: no sensor told it"
    return f"believed within {largest_error:.2f} m"


def _describe_campaign(summary: CampaignSummary) -> str:
    """Return what a campaign shows, for people."""
    share = 100.0 * summary.n_docked / summary.n_runs
    interval = f"{100.0 * summary.share_low:.1f} to {100.0 * summary.share_high:.1f} %"
    worst = ", ".join(str(seed) for seed in summary.worst)
    rows = [
        ("docked", f"{summary.n_docked} of {summary.n_runs}: {share:.1f} %, 95 % {interval}"),
        ("contacts", f"{summary.n_contacts}; least clearance {summary.least_clearance:.2f} m"),
        (
            "net seen",
            f"{100.0 * summary.share_of_net_seen:.1f} % on average; 90 % or more in {summary.n_seen_enough}",
        ),
        ("worst seeds", worst),
    ]
    rows += [("not docked", f"{cause}: {n}") for cause, n in summary.causes.items()]
    return wrap_rows(rows)
