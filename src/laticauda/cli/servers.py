"""`laticauda lab | serve | cockpit`: the virtual tank, robots in water for other programs, and the live page.

Each serves until Ctrl-C, and prints one line with its address.
"""

import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Literal

import laticauda as lc
from laticauda import connect as cosim, robot
from laticauda.cli.command import LOCAL, Command, Outcome, until_stopped
from laticauda.cli.flags import File, Files, Options, ScenarioFile, Stored, parse_command
from laticauda.cli.scene import OfScenario, warn_of_compiling
from laticauda.robot import Scene, Water, load_robot
from laticauda.scenarios import model_of, named_after, water_for
from laticauda.tank import lab, protocol
from laticauda.values import packaging
from laticauda.values.errors import BadArgument
from laticauda.values.files import to_json
from laticauda.values.quantities import option, quantity, value_class

# ---- the virtual tank ----------------------------------------------------------------------------


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
    host: str = option(
        "Address of the cameras' server; 127.0.0.1: this computer only", default="127.0.0.1"
    )
    port: int = quantity("", "Its port; 0: any free one", ge=0, le=65535, default=22223)
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
    save: Stored = option(
        "Write the true motion since the robot was put into the water (.nc, .csv, ...)",
        default=None,
    )

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "LabCommand":
        """Return the command that was typed; see `Command.read`."""
        body: Body = parse_command(Body, words, prog, known_only=True)
        settings = model_of(
            body.model, joints=body.joints, **({} if body.scene is None else {"scene": body.scene})
        )
        scene = getattr(settings, "scene", None) or Scene()
        return parse_command(
            cls,
            words,
            prog,
            cls(body=body, coefficients=body.pool, servos=settings.joints, scene=scene),
        )

    def run(self) -> None:
        """Serve until Ctrl-C, or for the requested duration."""
        bus = protocol.bus_address(self.wires.bus, hops=self.wires.hops)
        if bus.interface == "virtual":
            raise BadArgument(
                "bus", f"must be udp_multicast or socketcan, which other processes reach, got {bus}"
            )
        tank = self._tank()
        served = lab.Lab(
            tank, bus=bus, host=self.wires.host, port=self.wires.port, speed=self.time.speed
        )
        addresses = served.open()
        with until_stopped(served.close):
            self._announce(addresses, tank)
            threading.Thread(target=_listen, args=(served,), daemon=True).start()
            served.run(self.time.duration)
        if served.behind > 0.05:  # s; the operator notices that devices answer late
            print(
                f"Too slow for this `--speed`: the lab was up to {served.behind:.2f} s late.",
                file=sys.stderr,
            )
        if self.save is not None:
            tank.body.trial(packaging.__version__).save(self.save)

    def _tank(self) -> "lab.Tank":
        """Return the requested tank, with its kernels compiled."""
        robot = load_robot(self.body.robot)
        water = named_after(self.coefficients, self.body.pool)
        faults = () if self.time.faults is None else lab.load_faults(self.time.faults)
        settings = lab.LabSettings(seed=self.time.seed)
        warn_of_compiling(water, self.body.model)
        scene = None if self.body.scene is None else self.scene
        body = lc.build_plant(robot, water, model=self.body.model, joints=self.servos, scene=scene)
        return lab.Tank(
            lab.VirtualRobot(robot, body, self.start, depth=settings.mocap.depth), settings, faults
        )

    def _announce(self, addresses: "lab.LabAddresses", tank: "lab.Tank") -> None:
        host, bus = addresses.mocap_host, addresses.bus
        if host not in LOCAL:
            print(
                f"Anyone who reaches {host} can read the cameras: the protocol has no passwords.",
                file=sys.stderr,
            )
        if bus.hops or bus.interface == "socketcan":
            print(
                f"Anyone on {bus} can move the robot: a CAN bus has no passwords.", file=sys.stderr
            )
        qtm = f"{host}:{addresses.mocap_port}"
        line = {"bus": str(bus), "qtm": qtm, "meter": addresses.meter, "nodes": len(tank.nodes)}
        only = "" if host != "127.0.0.1" or bus.hops else " (this computer only)"
        self.announce(line, " | ".join(f"{name} {value}" for name, value in line.items()) + only)


def _listen(served: "lab.Lab") -> None:
    """Carry out the lines on standard input until it ends."""
    with suppress(OSError):  # there is no standard input
        for line in filter(str.strip, sys.stdin or ()):
            try:
                print(
                    served.call(lambda tank, line=line: lab.assist(tank, line)),
                    file=sys.stderr,
                    flush=True,
                )
            except ValueError as error:
                print(error, file=sys.stderr, flush=True)


# ---- robots in water for other programs ----------------------------------------------------------


@value_class
class Serve(Command):
    """Let other programs drive robots over TCP, with lines of JSON, until Ctrl-C; each client has its own world.

    It prints one line with the address and the token that clients on other computers need. Clients
    for C, Julia, GNU Octave and MATLAB come with laticauda; the line also gives their folder.
    Messages: see docs/cosim-protocol.md.

    For example: laticauda serve --port 5055 --max-clients 4
    """

    host: str = option("Address to listen on; 127.0.0.1: this computer only", default="127.0.0.1")
    port: int = quantity("", "Its port; 0: any free one", ge=0, le=65535, default=5055)
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
            found = cosim.message_schema()
            return Outcome(facts=found, text=to_json(found))
        server = cosim.Server(
            self.host, self.port, max_clients=self.max_clients, own_robots=_own(self.robots)
        )
        _compile()
        server.open()
        with until_stopped(server.close):
            token, folder = server.door.token, str(cosim.clients_folder())
            if server.door.warning:
                print(server.door.warning, file=sys.stderr)
            facts = {"host": server.host, "port": server.port, "protocol": cosim.PROTOCOL_VERSION}
            address = f"{server.host}:{server.port} ({f'token {token}' if token else 'this computer only'})"
            text = f"tcp {address} | protocol {cosim.PROTOCOL_VERSION} | clients {folder}"
            self.announce(
                {**facts, "token": token, "clients": folder, "matlab": f"{folder}/matlab"}, text
            )
            server.run()
        return None


def _own(files: tuple[str, ...]) -> dict[str, lc.Robot]:
    """Return the robots in files, by the names of the files.

    Raises:
        ValueError: If a preset or another file has the same name.
    """
    found: dict[str, lc.Robot] = {}
    for file in files:
        name = Path(file).stem
        if name in found or name in robot.robot_names():
            raise BadArgument(
                "robots", f"must have unique names, got {file}: there is another `{name}`"
            )
        found[name] = lc.load_robot(Path(file))
    return found


def _compile() -> None:
    """Compile the kernels, so that no client's first step waits for the compiler."""
    water = lc.load_water("paper-lateral")
    warn_of_compiling(water)
    command = lc.Command(gait=lc.lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0))
    body = lc.build_plant(lc.load_robot("mamba"), water)
    body.step(body.init(lc.Start(), command), command, 1e-3)


# ---- the live page -------------------------------------------------------------------------------


@value_class
class CockpitCommand(OfScenario):
    """Serve a page on which the robot swims, until Ctrl-C; everything on it can be changed while the robot swims.

    It prints one line with the page's address, which contains a token if other computers can reach
    the page. Anyone who opens the page can use all of its controls.

    For example: laticauda cockpit --robot mamba-fin --port 8080
    """

    file: ScenarioFile = option(
        "Scenario file (.toml) that the options modify; must come first", default=None
    )
    operated: str | None = option(
        "Show the robot of this recording, or folder, while it is operated", default=None
    )
    load: str | None = option(
        "Play back this trial or recording of an operation beside it", default=None
    )
    host: str = option("Address of the page; 127.0.0.1: this computer only", default="127.0.0.1")
    port: int = quantity("", "Its port; 0: any free one", ge=0, le=65535, default=8080)

    def run(self) -> None:
        """Serve until Ctrl-C."""
        from laticauda.show.cockpit import Cockpit, Live, pages

        pages.load_viser()
        scenario = self.chosen
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
