"""`laticauda operate`: run a trial file or a series file on the robot, virtual or real."""

import math
import sys
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

from laticauda.cli import command, flags
from laticauda.models import simulate
from laticauda.tank.operate import drivers, session, settings, terminal
from laticauda.tank.operate.series import run_series
from laticauda.values.errors import RobotFileError
from laticauda.values.files import read_text
from laticauda.values.quantities import option, quantity, value_class


@value_class
class Operate(command.Command):
    """Operate the robot: connect, check, calibrate, swim, stop, and record everything; nothing is ever overwritten.

    Space, q or Ctrl-C straightens and stops the robot; the second press is the emergency stop. The
    virtual tank of `laticauda lab` is operated like the real robot.

    For example: laticauda operate trial.toml --output runs
    """

    file: flags.Input = option("Trial file or series file (TOML)")
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
    supply_voltage: float | None = quantity(
        "V", "Meter's supply voltage; the file's if omitted", gt=0.0, default=None
    )

    def run(self) -> command.Outcome:
        """Operate."""
        wanted = settings.load_operation(self.file)
        folder = Path(self.output)
        if isinstance(wanted, settings.SeriesFile):
            return self._checked(wanted) if self.check else self._series(wanted, folder)
        summary = self._operate(self._chosen(wanted), None if self.check else folder).summary()
        problem = "" if summary["accepted"] else summary["reason"]
        return command.Outcome(
            facts=summary,
            text=session.format_summary(summary),
            problem=problem,
            succeeded=not problem,
        )

    def _operate(self, operation: settings.Operation, folder: Path | None) -> session.Result:
        try:
            twin = simulate.build_plant(operation.body(), operation.pool(), joints="servo")
        except RobotFileError as error:
            raise settings.OperationFileError(f"{self.file}: {error}") from None
        with terminal.Keys() as keys, terminal.Terminal(keys), self._shown(operation) as show:
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
        return replace(
            result, stopped=bool(keys.events)
        )  # also by a key after the run, while its trial was saved

    def _checked(self, series: settings.SeriesFile) -> command.Outcome:
        """Check the hardware for a series, each combination of robot and connection once."""
        different = {
            (one.robot, one.connection): one
            for one in reversed(list(map(self._chosen, series.trials)))
        }
        found = [self._operate(one, None).summary() for one in reversed(different.values())]
        facts, succeeded = (
            {"name": series.name, "checked": found},
            all(one["accepted"] for one in found),
        )
        return command.Outcome(
            facts=facts, text="\n".join(map(session.format_summary, found)), succeeded=succeeded
        )

    def _series(self, series: settings.SeriesFile, folder: Path) -> command.Outcome:
        trials = tuple(map(self._chosen, series.trials))
        series = replace(series, repeats=self.repeats or series.repeats, trials=trials)
        done = run_series(
            series,
            folder / series.name,
            self._operate,
            place=self._place,
            acknowledge=self._acknowledged,
        )
        return command.Outcome(facts=done.summary(), text=done.table(), succeeded=done.is_complete)

    def _place(self, operation: settings.Operation, repeat: int) -> None:
        """Ask the operator to put the robot where the next run starts."""
        if operation.start is None:
            return
        x, y = operation.start.position
        where = f"({x:.2f}, {y:.2f}) m, heading {math.degrees(operation.start.heading):.1f} deg"
        print(
            f"{operation.name}, run {repeat}: put the robot at {where}", file=sys.stderr, flush=True
        )
        if sys.stdin.isatty():
            input("Press Enter when it is in place: ")

    def _acknowledged(self, result: session.Result) -> bool:
        """Ask somebody to look at the robot that a fault has stopped; without a terminal, nobody does."""
        print(f"{result.name}: {result.aftermath or result.reason}", file=sys.stderr, flush=True)
        if not sys.stdin.isatty():
            return False
        input("Look at the robot, and press Enter when it may have torque again: ")
        return True

    def _shown(self, operation: settings.Operation) -> Any:
        """Return what displays the ticks: the dashboard, or plain lines on standard error."""
        if self.no_dashboard or self.json or not sys.stdout.isatty():
            return nullcontext(terminal.print_events)
        return terminal.Dashboard(operation)

    def _chosen(self, operation: settings.Operation) -> settings.Operation:
        """Return the operation of the file, modified by the options."""
        connection = operation.connection.at(bus=self.bus, mocap=self.mocap, meter=self.meter)
        voltage = operation.supply_voltage if self.supply_voltage is None else self.supply_voltage
        return replace(operation, connection=connection, supply_voltage=voltage)
