"""`laticauda serve`: robots in water for other programs, until Ctrl-C."""

import sys
from pathlib import Path

import laticauda as lc
from laticauda import connect as cosim, robot
from laticauda.cli.command import Command, Outcome, until_stopped
from laticauda.cli.flags import Files
from laticauda.cli.scene import warn_of_compiling
from laticauda.cli.shared_options import host_option, port_option
from laticauda.values import BadArgument, option, quantity, to_json, value_class


@value_class
class Serve(Command):
    """Let other programs drive robots over TCP, with lines of JSON, until Ctrl-C; each client has its own world.

    It prints one line with the address and the token that clients on other computers need. Clients
    for C, Julia, GNU Octave and MATLAB come with laticauda; the line also gives their folder.
    Messages: see docs/cosim-protocol.md.

    For example: laticauda serve --port 5055 --max-clients 4
    """

    host: str = host_option("Address to listen on")
    port: int = port_option(5055)
    max_clients: int = quantity(
        "", "Maximum number of clients connected at a time", ge=1, default=16
    )
    robots: Files = option(
        "TOML files of robots that clients may name (without .toml) like presets", default=()
    )

    schema: bool = option("Print the JSON Schema of all messages, and exit", default=False)

    def run(self) -> Outcome | None:
        """Serve until Ctrl-C."""
        if self.schema:
            schema = cosim.message_schema()
            return Outcome(facts=schema, text=to_json(schema))
        server = cosim.Server(
            self.host,
            self.port,
            max_clients=self.max_clients,
            own_robots=_load_own_robots(self.robots),
        )
        _compile()
        server.open()
        with until_stopped(server.close):
            self._announce_address(server)
            server.run()
        return None

    def _announce_address(self, server: "cosim.Server") -> None:
        token = server.access.token
        folder = str(cosim.clients_folder())
        if server.access.warning:
            print(server.access.warning, file=sys.stderr)
        reach = "this computer only"
        if token:
            reach = f"token {token}"
        facts = {
            "host": server.host,
            "port": server.port,
            "protocol": cosim.PROTOCOL_VERSION,
            "token": token,
            "clients": folder,
            "matlab": f"{folder}/matlab",
        }
        address = f"{server.host}:{server.port} ({reach})"
        text = f"tcp {address} | protocol {cosim.PROTOCOL_VERSION} | clients {folder}"
        self.announce(facts, text)


def _load_own_robots(files: tuple[str, ...]) -> dict[str, lc.Robot]:
    """Return the robots in files, by the names of the files.

    Raises:
        ValueError: If a preset or another file has the same name.
    """
    own_robots: dict[str, lc.Robot] = {}
    for file in files:
        name = Path(file).stem
        if name in own_robots or name in robot.robot_names():
            rule = f"must have unique names, got {file}: there is another `{name}`"
            raise BadArgument("robots", rule)
        own_robots[name] = lc.load_robot(Path(file))
    return own_robots


def _compile() -> None:
    """Compile the kernels, so that no client's first step waits for the compiler."""
    water = lc.load_water("paper-lateral")
    warn_of_compiling(water)
    resting_gait = lc.lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0)
    command = lc.Command(gait=resting_gait)
    plant = lc.build_plant(lc.load_robot("mamba"), water)
    state = plant.init(lc.Start(), command)
    plant.step(state, command, 1e-3)
