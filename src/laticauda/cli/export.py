"""`laticauda export mjcf | urdf`: a robot as a file for other programs."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tyro

from laticauda.cli.flags import Files, Preset, Switch, choice, default
from laticauda.cli.groups import RobotFlags
from laticauda.cli.outputs import check_output
from laticauda.robot import Environment, Robot, load_ground, load_water

WATER = "paper-lateral"
Output = Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="OUTPUT", help_behavior_hint="(required)")]
Meshes = Annotated[Files, default("shapes made from the sections")]


@dataclass(frozen=True, kw_only=True)
class Mjcf:
    """Write a robot, and the place that it is in, to an MJCF file that plain MuJoCo opens.

    For example: laticauda export mjcf mamba.xml --robot mamba-modules-fin --tank --actuators servo
    """

    output: Output
    """The file to write (.xml); an older one is replaced."""
    robot: RobotFlags = field(default_factory=RobotFlags)
    water: Annotated[Preset, default(WATER)] = None
    """A preset or a TOML file; its loads are not in the file, its depth is."""
    ground: Annotated[Preset, default("none")] = None
    """A preset or a TOML file: put the robot on land instead."""
    tank: Switch = False
    """The tank of the experiments around it: 40 m x 6.45 m, 1.5 m deep."""
    root: Annotated[str | None, choice("free", "planar"), default("free")] = None
    """Let the robot move in space, or hold its height and tilt."""
    actuators: Annotated[str | None, choice("none", "servo"), default("none")] = None
    """Servos in the joints, with the angle wanted as their input."""
    meshes: Meshes = None
    """One file (STL or OBJ, meters, in the module's frame) per module, tail first; copied beside the output."""
    json: Switch = False
    """Print one JSON object."""

    def __call__(self) -> int:
        """Write, and return the exit status."""
        check_output("output", self.output, (".xml",))
        from laticauda.spatial.export import write_mjcf

        robot = self.robot.chosen()
        options: dict[str, Any] = {"root": self.root or "free", "actuators": self.actuators or "none"}
        write_mjcf(self.output, robot, self._place(), tank=self.tank, meshes=self.meshes or (), **options)
        return _report(self.output, robot, as_json=self.json)

    def _place(self) -> Environment:
        if self.ground is None:
            return load_water(WATER if self.water is None else self.water)
        for name in ("water", "tank"):
            if getattr(self, name):
                raise ValueError(f"`{name}` must not be given with `ground`.")
        return load_ground(self.ground)


@dataclass(frozen=True, kw_only=True)
class Urdf:
    """Write a robot to a URDF file, for ROS and most other programs about robots.

    For example: laticauda export urdf mamba.urdf --robot mamba-modules-fin
    """

    output: Output
    """The file to write (.urdf); an older one is replaced."""
    robot: RobotFlags = field(default_factory=RobotFlags)
    meshes: Meshes = None
    """One file (STL or OBJ, meters, in the module's frame) per module, tail first; copied beside the output."""
    json: Switch = False
    """Print one JSON object."""

    def __call__(self) -> int:
        """Write, and return the exit status."""
        check_output("output", self.output, (".urdf",))
        from laticauda.spatial.export import write_urdf

        robot = self.robot.chosen()
        write_urdf(self.output, robot, meshes=self.meshes or ())
        return _report(self.output, robot, as_json=self.json)


def _report(output: str, robot: Robot, *, as_json: bool) -> int:
    """Say what was written."""
    done = {"output": output, "robot": robot.name, "n_links": robot.n_links, "mass": robot.mass, "length": robot.length}
    if as_json:
        print(json.dumps(done))
    else:
        size = Path(output).stat().st_size / 1000.0
        facts = f"{robot.n_links} modules, {robot.mass:.3f} kg, {robot.length:.2f} m"
        print(f"{output}: {robot.name}, {facts} ({size:.0f} kB)")
    return 0
