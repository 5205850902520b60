"""`laticauda serve`: robots in water for other programs, with one line that says where to reach them."""

import json
import sys
from pathlib import Path

from laticauda.cli.flags import Files, Text
from laticauda.cli.scene import COMPILING
from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot, load_robot, load_water, robot_names


@value
class Serve:
    """Let other programs drive robots over TCP, with lines of JSON, until Ctrl-C; each client has a world of its own.

    It prints one line that says where. A client for GNU Octave and MATLAB comes with laticauda; its folder is in the
    line too. The messages: docs/cosim-protocol.md.

    For example: laticauda serve --port 5055 --max-clients 4
    """

    host: Text = option("Where to listen; 127.0.0.1 is this computer alone", default="127.0.0.1")
    port: int = quantity("", "Likewise; 0: any that is free", ge=0, le=65535, default=5055)
    max_clients: int = quantity("", "How many may be connected at a time", ge=1, default=16)
    robots: Files = option(
        "TOML files of robots that clients may ask for by their file's name without .toml, besides the presets",
        default=(),
    )
    json: bool = option("Print the line as a JSON object", default=False)

    def __call__(self) -> int:
        """Serve, and return the exit status."""
        from laticauda.cosim import PROTOCOL_VERSION, Server, matlab_folder

        server = Server(self.host, self.port, max_clients=self.max_clients, own_robots=_own(self.robots))
        _compile()
        server.open()
        try:
            self._announce(server.host, server.port, PROTOCOL_VERSION, str(matlab_folder()))
            server.run()
        except KeyboardInterrupt:
            print("stopped.", file=sys.stderr)
        finally:
            server.close()
        return 0

    def _announce(self, host: str, port: int, protocol: int, folder: str) -> None:
        only = host in ("127.0.0.1", "localhost", "::1")
        if not only:
            print(
                f"Anyone who reaches {host} can use this computer's time: the protocol knows no passwords.",
                file=sys.stderr,
            )
        if self.json:
            line = {"host": host, "port": port, "protocol": protocol, "matlab": folder}
            print(json.dumps(line), flush=True)
        else:
            note = " (this computer only)" if only else ""
            print(f"tcp {host}:{port}{note} | protocol {protocol} | matlab {folder}", flush=True)


def _own(files: tuple[str, ...]) -> dict[str, Robot]:
    """The robots in files by the names of the files.

    Raises:
        ValueError: If a preset, or another one, has that name.
    """
    found: dict[str, Robot] = {}
    for file in files:
        name = Path(file).stem
        if name in found or name in robot_names():
            raise BadArgument("robots", f"must have names of their own, got {file}: there is another `{name}`")
        found[name] = load_robot(Path(file))
    return found


def _compile() -> None:
    """Let nobody's first step wait for the compiler."""
    from laticauda.interfaces import Command, Start
    from laticauda.simulate import needs_compiling, plant

    water = load_water("paper-lateral")
    if needs_compiling(water):
        print(COMPILING, file=sys.stderr, flush=True)
    from laticauda.gaits import lateral_undulation

    command = Command(gait=lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0))
    body = plant(load_robot("mamba"), water)
    body.step(body.init(Start(), command), command, 1e-3)
