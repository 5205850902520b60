"""`laticauda swim`: one run of one robot, its figures, its file and its picture."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

import laticauda as lc
from laticauda import figures, simulate
from laticauda.cli import command, flags, progress, report, scene, view
from laticauda.cli.flags import BadFlag, File, Files, NetCdf, Picture, ScenarioFile, Toml
from laticauda.quantities import option, quantity, value


@value
class Recording(view.Filming):
    """A command that makes a trial, and what becomes of that."""

    save: NetCdf = option("Write the trial to this netCDF file (.nc)", default=None)
    plot: Picture = option("Draw path, speed, joint angles and torques into this picture (.png or .pdf)", default=None)
    sheet: ClassVar[str] = "swim_sheet"

    def outcome(
        self,
        trial: lc.Trial,
        origin: str,
        more: str = "",
        facts: Mapping[str, Any] | None = None,
        beside: Sequence[lc.Trial] = (),
    ) -> command.Outcome:
        """Write what is asked for, and say what came out.

        Args:
            trial: The run.
            origin: Where its coefficients are from, in words.
            more: What is printed below the table.
            facts: What is known besides, for JSON.
            beside: Of other robots in the same scene.
        """
        if self.save is not None:
            for k, one in enumerate((trial, *beside)):
                one.save(f"{self.save.removesuffix('.nc')}-{k}.nc" if k else self.save)
        if self.plot is not None:
            figures.save_figure(getattr(figures, self.sheet)(trial), self.plot)
        self.write_film(trial, beside=beside)
        return command.Outcome(
            facts={**report.facts_of(trial), **(facts or {})},
            text=report.as_text(trial, origin) + more,
            problem="" if trial.succeeded else trial.status,
            succeeded=trial.succeeded,
        )


@value
class Run(scene.OfScenario, Recording):
    """A command that lets one scenario run."""

    file: ScenarioFile = option("A scenario file (.toml) that the flags change; it comes first", default=None)
    link_forces: bool = option("Log the force on every link too", default=False)
    save_scenario: Toml = option("Write what runs to this scenario file (.toml)", default=None)

    def swum(self, scenario: lc.Scenario) -> lc.Trial:
        """The run of a scenario, which is written if that is asked for.

        Args:
            scenario: What runs.
        """
        if self.save_scenario is not None:
            lc.save_scenario(scenario, self.save_scenario)
        scene.warn_of_compiling(scenario.environment, scenario.model)
        return lc.swim(scenario, link_forces=self.link_forces, progress=progress.run_bar(scenario.duration))


@value
class Swim(Run):
    """Let a robot swim a gait, from straight and at rest, and print its speed and power.

    For example: laticauda swim --robot mamba --gait lateral-undulation --amplitude-deg 30 --frequency-deg-s 130
    --phase-shift-deg 40 --duration 30 --save run.nc --plot run.png
    """

    resume: File = option("Go on from the end of this stored trial, with its robot, gait and water", default=None)
    interval: bool = option("Intervals of the figures from those of textbook coefficients; 8 more runs", default=False)

    beside: Files = option("Scenarios of further robots in the same scene; --save run.nc: run-1.nc, ...", default=())

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> Any:
        """The command that was typed; see `OfScenario.read`."""
        return SwimOn.read(words, prog) if flags.was_typed("resume", words) else super().read(words, prog)

    def run(self) -> command.Outcome:
        """Run and write."""
        if self.beside:
            return self._together()
        trial = self.swum(self.chosen)
        if not self.interval:
            return self.outcome(trial, self.origin)
        found = simulate.spread(trial)
        return self.outcome(trial, self.origin, f"\n\n{report.interval_table(trial, found)}", {"interval": found})

    def _together(self) -> command.Outcome:
        """The robot and those of further scenario files, in one scene."""
        scenarios = [self.chosen, *map(lc.load_scenario, self.beside)]
        trial, *others = lc.swim_together(scenarios, progress=progress.run_bar(self.chosen.duration))
        facts = {"beside": [report.facts_of(one) for one in others]}
        return self.outcome(trial, self.origin, "".join(f"\n\n{report.as_text(one)}" for one in others), facts, others)


@value
class SwimOn(Recording):
    """Go on from the end of a stored trial, with its robot, gait and water; the result is the whole run."""

    resume: File = option("The stored trial", default=None)
    duration: float = quantity("s", "How much longer", gt=0.0, default=30.0)
    sample_interval: float = quantity("s", "Between two samples of the log", gt=0.0, default=0.05)

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "SwimOn":
        """The command that was typed; arguments as for `Swim.read`.

        Raises:
            BadFlag: If an option says what the stored trial says.
        """
        allowed = {flags.flag(name) for name in flags.options_of(cls())} | {"--help", "-h"}
        for word in words:
            if word.startswith("--") and word.split("=")[0] not in allowed:
                raise BadFlag(f"{word.split('=')[0]} must not be given with --resume: the stored trial has its own.")
        return flags.read(cls, words, prog)

    def run(self) -> command.Outcome:
        """Run and write."""
        assert self.resume is not None
        first = lc.load_trial(self.resume)
        if not isinstance(first.scenario, lc.Scenario):
            raise BadFlag(f"--resume must be a simulated trial, got {self.resume}, which lacks {first.scenario.lacks}")
        scenario = replace(first.scenario, duration=self.duration)
        body = lc.plant(scenario)
        scene.warn_of_compiling(scenario.environment, scenario.model)
        second = lc.resume(
            body,
            first,
            self.duration,
            sample_interval=self.sample_interval,
            link_forces=first.link_force is not None,
            progress=progress.run_bar(self.duration),
        )
        return self.outcome(lc.joined(first, second), f"as stored in {self.resume}")
