"""`laticauda-ros2`: a robot of a scenario as a node of ROS 2, until Ctrl-C."""

import sys
from collections.abc import Sequence
from threading import Event
from typing import Annotated, Literal

import tyro

from laticauda.cli.command import Command, Outcome, until_stopped
from laticauda.cli.flag_types import TrialOutput
from laticauda.cli.own_program import run_program
from laticauda.connect.vehicle_record import save_record
from laticauda.scenarios import load_scenario
from laticauda.values import BadArgument, option, quantity, value_class
from laticauda_ros2.drive import Drive, load_drive
from laticauda_ros2.node import TOPIC, name_and_domain
from laticauda_ros2.vehicle_node import VehicleNode

PROGRAM = "laticauda-ros2"


@value_class
class Serve(Command):
    """Serve the robot of a scenario to ROS 2: `cmd_vel` or joint positions in; odometry, joints, IMU, ranges, tf out.

    For example: laticauda-ros2 eel.toml --drive eel-drive.toml --namespace /eel
    """

    scenario: Annotated[str, tyro.conf.Positional] = option("TOML file of the scenario")
    drive: str | None = option(
        "TOML file of how the robot does what a Twist asks for", default=None
    )
    namespace: str | None = option("Namespace of the topics, such as /eel", default=None)
    domain: int | None = quantity(
        "", "Domain of DDS; that of ROS_DOMAIN_ID, or 0, if omitted", ge=0, le=232, default=None
    )
    rate: float = quantity("Hz", "Steps and messages per second", gt=0.0, le=1000.0, default=50.0)
    speed: float = quantity(
        "", "How much faster than real time; 0: as fast as possible", ge=0.0, default=1.0
    )
    distribution: Literal["humble", "jazzy", "kilted"] = option(
        "ROS 2 of the others, which decides what a Range is", default="jazzy"
    )
    save: TrialOutput = option(
        "Write the run since the last reset at the end, up to an hour of it (.nc and others)",
        default=None,
    )

    def run(self) -> Outcome:
        """Serve until Ctrl-C."""
        if self.namespace and not TOPIC.fullmatch(self.namespace):
            raise BadArgument("namespace", f"must be such as /eel, got {self.namespace!r}")
        domain = self.domain
        if domain is None:
            _, domain = name_and_domain("")
        node = VehicleNode(
            load_scenario(self.scenario),
            load_drive(self.drive) if self.drive else Drive(),
            domain=domain,
            space=self.namespace or "",
            rate=self.rate,
            is_humble=self.distribution == "humble",
        )
        with until_stopped(node.close):
            topics = " ".join(node.topics)
            self.announce({"domain": domain, "topics": node.topics}, f"domain {domain} | {topics}")
            node.run(Event().is_set, self.speed)
        save_record(node.record, self.save)
        facts = {"refused": node.n_refused}
        return Outcome(facts=facts, text=f"messages that made no sense: {node.n_refused}")


def main(words: Sequence[str] | None = None) -> int:
    """Run the program.

    Args:
        words: Words after the program's name; None takes those of this process.

    Returns:
        The exit status: 0 success, 2 bad input or a run that diverged.
    """
    return run_program(Serve, PROGRAM, words)


if __name__ == "__main__":
    sys.exit(main())
