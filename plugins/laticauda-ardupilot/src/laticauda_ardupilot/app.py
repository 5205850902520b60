"""`laticauda-ardupilot`: a robot that waits for ArduPilot, until Ctrl-C."""

import sys
from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated

import tyro

from laticauda.cli.command import Command, Outcome, until_stopped
from laticauda.cli.flag_types import TrialOutput
from laticauda.cli.own_program import run_program
from laticauda.connect.vehicle_record import save_record
from laticauda.scenarios import load_scenario
from laticauda.values import LOCAL, check_label, option, quantity, value_class
from laticauda_ardupilot.lock_step import LockStep
from laticauda_ardupilot.mixing import FILES, load_mixing
from laticauda_ardupilot.server import PORT, Server
from laticauda_ardupilot.vehicle import Vehicle

PROGRAM = "laticauda-ardupilot"
STRANGERS = "Anyone who can reach this computer can drive the robot: the protocol has no passwords."
"""What is said where other computers are let in."""
FIRST_FRAME = 1e-3
"""Duration of the frame before the first, which compiles what is not compiled yet [s]."""


@value_class
class Serve(Command):
    """Let ArduPilot drive a robot by its JSON SITL protocol, in lock step, until Ctrl-C.

    For example: laticauda-ardupilot eel; then start ArduSub with --model JSON:127.0.0.1
    """

    scenario: Annotated[str, tyro.conf.Positional] = option(
        "TOML file of the scenario, or `eel`", default="eel"
    )
    mixing: str | None = option(
        "TOML file of what the servo outputs do; `eel` if omitted", default=None
    )
    host: str = option(
        "Address to listen on; 0.0.0.0 lets other computers drive",
        default="127.0.0.1",
        check=check_label,
    )
    port: int = quantity("", "UDP port; 0 takes a free one", ge=0, le=65535, default=PORT)
    save: TrialOutput = option(
        "Write the run since the last reset at the end, up to an hour of it (.nc and others)",
        default=None,
    )

    def run(self) -> Outcome | None:
        """Serve until Ctrl-C."""
        path = FILES / "eel.toml" if self.scenario == "eel" else self.scenario
        vehicle = Vehicle(load_scenario(path), load_mixing(self.mixing or "eel"))
        # Compile before anybody waits.
        vehicle.step((), FIRST_FRAME)
        vehicle.reset()
        if self.host not in LOCAL:
            print(STRANGERS, file=sys.stderr)
        lock_step = LockStep(vehicle)
        server = Server(lock_step, self.host, self.port)
        facts = {"host": server.host, "port": server.port, "parameters": str(FILES / "eel.parm")}
        with until_stopped(server.close):
            self.announce(
                facts, f"udp {server.host}:{server.port} | parameters {facts['parameters']}"
            )
            server.run()
        save_record(vehicle.robot.record, self.save)
        counts = asdict(lock_step.counts)
        lines = [f"{name}: {count}" for name, count in counts.items()]
        return Outcome(facts=counts, text=", ".join(lines))


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
