"""`laticauda lab`: the virtual tank, with the robot on a CAN bus, cameras and a power meter, until Ctrl-C."""

import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any, Literal

import laticauda as lc
from laticauda.cli.command import Command, until_stopped
from laticauda.cli.flags import (
    File,
    Options,
    TrialOutput,
    parse_command,
)
from laticauda.cli.scene import says_coefficients, warn_of_compiling
from laticauda.cli.shared_options import THIS_COMPUTER, host_option, port_option
from laticauda.motion.gaits.gait import list_kinds
from laticauda.robot import Parameters, Robot, Scene, Water, load_parameters, load_robot
from laticauda.scenarios import (
    Model,
    Scenario,
    model_of,
    named_after,
    take_identified_parameters,
    water_for,
)
from laticauda.tank import lab, protocol
from laticauda.values import (
    LOCAL,
    BadArgument,
    check_choice,
    option,
    packaging,
    quantity,
    value_class,
)

NOTICED_DELAY = 0.05
"""From here on, an operator notices that devices answer late [s]."""


@value_class
class Body(Options):
    """What swims, and where.

    Mamba and Mamba with its fin swim like the robot in the tank, with the parameters that were
    identified on it, unless a water, joints, parameters or a coefficient are given.
    """

    mission: str | None = option(
        "A mission, by name or as a file: its robot, water, start, sensors and places (not with a robot or water)",
        default=None,
    )
    robot: str = option(
        "A preset (see `laticauda robots`) or a TOML file; at most 18 joints", default="mamba-fin"
    )
    water: str | None = option(
        "A preset, a TOML file or textbook; none: see `laticauda swim`", default=None
    )
    parameters: str | None = option(
        "A preset or a parameter file: its numbers for water, joints, fin and power instead of the paper's and the "
        "robot's (not with a water)",
        default=None,
    )
    gait: str = option(
        "Kind of gait for which the parameters are, if their numbers differ by gait",
        default="lateral-undulation",
    )
    model: Literal["planar", "spatial"] = option("The model of the body", default="planar")
    scene: str | None = option(
        "Surroundings in space, as for `laticauda swim`, such as tank or pipe", default=None
    )
    joints: str | None = option(
        "Its servos: servo, or speed-servo with speed control; if omitted, the parameters' or servo",
        default=None,
    )

    def __post_init__(self) -> None:
        """Reject a water beside parameters, an unknown kind of gait, and what a mission says itself."""
        if self.mission is not None:
            self._check_beside_mission()
        if self.parameters is not None and self.water is not None:
            raise BadArgument("parameters", "must not be given with `water`: both define the water")
        check_choice("gait", self._gait_kind, list_kinds())

    def _check_beside_mission(self) -> None:
        """Reject what a mission says itself."""
        for name in ("robot", "water", "parameters", "model", "scene", "joints"):
            usual: object = getattr(type(self), name)
            if getattr(self, name) != usual:
                raise BadArgument(name, "must not be given with --mission, which says it itself")

    @cached_property
    def scenario(self) -> Scenario | None:
        """The scenario of the mission; None without one."""
        if self.mission is None:
            return None
        from laticauda.missions import (
            load_mission,
        )  # only with a mission, for missions can be left out

        return load_mission(self.mission)

    @property
    def swimmer(self) -> Robot:
        """The robot, with the numbers of the parameters."""
        if self.scenario is not None:
            return self.scenario.robot
        robot = load_robot(self.robot)
        parameters = self._load_parameters()
        if parameters is None:
            return robot
        return parameters.robot(robot, self._gait_kind)

    @property
    def pool(self) -> Water:
        """The water as loaded."""
        if self.scenario is not None:
            return _water_of(self.scenario)
        parameters = self._load_parameters()
        if parameters is None:
            return water_for(load_robot(self.robot), self.water)
        return parameters.water(self._gait_kind)

    @property
    def law(self) -> lc.JointLaw | str:
        """The law of its servos."""
        if self.scenario is not None:
            joints = self.scenario.model.joints
            return joints if isinstance(joints, lc.Servo) else "servo"
        parameters = self._load_parameters()
        if self.joints is not None:
            return self.joints
        if parameters is None:
            return "servo"
        return parameters.servos

    @property
    def description(self) -> str:
        """What swims, in words."""
        if self.scenario is not None:
            return f"{self.scenario.robot.name} on {self.mission}"
        if self.parameters is None:
            return self.robot
        return f"{self.robot} as {self.parameters}"

    @property
    def _gait_kind(self) -> str:
        return self.gait.replace("-", "_")

    def _load_parameters(self) -> Parameters | None:
        if self.parameters is None:
            return None
        return load_parameters(self.parameters)


@value_class
class Wires(Options):
    """How the tank is reached."""

    bus: str = option(
        "CAN: udp_multicast[:GROUP[:PORT]] for processes, or socketcan[:NAME]",
        default="udp_multicast",
    )
    host: str = host_option("Address of the cameras' server")
    port: int = port_option(22223)
    sensors_port: int = quantity(
        "", "Port of the robot's own sensors; 0: any free one", ge=0, le=65535, default=22224
    )
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
class Lab(Command):
    """Run the virtual tank until Ctrl-C: joint modules on a CAN bus, cameras that QTM clients read, a power meter.

    It prints one line with their addresses. Lines that you type instruct the person at the tank:
    `leak node=5 duration=2` and other faults, `clear`, `carry X Y HEADING_DEG`, `truth`, `help`.

    For example: laticauda lab --robot mamba-fin --position 0 0.5 --seed 1
    """

    body: Body = option("Robot, water and scene", default=Body())
    start: lc.Start = option("Where the straight robot lies", default=lc.Start())
    coefficients: Water = option("Changes to the chosen water")
    servos: lc.JointLaw = option("Parameters of the servos")
    surroundings: Scene = option("Surroundings of the robot", default=Scene())
    wires: Wires = option("How the tank is reached", default=Wires())
    time: Time = option("Clock, random numbers and faults of the tank", default=Time())
    save: TrialOutput = option(
        "Write the true motion since the robot was put into the water (.nc, .csv, ...)",
        default=None,
    )

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> "Lab":
        """Return the command that was typed; see `Command.read`."""
        body: Body = parse_command(Body, arguments, prog, known_only=True)
        if body.scenario is None and not says_coefficients(arguments):
            body = take_identified_parameters(body)
        changes: dict[str, Any] = {"joints": body.law}
        if body.scene is not None:
            changes["scene"] = body.scene
        model = model_of(body.model, **changes)
        start = lc.Start()
        if body.scenario is not None:
            from laticauda.missions import start_of  # only with a mission, as above

            start = start_of(body.scenario)
        default = cls(
            body=body,
            start=start,
            coefficients=body.pool,
            servos=model.joints,
            surroundings=getattr(model, "scene", None) or Scene(),
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
            sensors_port=self.wires.sensors_port,
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
        robot = self.body.swimmer
        water = named_after(self.coefficients, self.body.pool)
        faults = ()
        if self.time.faults is not None:
            faults = lab.load_faults(self.time.faults)
        settings = lab.LabSettings(seed=self.time.seed)
        warn_of_compiling(water, self.body.model, robot)
        plant = lc.build_plant(robot, water, model=self._model())
        virtual_robot = lab.VirtualRobot(robot, plant, self.start, depth=settings.mocap.depth)
        return lab.Tank(virtual_robot, settings, faults)

    def _model(self) -> Model:
        """Return the model that moves the robot; sensors differ by the seed, too."""
        if self.body.scenario is None:
            if self.body.scene is None:
                return model_of(self.body.model, joints=self.servos)
            return model_of(self.body.model, joints=self.servos, scene=self.surroundings)
        model = self.body.scenario.model
        sensors = tuple(
            replace(sensor, seed=sensor.seed + self.time.seed) for sensor in model.sensors
        )
        return replace(model, joints=self.servos, sensors=sensors)

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
            "robot": self.body.description,
            "nodes": len(tank.nodes),
        }
        if addresses.sensors_port is not None:
            facts["sensors"] = f"{host}:{addresses.sensors_port}"
        text = " | ".join(f"{name} {value}" for name, value in facts.items())
        if host == THIS_COMPUTER and not bus.hops:
            text += " (this computer only)"
        self.announce(facts, text)


def _water_of(scenario: Scenario) -> Water:
    """Return the water of a mission."""
    if not isinstance(scenario.environment, Water):
        raise BadArgument("mission", "must be one in water, got one on the ground")
    return scenario.environment


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
