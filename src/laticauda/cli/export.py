"""`laticauda export mjcf | urdf | fmu | c | web`: a robot as a file for other programs."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import laticauda as lc
from laticauda.cli import command, flags
from laticauda.cli.scene import OfScenario, warn_of_compiling
from laticauda.scenarios import load_scenario
from laticauda.sensing import Place
from laticauda.values import BadArgument, option, quantity, value_class

CAUSALITIES = ("parameter", "input", "output")
"""Kinds of variables that are counted."""
OUTPUT = "File to write; an existing one is replaced"


@value_class
class Urdf(command.Command):
    """Write a robot to a URDF file, for ROS and most other robotics software.

    For example: laticauda export urdf --robot mamba-modules-fin --output mamba.urdf
    """

    output: Annotated[flags.RequiredFile, flags.OutputFile((".urdf",))] = option(OUTPUT)
    robot: str = option("A preset (`laticauda robots` lists them) or a TOML file", default="mamba")
    n_links: int | None = quantity(
        "", "Another number of links, if all links are alike", ge=1, default=None
    )
    meshes: flags.Files = option(
        "STL or OBJ per module, tail first (in meters, its frame); copied", default=()
    )

    def run(self) -> command.Outcome:
        """Write the file."""
        robot = lc.load_robot(self.robot, self.n_links)
        self.write(robot)
        content = f"{robot.n_links} modules, {robot.mass:.3f} kg, {robot.length:.2f} m"
        return _report(self.output, robot, content, {})

    def write(self, robot: lc.Robot) -> None:
        """Write the file.

        Args:
            robot: Robot to write.
        """
        from laticauda.models.spatial import write_urdf

        write_urdf(self.output, robot, meshes=self.meshes)


@value_class
class Mjcf(Urdf):
    """Write a robot and its surroundings to an MJCF file that plain MuJoCo opens.

    For example: laticauda export mjcf --robot mamba-modules-fin --scene tank --actuators servo
    --output mamba.xml
    """

    output: Annotated[flags.RequiredFile, flags.OutputFile((".xml",))] = option(OUTPUT)
    water: str | None = option(
        "A preset or TOML file; only its depth is written (none: paper-lateral)", default=None
    )
    ground: str | None = option(
        "A preset or a TOML file: put the robot on land instead", default=None
    )
    scene: str | None = option(
        "Surroundings: tank, pegs, slope, pipe, shore, height-field or MJCF file", default=None
    )
    root: Literal["free", "planar"] = option(
        "Let the robot move in space, or hold its height and tilt", default="free"
    )
    actuators: Literal["none", "servo"] = option(
        "Servos in the joints, whose input is the angle", default="none"
    )

    def write(self, robot: lc.Robot) -> None:
        """Write the file; see `Urdf.write`."""
        if self.ground is not None and self.water:
            raise BadArgument("water", "must not be given with --ground")
        from laticauda.models.spatial.mjcf import write_mjcf

        environment: Any = None
        if self.ground is None:
            environment = lc.load_water(self.water or "paper-lateral")
        else:
            environment = lc.load_ground(self.ground)
        settings: Any = {
            name: getattr(self, name) for name in ("scene", "meshes", "root", "actuators")
        }
        write_mjcf(self.output, robot, environment, **settings)


@value_class
class Compiled(OfScenario):
    """A command that exports a robot in water as machine code."""

    output: Annotated[flags.RequiredFile, flags.OutputFile((".fmu",))] = option(
        f"{OUTPUT} (.fmu)", default=flags.REQUIRED
    )
    inputs: Literal["gait", "references"] = option(
        "Gait parameters, or joint angles (pd, servo)", default="gait"
    )

    def write_with(self, write: Callable[..., Sequence[Any]], *settings: str) -> command.Outcome:
        """Write the file.

        Args:
            write: Function that writes the file and returns the variables.
            settings: Names of the options that it takes, besides `inputs`.
        """
        scenario = self._scenario_to_compile()
        options = {name: getattr(self, name) for name in ("inputs", *settings)}
        variables = write(self.output, scenario, **options)
        n_of = Counter(variable.causality for variable in variables)
        counts: list[str] = []
        facts: dict[str, object] = {}
        for causality in CAUSALITIES:
            counts.append(f"{n_of[causality]} {causality}s")
            facts[f"n_{causality}s"] = n_of[causality]
        return _report(self.output, scenario.robot, ", ".join(counts), facts)

    def _scenario_to_compile(self) -> lc.Scenario:
        """Return the scenario; refuse one that cannot be compiled."""
        scenario = self.scenario_to_run
        if not isinstance(scenario.environment, lc.Water):
            raise BadArgument("ground", "must not be given: the exported robot swims in water")
        if not isinstance(scenario.model, lc.Planar):
            rule = "must be `planar`: the spatial model needs MuJoCo, which is not exported"
            raise BadArgument("model", rule)
        warn_of_compiling(scenario.environment, scenario.model, scenario.robot)
        return scenario


@value_class
class Fmu(Compiled):
    """Write a robot in water to an FMU (co-simulation) that runs without Python.

    Its inputs are the gait parameters or the joint references, and the current; its outputs are
    motion, torques and power. Gait, coefficients and start keep their values unless the importing
    tool sets them. Writing the file requires a C compiler and, for platforms other than this one,
    the package ziglang.

    For example: laticauda export fmu --robot mamba-fin --joints servo --inputs references --output
    mamba.fmu
    """

    fmi: Literal["2.0", "3.0"] = option(
        "Version of the standard; all tools read 2.0", default="2.0"
    )
    platform: flags.NameList = option(
        "linux64, aarch64 (Linux), win64, darwin; this machine's if omitted", default=()
    )
    author: str | None = option("Author of the model, as stated in the FMU", default=None)
    model_version: str | None = option("Version of the model; laticauda's if omitted", default=None)
    license: str = option("License of the model", default="MIT")

    def run(self) -> command.Outcome:
        """Write the file."""
        from laticauda.connect.fmu import export_fmu

        return self.write_with(export_fmu, "fmi", "platform", "author", "model_version", "license")


@value_class
class C(Compiled):
    """Write a robot in water to a C library that runs without Python, with a header that describes its contents.

    For onboard computers, and any program that can call C. The header lists the variables, which
    are those of an FMU, with units and ranges. Writing the files requires a C compiler and, for
    other platforms, the package ziglang.

    For example: laticauda export c --robot mamba-fin --platform aarch64 --static --output mamba.h
    """

    output: Annotated[flags.RequiredFile, flags.OutputFile((".h",))] = option(
        "Header to write (.h); the library is written next to it", default=flags.REQUIRED
    )
    platform: str | None = option(
        "linux64, aarch64 (Linux), win64, darwin; this machine's if omitted", default=None
    )
    static: bool = option("Write a static library instead of a shared one", default=False)

    def run(self) -> command.Outcome:
        """Write the files."""
        from laticauda.connect.native import export_c

        return self.write_with(export_c, "platform", "static")


@value_class
class Web(command.Command):
    """Write a page on which robots swim: a folder of files that needs no server; open its index.html in a browser.

    For example: laticauda export web --robots mamba-fin amphibot --output page
    """

    output: flags.Folder = option("Folder to write; files of an existing page are replaced")
    robots: flags.Files = option(
        "Presets or TOML files, the first one shown first; none: a selection", default=()
    )
    places: flags.File = option(
        "Scenario file, or mission, whose nets, pipes, walls, docks and buoys are drawn in the water",
        default=None,
    )

    def run(self) -> command.Outcome:
        """Write the files."""
        from laticauda.connect.web import export_web

        places: tuple[Place, ...] = ()
        if self.places is not None:
            places = _read_places(self.places)
        paths = export_web(self.output, self.robots, places=places)
        sizes = [path.stat().st_size for path in paths]
        size = sum(sizes)
        content = f"{len(sizes)} files ({size / 1000.0:.0f} kB)"
        return command.Outcome(
            facts={"output": self.output, "size": size},
            text=f"{self.output}: {content}; open {self.output}/index.html",
        )


def _read_places(name: str) -> tuple[Place, ...]:
    """Return the places of a scenario file, or of a mission that comes with laticauda."""
    if Path(name).suffix == ".toml":
        scenario = load_scenario(name)
    else:
        # Only here, for missions can be left out.
        from laticauda.missions import load_mission

        scenario = load_mission(name)
    if not scenario.model.places:
        raise BadArgument("places", f"must be a scenario with places, got {name}")
    return scenario.model.places


def _report(
    output: str, robot: lc.Robot, content: str, further_facts: Mapping[str, object]
) -> command.Outcome:
    """Report what was written.

    Args:
        output: The file.
        robot: The robot in it.
        content: What else is in it, in words.
        further_facts: Those of this format, for JSON.
    """
    facts = {
        "output": output,
        "robot": robot.name,
        "n_links": robot.n_links,
        "mass": robot.mass,
        "length": robot.length,
        **further_facts,
    }
    kilobytes = Path(output).stat().st_size / 1000.0
    text = f"{output}: {robot.name}, {content} ({kilobytes:.0f} kB)"
    return command.Outcome(facts=facts, text=text)
