"""`laticauda lab | serve | cockpit`: the virtual tank, robots in water for other programs, and the live page.

Each serves until Ctrl-C, and prints one line with its address.
"""

import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

import laticauda as lc
from laticauda import connect as cosim, robot
from laticauda.cli.command import Command, Outcome, until_stopped
from laticauda.cli.flags import File, Files, Options, TrialOutput, parse_command
from laticauda.cli.scene import OfScenarioOrFile, warn_of_compiling
from laticauda.cli.shared_options import THIS_COMPUTER, host_option, port_option
from laticauda.robot import Scene, Water, load_robot
from laticauda.scenarios import model_of, named_after, water_for
from laticauda.tank import lab, protocol
from laticauda.values import LOCAL, BadArgument, option, packaging, quantity, to_json, value_class

# ---- the virtual tank ----------------------------------------------------------------------------


NOTICED_DELAY = 0.05
"""From here on, an operator notices that devices answer late [s]."""


@value_class
class Body(Options):
    """What swims, and where."""

    robot: str = option(
        "A preset (see `laticauda robots`) or a TOML file; at most 18 joints",
        default="mamba-modules",
    )
    water: str | None = option(
        "A preset, a TOML file or textbook; none: see `laticauda swim`", default=None
    )
    model: Literal["planar", "spatial"] = option("The model of the body", default="planar")
    scene: str | None = option(
        "Surroundings in space, as for `laticauda swim`, such as tank or pipe", default=None
    )
    joints: str = option("Its servos: servo, or speed-servo with speed control", default="servo")

    @property
    def pool(self) -> Water:
        """The water as loaded."""
        return water_for(load_robot(self.robot), self.water)


@value_class
class Wires(Options):
    """How the tank is reached."""

    bus: str = option(
        "CAN: udp_multicast[:GROUP[:PORT]] for processes, or socketcan[:NAME]",
        default="udp_multicast",
    )
    host: str = host_option("Address of the cameras' server")
    port: int = port_option(22223)
    hops: int = quantity(
        "", "Hop limit of udp_multicast frames; 0: this computer, 1: this network", ge=0, default=0
    )


@value_class
class Time(Options):
    """Clock, random numbers and faults of the tank."""

    speed: float = quantity("", "Seconds in the lab per second of real time", gt=0.0, default=1.0)
    duration: float | None = quantity(
        "s", "Duration by the lab's clock; none: until Ctrl-C", default=None
    )
    seed: int = quantity("", "Seed of all random numbers", ge=0, default=0)
    faults: File = option("Schedule of faults (.toml)", default=None)


@value_class
class LabCommand(Command):
    """Run the virtual tank until Ctrl-C: joint modules on a CAN bus, cameras that QTM clients read, a power meter.

    It prints one line with their addresses. Lines that you type instruct the person at the tank:
    `leak node=5 duration=2` and other faults, `clear`, `carry X Y HEADING_DEG`, `truth`, `help`.

    For example: laticauda lab --robot mamba-modules --position 0 0.5 --seed 1
    """

    body: Body = option("Robot, water and scene", default=Body())
    start: lc.Start = option("Where the straight robot lies", default=lc.Start())
    coefficients: Water = option("Changes to the chosen water")
    servos: lc.JointLaw = option("Parameters of the servos")
    scene: Scene = option("Surroundings of the robot", default=Scene())
    wires: Wires = option("How the tank is reached", default=Wires())
    time: Time = option("Clock, random numbers and faults of the tank", default=Time())
    save: TrialOutput = option(
        "Write the true motion since the robot was put into the water (.nc, .csv, ...)",
        default=None,
    )

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> "LabCommand":
        """Return the command that was typed; see `Command.read`."""
        body: Body = parse_command(Body, arguments, prog, known_only=True)
        changes: dict[str, Any] = {"joints": body.joints}
        if body.scene is not None:
            changes["scene"] = body.scene
        model = model_of(body.model, **changes)
        default = cls(
            body=body,
            coefficients=body.pool,
            servos=model.joints,
            scene=getattr(model, "scene", None) or Scene(),
        )
        return parse_command(cls, arguments, prog, default)

    def run(self) -> None:
        """Serve until Ctrl-C, or for the requested duration."""
        bus = protocol.bus_address(self.wires.bus, hops=self.wires.hops)
        if bus.interface == "virtual":
            rule = "must be udp_multicast or socketcan, which other processes reach"
            raise BadArgument("bus", f"{rule}, got {bus}")
        tank = self._tank()
        server = lab.Lab(
            tank,
            bus=bus,
            host=self.wires.host,
            port=self.wires.port,
            speed=self.time.speed,
        )
        addresses = server.open()
        with until_stopped(server.close):
            self._announce_addresses(addresses, tank)
            threading.Thread(target=_obey_lines, args=(server,), daemon=True).start()
            server.run(self.time.duration)
        if server.behind > NOTICED_DELAY:
            delay = f"the lab was up to {server.behind:.2f} s late"
            print(f"Too slow for this `--speed`: {delay}.", file=sys.stderr)
        if self.save is not None:
            tank.body.trial(packaging.__version__).save(self.save)

    def _tank(self) -> "lab.Tank":
        """Return the requested tank, with its kernels compiled."""
        robot = load_robot(self.body.robot)
        water = named_after(self.coefficients, self.body.pool)
        faults = ()
        if self.time.faults is not None:
            faults = lab.load_faults(self.time.faults)
        settings = lab.LabSettings(seed=self.time.seed)
        warn_of_compiling(water, self.body.model)
        scene = None
        if self.body.scene is not None:
            scene = self.scene
        plant = lc.build_plant(robot, water, model=self.body.model, joints=self.servos, scene=scene)
        virtual_robot = lab.VirtualRobot(robot, plant, self.start, depth=settings.mocap.depth)
        return lab.Tank(virtual_robot, settings, faults)

    def _announce_addresses(self, addresses: "lab.LabAddresses", tank: "lab.Tank") -> None:
        host, bus = addresses.mocap_host, addresses.bus
        if host not in LOCAL:
            warning = f"Anyone who reaches {host} can read the cameras"
            print(f"{warning}: the protocol has no passwords.", file=sys.stderr)
        if bus.hops or bus.interface == "socketcan":
            warning = f"Anyone on {bus} can move the robot"
            print(f"{warning}: a CAN bus has no passwords.", file=sys.stderr)
        facts = {
            "bus": str(bus),
            "qtm": f"{host}:{addresses.mocap_port}",
            "meter": addresses.meter,
            "nodes": len(tank.nodes),
        }
        text = " | ".join(f"{name} {value}" for name, value in facts.items())
        if host == THIS_COMPUTER and not bus.hops:
            text += " (this computer only)"
        self.announce(facts, text)


def _obey_lines(server: "lab.Lab") -> None:
    """Carry out the lines on standard input until it ends."""
    with suppress(OSError):  # there is no standard input
        for line in filter(str.strip, sys.stdin or ()):
            print(_obey(server, line), file=sys.stderr, flush=True)


def _obey(server: "lab.Lab", line: str) -> object:
    """Carry out a line, and return the answer."""
    try:
        return server.call(lambda tank: lab.assist(tank, line))
    except ValueError as error:
        return error


# ---- robots in water for other programs ----------------------------------------------------------


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


# ---- the live page -------------------------------------------------------------------------------


@value_class
class CockpitCommand(OfScenarioOrFile):
    """Serve a page on which the robot swims, until Ctrl-C; everything on it can be changed while the robot swims.

    It prints one line with the page's address, which contains a token if other computers can reach
    the page. Anyone who opens the page can use all of its controls.

    For example: laticauda cockpit --robot mamba-fin --port 8080
    """

    operated: str | None = option(
        "Show the robot of this recording, or folder, while it is operated", default=None
    )
    load: str | None = option(
        "Play back this trial or recording of an operation beside it", default=None
    )
    host: str = host_option("Address of the page")
    port: int = port_option(8080)

    def run(self) -> None:
        """Serve until Ctrl-C."""
        from laticauda.show.cockpit import Cockpit, Live, load_viser

        load_viser()
        scenario = self.scenario_to_run
        warn_of_compiling(scenario.environment, scenario.model)
        cockpit = Cockpit(Live(scenario), host=self.host, port=self.port)
        if cockpit.door.warning:
            print(cockpit.door.warning, file=sys.stderr)
        with until_stopped(cockpit.close):
            if self.load is not None:
                cockpit.load(Path(self.load))
            if self.operated is not None:
                cockpit.operated.watch(Path(self.operated))
            cockpit.open()
            self.announce({"address": cockpit.address}, cockpit.address)
            cockpit.wait()
