"""`laticauda swim`: one run of one scenario, its figures, file and picture."""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import laticauda as lc
from laticauda.cli import command, flags, progress, report, scene
from laticauda.cli.flags import BadFlag, File, Files, TomlOutput
from laticauda.cli.trial_output import Recording
from laticauda.models import simulate
from laticauda.values import fields_of, option, quantity, value_class


@value_class
class ScenarioRun(scene.OfScenarioOrFile, Recording):
    """A command that runs one scenario."""

    link_forces: bool = option(
        "Also log the force on every link and in every joint, and print the largest", default=False
    )
    save_scenario: TomlOutput = option("Write the scenario to this file (.toml)", default=None)

    def run_scenario(self, scenario: lc.Scenario) -> lc.Trial:
        """Return the trial of a scenario, which is written to a file if requested.

        Args:
            scenario: Scenario to run.
        """
        if self.save_scenario is not None:
            lc.save_scenario(scenario, self.save_scenario)
        scene.warn_of_compiling(scenario.environment, scenario.model, scenario.robot)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", lc.InfeasibleWarning)  # the first screen says it
            return lc.swim(
                scenario, link_forces=self.link_forces, progress=progress.run_bar(scenario.duration)
            )


@value_class
class Swim(ScenarioRun):
    """Let a robot swim a gait, starting straight and at rest, and print its speed and power.

    For example: laticauda swim --robot mamba --gait lateral-undulation --amplitude-deg 30
    --frequency-deg-s 130 --phase-shift-deg 40 --duration 30 --save run.nc --plot run.png

    Short: laticauda swim mamba-fin --frequency-hz 0.36
    """

    resume: File = option(
        "Continue from the end of this stored trial, with its robot, gait and water", default=None
    )
    interval: bool = option(
        "Also print intervals from those of the textbook coefficients (8 or 12 more runs)",
        default=False,
    )

    beside: Files = option(
        "Scenarios of more robots in the same scene, saved as run-1.nc, ... by --save", default=()
    )

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> Any:
        """Return the command that was typed; see `OfScenario.read`."""
        if flags.was_typed(fields_of(cls)["resume"], arguments):
            return ResumeSwim.read(arguments, prog)
        return super().read(arguments, prog)

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        if self.interval:
            self._refuse_fitted_numbers()
        if self.beside:
            return self._run_together()
        trial = self.run_scenario(self.scenario_to_run)
        if not self.interval or not trial.succeeded:
            return self.write_and_report(trial, self.origin, basis=self.basis)
        varied = simulate.intervals_of(self.scenario_to_run)
        intervals = simulate.figure_intervals(trial, varied)
        table = report.interval_table(trial, intervals, varied)
        return self.write_and_report(
            trial,
            self.origin,
            further_text=f"\n\n{table}",
            further_facts={"interval": intervals},
            basis=self.basis,
        )

    def _refuse_fitted_numbers(self) -> None:
        """Reject an interval that would hold numbers fixed that were fitted beside those it varies.

        Raises:
            BadFlag: If the parameters have such numbers.
        """
        name = self.choice.parameters
        if name is None or not lc.load_parameters(name).fitted:
            return
        folder = Path(name).parent if Path(name).suffix else "FOLDER"
        raise BadFlag(
            f"--interval must not be given with numbers that were fitted, such as those of {name}: "
            f"`laticauda predict {folder}` has the interval of a fit."
        )

    def _run_together(self) -> command.Outcome:
        """Run the robot and those of further scenario files in one scene."""
        scenarios = [self.scenario_to_run, *map(lc.load_scenario, self.beside)]
        bar = progress.run_bar(self.scenario_to_run.duration)
        trial, *neighbors = lc.swim_together(scenarios, link_forces=self.link_forces, progress=bar)
        texts = [f"\n\n{self.describe(neighbor)}" for neighbor in neighbors]
        return self.write_and_report(
            trial,
            self.origin,
            further_text="".join(texts),
            further_facts={"beside": [report.facts_of_trial(neighbor) for neighbor in neighbors]},
            neighbors=neighbors,
            basis=self.basis,
        )


@value_class
class ResumeSwim(Recording):
    """Continue from the end of a stored trial, with its robot, gait and water; the result is the whole run."""

    resume: File = option("The stored trial", default=None)
    duration: float = quantity("s", "Further duration", gt=0.0, default=30.0)
    sample_interval: float = quantity(
        "s", "Time between two samples of the log", gt=0.0, default=0.05
    )

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> "ResumeSwim":
        """Return the command that was typed; arguments as for `Swim.read`.

        Raises:
            BadFlag: If an option sets what the stored trial already defines.
        """
        allowed = {flags.spell_option(field) for field in flags.options_of(cls())} | {"--help"}
        for argument in arguments:
            flag = flags.spell_typed_flag(argument)
            if flag.startswith("--") and flag not in allowed:
                rule = "must not be given with --resume: the stored trial has its own"
                raise BadFlag(f"{flag} {rule}.")
        return flags.parse_command(cls, arguments, prog)

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        assert self.resume is not None
        stored = lc.load_trial(self.resume)
        if not isinstance(stored.scenario, lc.Scenario):
            lacking = f"{self.resume}, which lacks {stored.scenario.lacks}"
            raise BadFlag(f"--resume must be a simulated trial, got {lacking}")
        scenario = replace(stored.scenario, duration=self.duration)
        plant = lc.build_plant(scenario)
        scene.warn_of_compiling(scenario.environment, scenario.model, scenario.robot)
        continuation = lc.resume(
            plant,
            stored,
            self.duration,
            sample_interval=self.sample_interval,
            link_forces=stored.link_force is not None,
            progress=progress.run_bar(self.duration),
        )
        whole_run = lc.joined(stored, continuation)
        return self.write_and_report(whole_run, f"as stored in {self.resume}")
