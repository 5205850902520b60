"""`laticauda serve`: robots in water for other programs, with one line that says where to reach them."""

import sys
from pathlib import Path

import laticauda as lc
from laticauda import cosim, robot
from laticauda.cli import flags, scene
from laticauda.cli.command import LOCAL, Command, until_stopped
from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value


@value
class Serve(Command):
    """Let other programs drive robots over TCP, with lines of JSON, until Ctrl-C; each client has a world of its own.

    It prints one line that says where. A client for GNU Octave and MATLAB comes with laticauda; its folder is in the
    line too. The messages: docs/cosim-protocol.md.

    For example: laticauda serve --port 5055 --max-clients 4
    """

    host: str = option("Where to listen; 127.0.0.1 is this computer alone", default="127.0.0.1")
    port: int = quantity("", "Likewise; 0: any that is free", ge=0, le=65535, default=5055)
    max_clients: int = quantity("", "How many may be connected at a time", ge=1, default=16)
    robots: flags.Files = option("TOML files of robots that clients may name, without .toml, like presets", default=())

    def run(self) -> None:
        """Serve until Ctrl-C."""
        server = cosim.Server(self.host, self.port, max_clients=self.max_clients, own_robots=_own(self.robots))
        _compile()
        server.open()
        with until_stopped(server.close):
            only = " (this computer only)"
            if server.host not in LOCAL:
                warning = "can use this computer's time: the protocol knows no passwords."
                print(f"Anyone who reaches {server.host} {warning}", file=sys.stderr)
                only = ""
            facts = {"host": server.host, "port": server.port, "protocol": cosim.PROTOCOL_VERSION}
            address = f"{server.host}:{server.port}"
            folder = str(cosim.matlab_folder())
            text = f"tcp {address}{only} | protocol {cosim.PROTOCOL_VERSION} | matlab {folder}"
            self.announce({**facts, "matlab": folder}, text)
            server.run()


def _own(files: tuple[str, ...]) -> dict[str, lc.Robot]:
    """The robots in files by the names of the files.

    Raises:
        ValueError: If a preset, or another one, has that name.
    """
    found: dict[str, lc.Robot] = {}
    for file in files:
        name = Path(file).stem
        if name in found or name in robot.robot_names():
            raise BadArgument("robots", f"must have names of their own, got {file}: there is another `{name}`")
        found[name] = lc.load_robot(Path(file))
    return found


def _compile() -> None:
    """Let nobody's first step wait for the compiler."""
    water = lc.load_water("paper-lateral")
    scene.warn_of_compiling(water)
    command = lc.Command(gait=lc.lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0))
    body = lc.plant(lc.load_robot("mamba"), water)
    body.step(body.init(lc.Start(), command), command, 1e-3)
