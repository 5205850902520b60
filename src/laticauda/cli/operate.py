"""`laticauda operate`: run a trial file or a series file on the robot, virtual or real."""

import math
import sys
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

from laticauda.cli import command, flags
from laticauda.models import simulate
from laticauda.tank.operate import drivers, run_series, session, settings, terminal
from laticauda.values import BadArgument, RobotFileError, option, quantity, read_text, value_class


@value_class
class Operate(command.Command):
    """Operate the robot: connect, check, calibrate, swim, stop, and record everything; nothing is ever overwritten.

    Space, q or Ctrl-C straightens and stops the robot; the second press is the emergency stop. The
    virtual tank of `laticauda lab` is operated like the real robot.

    For example: laticauda operate trial.toml --output runs
    """

    file: flags.FileArgument = option("Trial file or series file (TOML)")
    output: flags.Folder = option("Folder of the recordings and trials", default="runs")
    check: bool = option("Only connect and check the hardware; nothing moves", default=False)
    clear: bool = option(
        "Clear the modules' faults first, once you have inspected them", default=False
    )
    no_dashboard: bool = option(
        "Plain lines instead of the dashboard; always so without a terminal", default=False
    )
    speed: float = quantity(
        "", "Multiple of real time, equal to the virtual tank's", gt=0.0, default=1.0
    )
    repeats: int | None = quantity(
        "", "Repeats of every setting; the file's if omitted", ge=1, default=None
    )
    bus: str | None = option(
        "Modules' bus: [DRIVER@]ADDRESS, such as socketcan:can0; else the file's", default=None
    )
    mocap: str | None = option(
        "Motion capture: [DRIVER@]ADDRESS, e.g. 10.0.0.2:22223; else the file's", default=None
    )
    meter: str | None = option(
        "Power meter: [DRIVER@]ADDRESS, such as /dev/ttyUSB0; else the file's", default=None
    )
    sensors: str | None = option(
        "Robot's own sensors: [DRIVER@]ADDRESS, such as 127.0.0.1:22224; else the file's",
        default=None,
    )
    mission: str | None = option(
        "Mission that steers, by name or as a file, with its gait, start and duration; else as the file says",
        default=None,
    )
    supply_voltage: float | None = quantity(
        "V", "Meter's supply voltage; the file's if omitted", gt=0.0, default=None
    )

    def run(self) -> command.Outcome:
        """Operate."""
        task = settings.load_operation(self.file)
        folder = Path(self.output)
        if isinstance(task, settings.SeriesFile):
            if self.check:
                return self._check_series(task)
            return self._run_series(task, folder)
        result = self._operate(self._with_options(task), None if self.check else folder)
        summary = result.summary()
        problem = ""
        if not summary["accepted"]:
            problem = summary["reason"]
        return command.Outcome(
            facts=summary,
            text=session.format_summary(summary),
            problem=problem,
            succeeded=not problem,
        )

    def _operate(self, operation: settings.Operation, folder: Path | None) -> session.Result:
        try:
            twin = simulate.build_plant(
                operation.body(), operation.pool(), joints=operation.joint_law()
            )
        except RobotFileError as error:
            raise settings.OperationFileError(f"{self.file}: {error}") from None
        with terminal.Keys() as keys, terminal.Terminal(keys), self._display_of(operation) as show:
            result = session.operate(
                operation,
                folder,
                clock=drivers.Clock(speed=self.speed),
                keys=keys,
                show=show,
                clears=self.clear,
                check_only=self.check,
                text=read_text(self.file),
                twin=twin,
            )
        # A key may also have been pressed after the run, while its trial was saved.
        return replace(result, stopped=bool(keys.events))

    def _check_series(self, series: settings.SeriesFile) -> command.Outcome:
        """Check the hardware for a series, each combination of robot and connection once."""
        distinct: dict[Any, settings.Operation] = {}
        for trial in series.trials:
            operation = self._with_options(trial)
            hardware = (operation.robot, operation.connection)
            distinct.setdefault(hardware, operation)
        results = [self._operate(operation, None) for operation in distinct.values()]
        summaries = [result.summary() for result in results]
        return command.Outcome(
            facts={"name": series.name, "checked": summaries},
            text="\n".join(map(session.format_summary, summaries)),
            succeeded=all(summary["accepted"] for summary in summaries),
        )

    def _run_series(self, series: settings.SeriesFile, folder: Path) -> command.Outcome:
        trials = tuple(map(self._with_options, series.trials))
        series = replace(series, repeats=self.repeats or series.repeats, trials=trials)
        result = run_series(
            series,
            folder / series.name,
            self._operate,
            place=self._ask_for_place,
            acknowledge=self._is_acknowledged,
        )
        return command.Outcome(
            facts=result.summary(), text=result.table(), succeeded=result.is_complete
        )

    def _ask_for_place(self, operation: settings.Operation, repeat: int) -> None:
        """Ask the operator to put the robot where the next run starts."""
        if operation.start is None:
            return
        x, y = operation.start.position
        heading = math.degrees(operation.start.heading)
        request = f"put the robot at ({x:.2f}, {y:.2f}) m, heading {heading:.1f} deg"
        print(f"{operation.name}, run {repeat}: {request}", file=sys.stderr, flush=True)
        if sys.stdin.isatty():
            input("Press Enter when it is in place: ")

    def _is_acknowledged(self, result: session.Result) -> bool:
        """Ask somebody to look at the robot that a fault has stopped; without a terminal, nobody does."""
        print(f"{result.name}: {result.aftermath or result.reason}", file=sys.stderr, flush=True)
        if not sys.stdin.isatty():
            return False
        input("Look at the robot, and press Enter when it may have torque again: ")
        return True

    def _display_of(self, operation: settings.Operation) -> Any:
        """Return what displays the ticks: the dashboard, or plain lines on standard error."""
        if self.no_dashboard or self.json or not sys.stdout.isatty():
            return nullcontext(terminal.print_events)
        return terminal.Dashboard(operation)

    def _with_mission(self, operation: settings.Operation) -> settings.Operation:
        """Return the operation, steered by the mission if there is one."""
        if self.mission is None:
            return operation
        from laticauda import missions  # only with a mission, for missions can be left out

        scenario = missions.load_mission(self.mission)
        if not operation.connection.sensors_address:
            rule = "must be given with --mission, which steers by what they tell"
            raise BadArgument("sensors", f"{rule}, got none")
        if operation.body() != scenario.robot:
            rule = "must be one of the robot in the trial file, with the same parameters"
            raise BadArgument("mission", f"{rule}, got one of `{scenario.robot.name}`")
        start = missions.start_of(scenario)
        return replace(
            operation,
            name=Path(self.mission).stem,
            steering=missions.mission_of(scenario),
            following=None,
            start=settings.Placement(position=start.center_of_mass, heading=start.heading),
            duration=scenario.duration,
        )

    def _with_options(self, operation: settings.Operation) -> settings.Operation:
        """Return the operation of the file, modified by the options."""
        connection = operation.connection.at(
            bus=self.bus, mocap=self.mocap, meter=self.meter, sensors=self.sensors
        )
        operation = self._with_mission(replace(operation, connection=connection))
        if self.supply_voltage is None:
            return operation
        return replace(operation, supply_voltage=self.supply_voltage)
