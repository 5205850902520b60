"""`laticauda import farms`: an animat of FARMS as a robot file, with what was not taken."""

from typing import Annotated

from laticauda import robot
from laticauda.cli import command, flags
from laticauda.control import PhaseOscillators
from laticauda.motion.joints import JointLaw
from laticauda.values import (
    BadArgument,
    encode,
    name_of,
    option,
    quantity,
    stamped,
    value_class,
    write,
)


@value_class
class Farms(command.Command):
    """Read an animat of FARMS, say what is taken and what is not, and write it as a robot file.

    For example: laticauda import farms animat_config.yaml --output my-amphibot.toml
    """

    file: flags.FileArgument = option("The animat's YAML file, or an SDF or MJCF file alone")
    output: Annotated[flags.File, flags.OutputFile((".toml",))] = option(
        "Robot file to write (.toml); an existing one is replaced", default=None
    )
    morphology: flags.File = option(
        "SDF or MJCF file of the bodies; if omitted, the one that the YAML file names", default=None
    )
    head: str | None = option("Name of the head's link; the root if omitted", default=None)
    drive: float | None = quantity(
        "", "Descending drive in place of that in the file", default=None
    )
    drag: bool = option("Write the drag of FARMS on the modules, too", default=False)

    def run(self) -> command.Outcome:
        """Read, and write if requested."""
        from laticauda.connect import load_farms

        animat = load_farms(self.file, morphology=self.morphology, head=self.head, drive=self.drive)
        written = animat.robot
        if self.drag:
            if animat.robot_with_drag is None:
                raise BadArgument("drag", f"must not be given: {self.file} states no drag")
            written = animat.robot_with_drag
        text = animat.words
        if self.output is not None:
            write(self.output, robot.to_toml(written))
            text = f"{text}\n{self.output}: written"
        facts = {
            "robot": robot.summarize_robot(written),
            "links": animat.links,
            "joint_names": animat.joint_names,
            "network": _encode(animat.network),
            "joints": _encode(animat.joints),
            "left_out": animat.left_out,
            "output": self.output,
        }
        return command.Outcome(facts=facts, text=text)


def _encode(content: PhaseOscillators | JointLaw | None) -> object:
    if content is None:
        return None
    return stamped(name_of(type(content)), encode(content))
