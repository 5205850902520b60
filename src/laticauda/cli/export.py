"""`laticauda export mjcf | urdf | fmu`: a robot as a file for other programs."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from laticauda.cli.flags import BadFlag, Files, MaybeName, Name, Output, read
from laticauda.cli.outputs import check_output
from laticauda.cli.scene import Names, named, warn_of_compiling
from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot, load_ground, load_robot, load_water
from laticauda.scenarios import Planar, Scenario

MESHES = "One file (STL or OBJ, meters, in the module's frame) per module, tail first; copied beside the output"


@value
class Urdf:
    """Write a robot to a URDF file, for ROS and most other programs about robots.

    For example: laticauda export urdf mamba.urdf --robot mamba-modules-fin
    """

    output: Output = option("The file to write; an older one is replaced")
    robot: Name = option("A preset (`laticauda robots` lists them) or a TOML file", default="mamba")
    n_links: int | None = quantity(
        "", "Number of links to have instead, for robots whose links are all alike", ge=1, default=None
    )
    meshes: Files = option(MESHES, default=())
    json: bool = option("Print one JSON object", default=False)

    def __call__(self) -> int:
        """Write, and return the exit status."""
        check_output("output", self.output, (".urdf",))
        from laticauda.spatial.export import write_urdf

        robot = load_robot(self.robot, self.n_links)
        write_urdf(self.output, robot, meshes=self.meshes)
        return self._report(robot)

    def _report(self, robot: Robot) -> int:
        """Say what was written."""
        text = f"{self.output}: {robot.name}, {robot.n_links} modules, {robot.mass:.3f} kg, {robot.length:.2f} m"
        print(_json(self.output, robot) if self.json else f"{text} ({_size(self.output):.0f} kB)")
        return 0


@value
class Mjcf(Urdf):
    """Write a robot, and the place that it is in, to an MJCF file that plain MuJoCo opens.

    For example: laticauda export mjcf mamba.xml --robot mamba-modules-fin --tank --actuators servo
    """

    water: MaybeName = option(
        "A preset or a TOML file, paper-lateral if left out; its loads are not in the file, its depth is", default=None
    )
    ground: MaybeName = option("A preset or a TOML file: put the robot on land instead", default=None)
    tank: bool = option("The tank of the experiments around it: 40 m x 6.45 m, 1.5 m deep", default=False)
    root: Literal["free", "planar"] = option("Let the robot move in space, or hold its height and tilt", default="free")
    actuators: Literal["none", "servo"] = option(
        "Servos in the joints, with the angle wanted as their input", default="none"
    )

    def __call__(self) -> int:
        """Write, and return the exit status."""
        check_output("output", self.output, (".xml",))
        for name in ("water", "tank"):
            if self.ground is not None and getattr(self, name):
                raise BadArgument(name, "must not be given with --ground")
        from laticauda.spatial.export import write_mjcf

        robot = load_robot(self.robot, self.n_links)
        place = load_water(self.water or "paper-lateral") if self.ground is None else load_ground(self.ground)
        settings: Any = {name: getattr(self, name) for name in ("tank", "meshes", "root", "actuators")}
        write_mjcf(self.output, robot, place, **settings)
        return self._report(robot)


@value
class Fmu:
    """Write a robot in water to an FMU (co-simulation, Linux on x86-64) that runs without Python.

    Its inputs are the gait's numbers or the references of the joints, and the current; its outputs motion, torques and
    power. Gait, coefficients and start are what it has unless the other tool sets them. It takes a C compiler to write.

    For example: laticauda export fmu mamba.fmu --robot mamba-fin --joints servo --inputs references
    """

    output: Output = option("The file to write (.fmu); an older one is replaced", default="")
    inputs: Literal["gait", "references"] = option(
        "What drives the joints: the gait's numbers, or an angle for every joint (pd and servo)", default="gait"
    )
    fmi: Literal["2.0", "3.0"] = option("Version of the standard; all tools read 2.0", default="2.0")
    names: Names = option("What swims, how and where, by name", default=Names())
    scenario: Scenario = option("What the names stand for; every number can be changed")
    before: Any = option("What the names stand for, before single numbers were changed", default=None)
    json: bool = option("Print one JSON object", default=False)

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "Fmu":
        """The command that was typed.

        Args:
            words: Behind its name.
            prog: What the help calls it.
        """
        flags = list(words)
        names = Names.read(flags, prog)
        scenario, _ = names.scenario([])
        return read(cls, flags, prog, cls(names=names, scenario=scenario, before=scenario))

    def __call__(self) -> int:
        """Write, and return the exit status."""
        if not self.output:
            raise BadFlag("OUTPUT must be given: a file that ends in .fmu.")
        check_output("output", self.output, (".fmu",))
        if self.names.ground is not None:
            raise BadArgument("ground", "must not be given: the robot in an FMU swims in water")
        if not isinstance(self.scenario.model, Planar):
            raise BadArgument("model", "must be `planar`: the spatial model needs MuJoCo, which is not in the FMU")
        from laticauda.cosim.fmu import export_fmu

        scenario = named(self.scenario, self.before)
        warn_of_compiling(scenario)
        variables = export_fmu(self.output, scenario, inputs=self.inputs, fmi=self.fmi)
        count = {kind: sum(v.causality == kind for v in variables) for kind in ("parameter", "input", "output")}
        if self.json:
            print(_json(self.output, scenario.robot, **{f"n_{kind}s": number for kind, number in count.items()}))
        else:
            facts = ", ".join(f"{number} {kind}s" for kind, number in count.items())
            print(f"{self.output}: {scenario.robot.name}, {facts} ({_size(self.output):.0f} kB)")
        return 0


def _json(output: str, robot: Robot, **more: object) -> str:
    done = {"output": output, "robot": robot.name, "n_links": robot.n_links, "mass": robot.mass, "length": robot.length}
    return json.dumps(done | more)


def _size(output: str) -> float:
    """[kB]."""
    return Path(output).stat().st_size / 1000.0
