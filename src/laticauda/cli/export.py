"""`laticauda export mjcf | urdf | fmu`: a robot as a file for other programs."""

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tyro

from laticauda.cli.flags import Files, Number, Preset, Switch, choice, default
from laticauda.cli.groups import (
    Coefficients,
    EnvironmentFlags,
    GaitFlags,
    ModelFlags,
    RobotFlags,
    WaterChanges,
    radians,
)
from laticauda.cli.outputs import check_output
from laticauda.cli.swim import COMPILING
from laticauda.robot import Environment, Robot, Water, load_ground, load_water

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


@dataclass(frozen=True, kw_only=True)
class Fmu:
    """Write a robot in water to an FMU (co-simulation, Linux on x86-64) that runs without Python.

    Its inputs are the gait's numbers or the references of the joints, and the current; its outputs motion, torques and
    power. Gait, coefficients and start are what it has unless the other tool sets them. It takes a C compiler to write.

    For example: laticauda export fmu mamba.fmu --robot mamba-fin --joints servo --inputs references
    """

    output: Output
    """The file to write (.fmu); an older one is replaced."""
    inputs: Annotated[str | None, choice("gait", "references"), default("gait")] = None
    """What drives the joints: the gait's numbers, or an angle for every joint (pd and servo)."""
    fmi: Annotated[str | None, choice("2.0", "3.0"), default("2.0")] = None
    """Version of the standard; all tools read 2.0."""
    robot: RobotFlags = field(default_factory=RobotFlags)
    gait: GaitFlags = field(default_factory=GaitFlags)
    environment: EnvironmentFlags = field(default_factory=EnvironmentFlags)
    coefficients: Coefficients = field(default_factory=WaterChanges)
    """Replace what the chosen water has."""
    model: ModelFlags = field(default_factory=ModelFlags)
    heading_deg: Annotated[Number, default("0")] = None
    """Initial heading, counter-clockwise from the x axis [deg]."""
    json: Switch = False
    """Print one JSON object."""

    def __call__(self) -> int:
        """Write, and return the exit status."""
        check_output("output", self.output, (".fmu",))
        gait = self.gait.chosen()
        water, _ = self.environment.chosen(gait, self.coefficients)
        if not isinstance(water, Water):
            raise ValueError("`ground` must not be given: the robot in an FMU swims in water.")
        settings = self.environment.model_settings(self.model)
        if settings.pop("model", "planar") != "planar" or "root" in settings:
            raise ValueError("`model` must be `planar`: the spatial model needs MuJoCo, which is not in the FMU.")
        robot = self.environment.equipped(self.robot.chosen(), gait)
        from laticauda.cosim.fmu import export_fmu, needs_compiling
        from laticauda.interfaces import Start

        if needs_compiling(water):
            print(COMPILING, file=sys.stderr, flush=True)
        start = Start(heading=radians(self.heading_deg, 0.0))
        settings |= {"inputs": self.inputs or "gait", "fmi": self.fmi or "2.0"}
        variables = export_fmu(self.output, robot, gait, water=water, start=start, **settings)
        count = {kind: sum(v.causality == kind for v in variables) for kind in ("parameter", "input", "output")}
        if self.json:
            print(_json(self.output, robot, **{f"n_{kind}s": number for kind, number in count.items()}))
        else:
            facts = ", ".join(f"{number} {kind}s" for kind, number in count.items())
            print(f"{self.output}: {robot.name}, {facts} ({_size(self.output):.0f} kB)")
        return 0


def _report(output: str, robot: Robot, *, as_json: bool) -> int:
    """Say what was written."""
    if as_json:
        print(_json(output, robot))
    else:
        facts = f"{robot.n_links} modules, {robot.mass:.3f} kg, {robot.length:.2f} m"
        print(f"{output}: {robot.name}, {facts} ({_size(output):.0f} kB)")
    return 0


def _json(output: str, robot: Robot, **more: object) -> str:
    done = {"output": output, "robot": robot.name, "n_links": robot.n_links, "mass": robot.mass, "length": robot.length}
    return json.dumps(done | more)


def _size(output: str) -> float:
    """[kB]."""
    return Path(output).stat().st_size / 1000.0
