"""`laticauda cockpit`: the live page, with one line that says where it is."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from laticauda.cli import command, scene
from laticauda.cli.flags import File, ScenarioFile, read, was_typed
from laticauda.cockpit.pages import load_viser
from laticauda.errors import BadArgument
from laticauda.estimation import Mount
from laticauda.operate import files, settings
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot

if TYPE_CHECKING:
    from laticauda.cockpit.operated import OperatedRobot


@value
class Tank:
    """A robot that somebody else operates, shown besides; nothing is sent to it."""

    lab: bool = option("Show the robot of a `laticauda lab` or a tank: --robot, or mamba-modules", default=False)
    trial: File = option("The same, with robot, connections and marker body of this trial file (.toml)", default=None)
    can: str | None = option(
        "Its CAN bus, udp_multicast:GROUP:PORT or socketcan:can0; left out: the trial file's or the lab's", default=None
    )
    mocap: str | None = option("Its motion capture, HOST:PORT; likewise", default=None)

    def __post_init__(self) -> None:
        """Refuse an address of nothing."""
        if (self.can or self.mocap) and not self.is_asked_for:
            raise BadArgument("can" if self.can else "mocap", "must be given with --lab or --trial, which show a robot")

    @property
    def is_asked_for(self) -> bool:
        """Whether one is to be shown."""
        return self.lab or self.trial is not None

    def connect(self, operated: "OperatedRobot", robot: Robot) -> None:
        """Look on.

        Args:
            operated: The page's.
            robot: What is in the tank.
        """
        usual, mount = settings.Connection(), Mount()
        if self.operation is not None:
            usual, mount = self.operation.connection, self.operation.calibration.mount
        operated.connect(usual.at(can=self.can, mocap=self.mocap), robot, mount=mount)

    @cached_property
    def operation(self) -> settings.Operation | None:
        """The trial file's, or None without one."""
        if self.trial is None:
            return None
        found = files.load_operation(self.trial)
        if isinstance(found, files.SeriesFile):
            raise BadArgument("trial", f"must be a trial file, got the series file {self.trial}")
        return found

    def robot(self) -> str | None:
        """What is in the tank, and swims on the page, if nothing else is asked for."""
        if self.operation is not None:
            return self.operation.robot
        return "mamba-modules" if self.lab else None


@value
class CockpitCommand(scene.OfScenario):
    """Serve a page on which the robot swims, until Ctrl-C: everything on it can be changed while it swims.

    It prints one line with the page's address. Whoever opens the page can use all of its controls.

    For example: laticauda cockpit --robot mamba-fin --port 8080
    """

    file: ScenarioFile = option("A scenario file (.toml) that the flags change; it comes first", default=None)
    tank: Tank = option("A robot that somebody else operates", default=Tank())
    load: str | None = option("Play back this trial or recording of an operation beside it", default=None)
    host: str = option("Where the page is served; 127.0.0.1 is this computer alone", default="127.0.0.1")
    port: int = quantity("", "Likewise; 0: any that is free", ge=0, le=65535, default=8080)

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> Any:
        """The command that was typed; see `OfScenario.read`."""
        names, tank = scene.Names.read(words, prog), read(Tank, words, prog, first=True)
        in_tank = tank.robot()
        if in_tank is not None and not was_typed("robot", words):
            names = replace(names, robot=in_tank)
        return cls.of(names, words, prog, tank=tank)

    def run(self) -> None:
        """Serve until Ctrl-C."""
        from laticauda.cockpit import Cockpit, Live

        load_viser()
        scenario = self.chosen
        scene.warn_of_compiling(scenario.environment, scenario.model)
        cockpit = Cockpit(Live(scenario), host=self.host, port=self.port)
        if self.host not in command.LOCAL:
            warning = "can use this page and read what it shows: it knows no passwords."
            print(f"Warning: anyone who reaches {self.host} {warning}", file=sys.stderr)
        with command.until_stopped(cockpit.close):
            if self.load is not None:
                cockpit.load(Path(self.load))
            if self.tank.is_asked_for:
                self.tank.connect(cockpit.operated, scenario.robot)
            cockpit.open()
            self.announce({"address": cockpit.address}, cockpit.address)
            cockpit.wait()
