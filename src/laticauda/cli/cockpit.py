"""`laticauda cockpit`: the live page, with one line that says where it is."""

import json
import sys
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from laticauda.cli.flags import File, Preset, Switch, Text, Whole, choice, default
from laticauda.cli.groups import GaitFlags, RobotFlags
from laticauda.cli.lab import ROBOT as LAB_ROBOT
from laticauda.cli.messages import given
from laticauda.cli.swim import COMPILING
from laticauda.robot import Robot, Water, load_robot, load_water

if TYPE_CHECKING:
    from laticauda.cockpit.operated import OperatedRobot
    from laticauda.operate.settings import Operation

HOST, PORT = "127.0.0.1", 8080


@dataclass(frozen=True, kw_only=True)
class BodyFlags:
    """Where it swims, and how it is computed, at first."""

    water: Annotated[Preset, default("the paper's for the gait")] = None
    """A preset or a TOML file."""
    model: Annotated[str | None, choice("planar", "spatial"), default("planar")] = None
    """The model of the body: the closed form in the plane, or MuJoCo in space."""
    joints: Annotated[str | None, choice("prescribed", "pd", "servo"), default("prescribed")] = None
    """How the joints follow the gait."""

    def chosen(self) -> Water | None:
        """The water that is asked for; None: the paper's."""
        return None if self.water is None else load_water(self.water)


@dataclass(frozen=True, kw_only=True)
class LabFlags:
    """A robot that somebody else operates, shown besides; nothing is sent to it."""

    lab: Switch = False
    """Show the robot of a running `laticauda lab`, or of a tank. `--robot` is then what is in it: mamba-modules if
    it is left out, as in the lab."""
    trial: File = None
    """The same, with robot, connections and marker body as in this trial file of `laticauda operate` (.toml)."""
    can: Annotated[Text, default("that of the trial file, or of the lab")] = None
    """Its CAN bus: udp_multicast:GROUP:PORT or socketcan:can0."""
    mocap: Annotated[Text, default("that of the trial file, or of the lab")] = None
    """Its motion capture: HOST:PORT."""

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
        from laticauda.estimation import Mount
        from laticauda.operate.settings import Connection

        usual, mount = Connection(), Mount()
        if self.operation is not None:
            usual, mount = self.operation.connection, self.operation.calibration.mount
        operated.connect(usual.at(can=self.can, mocap=self.mocap), robot, mount=mount)

    @cached_property
    def operation(self) -> "Operation | None":
        """The trial file's, or None without one."""
        if self.trial is None:
            return None
        from laticauda.operate.files import SeriesFile, load_operation

        found = load_operation(self.trial)
        if isinstance(found, SeriesFile):
            raise ValueError(f"`trial` must be a trial file, got the series file {self.trial}.")
        return found

    def robot(self, flags: RobotFlags) -> Robot:
        """What is in the tank, and swims on the page.

        Args:
            flags: What is asked for.
        """
        if self.operation is not None and flags.robot is None:
            return load_robot(self.operation.robot)
        return (replace(flags, robot=LAB_ROBOT) if self.lab and flags.robot is None else flags).chosen()


@dataclass(frozen=True, kw_only=True)
class CockpitCommand:
    """Serve a page on which the robot swims, until Ctrl-C: everything on it can be changed while it swims.

    It prints one line with the page's address. Whoever opens the page can use all of its controls.

    For example: laticauda cockpit --robot mamba-fin --port 8080
    """

    robot: RobotFlags = field(default_factory=RobotFlags)
    gait: GaitFlags = field(default_factory=GaitFlags)
    body: BodyFlags = field(default_factory=BodyFlags)
    lab: LabFlags = field(default_factory=LabFlags)
    load: Annotated[Text, default("nothing")] = None
    """Play back this trial or recording of an operation beside it, or show this sweep as the map."""
    host: Annotated[Text, default(f"{HOST}: this computer alone")] = None
    """Where the page is served."""
    port: Annotated[Whole, default(f"{PORT}")] = None
    """Likewise; 0: any that is free."""
    json: Switch = False
    """Print the line as a JSON object."""

    def __call__(self) -> int:
        """Serve, and return the exit status."""
        port = PORT if self.port is None else self.port
        if not 0 <= port <= 65535:
            raise ValueError(f"`port` must be between 0 and 65535, got {port}.")
        from laticauda.cockpit import Cockpit, Live
        from laticauda.cockpit.pages import LOCAL, load_viser
        from laticauda.scenarios import scenario
        from laticauda.simulate import needs_compiling

        load_viser()
        robot = self.lab.robot(self.robot)
        chosen: dict[str, Any] = {n: v for n, v in given(self.body).items() if n in ("model", "joints")}
        swum = scenario(robot, self.gait.chosen(), environment=self.body.chosen(), **chosen)
        if needs_compiling(swum.environment, model=swum.model):
            print(COMPILING, file=sys.stderr, flush=True)
        host = self.host or HOST
        cockpit = Cockpit(Live(swum), host=host, port=port)
        if host not in LOCAL:
            print(
                f"Warning: anyone who reaches {host} can use this page and read what it shows: it knows no passwords.",
                file=sys.stderr,
            )
        try:
            if self.load is not None:
                cockpit.load(Path(self.load))
            if self.lab.is_asked_for:
                self.lab.connect(cockpit.operated, robot)
            cockpit.open()
            print(json.dumps({"address": cockpit.address}) if self.json else cockpit.address, flush=True)
            cockpit.wait()
        except KeyboardInterrupt:
            print("stopped.", file=sys.stderr)
        finally:
            cockpit.close()
        return 0
