"""`laticauda lab`: the virtual tank, with one line that says where to reach it."""

import sys
import threading
from collections.abc import Iterator, Sequence
from typing import Literal

import laticauda as lc
from laticauda import packaging, protocol
from laticauda.cli.command import LOCAL, Command, until_stopped
from laticauda.cli.flags import File, NetCdf, read
from laticauda.cli.scene import warn_of_compiling
from laticauda.errors import BadArgument
from laticauda.lab import Lab, LabAddresses, LabSettings, Tank, VirtualRobot, assist, load_faults
from laticauda.quantities import option, quantity, value
from laticauda.robot import Scene, Water, load_robot
from laticauda.scenarios import model_of, named_after, water_for


@value
class Body:
    """What swims, where."""

    robot: str = option("A preset (see `laticauda robots`) or a TOML file; at most 18 joints", default="mamba-modules")
    water: str | None = option("A preset, a TOML file or textbook; left out: see `laticauda swim`", default=None)
    model: Literal["planar", "spatial"] = option("The model of the body", default="planar")
    scene: str | None = option("What is around it in space, as for `laticauda swim`: tank, pipe ...", default=None)
    joints: str = option("Its servos: servo, or speed-servo, which control their speed", default="servo")

    @property
    def pool(self) -> Water:
        """The water, as it was found."""
        return water_for(load_robot(self.robot), self.water)


@value
class Wires:
    """How it is reached."""

    bus: str = option("CAN: udp_multicast[:GROUP[:PORT]] of processes, or socketcan[:NAME]", default="udp_multicast")
    host: str = option("Where the cameras' server listens; 127.0.0.1 is this computer alone", default="127.0.0.1")
    port: int = quantity("", "Likewise; 0: any that is free", ge=0, le=65535, default=22223)
    hops: int = quantity("", "Routers that frames of udp_multicast may pass; 0: none, 1: this network", ge=0, default=0)


@value
class Time:
    """Its clock, its chance, its faults."""

    speed: float = quantity("", "Seconds of the lab for one second of yours", gt=0.0, default=1.0)
    duration: float | None = quantity("s", "How long, by the lab's clock; until Ctrl-C if left out", default=None)
    seed: int = quantity("", "Of all that is random", ge=0, default=0)
    faults: File = option("A schedule of what goes wrong (.toml)", default=None)


@value
class LabCommand(Command):
    """Run the virtual tank until Ctrl-C: joint modules on a CAN bus, cameras that QTM's clients read, a power meter.

    It prints one line that says where to reach them. Lines that you type are for the person at the tank: `leak node=5
    duration=2` and other faults, `clear`, `carry X Y HEADING_DEG`, `truth`, `help`.

    For example: laticauda lab --robot mamba-modules --position 0 0.5 --seed 1
    """

    body: Body = option("What swims, where", default=Body())
    start: lc.Start = option("Where it lies, straight", default=lc.Start())
    coefficients: Water = option("Replace what the chosen water has")
    servos: lc.JointLaw = option("The servos' own numbers")
    scene: Scene = option("What is around it", default=Scene())
    wires: Wires = option("How it is reached", default=Wires())
    time: Time = option("Its clock, its chance, its faults", default=Time())
    save: NetCdf = option("Write the truth since the robot was put into the water to this file (.nc)", default=None)

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "LabCommand":
        """The command that was typed; see `Command.read`."""
        body: Body = read(Body, words, prog, first=True)
        settings = model_of(body.model, joints=body.joints, **({} if body.scene is None else {"scene": body.scene}))
        scene = getattr(settings, "scene", None) or Scene()
        return read(cls, words, prog, cls(body=body, coefficients=body.pool, servos=settings.joints, scene=scene))

    def run(self) -> None:
        """Serve until Ctrl-C, or as long as is asked for."""
        bus = protocol.bus_address(self.wires.bus, hops=self.wires.hops)
        if bus.interface == "virtual":
            raise BadArgument("bus", f"must be udp_multicast or socketcan, which other processes reach, got {bus}")
        tank = self._tank()
        lab = Lab(tank, bus=bus, host=self.wires.host, port=self.wires.port, speed=self.time.speed)
        addresses = lab.open()
        with until_stopped(lab.close):
            self._announce(addresses, tank)
            threading.Thread(target=_listen, args=(lab,), daemon=True).start()
            lab.run(self.time.duration)
        if lab.lag > 0.0:
            print(f"This computer could not follow: the lab's clock waited for {lab.lag:.1f} s.", file=sys.stderr)
        if self.save is not None:
            tank.body.trial(packaging.__version__).save(self.save)

    def _tank(self) -> Tank:
        """The tank that is asked for, its kernels compiled."""
        robot = load_robot(self.body.robot)
        water = named_after(self.coefficients, self.body.pool)
        faults = () if self.time.faults is None else load_faults(self.time.faults)
        settings = LabSettings(seed=self.time.seed)
        warn_of_compiling(water, self.body.model)
        scene = None if self.body.scene is None else self.scene
        body = lc.plant(robot, water, model=self.body.model, joints=self.servos, scene=scene)
        return Tank(VirtualRobot(robot, body, self.start, depth=settings.mocap.depth), settings, faults)

    def _announce(self, addresses: LabAddresses, tank: Tank) -> None:
        host, bus = addresses.mocap_host, addresses.bus
        if host not in LOCAL:
            print(f"Anyone who reaches {host} can read the cameras: the protocol knows no passwords.", file=sys.stderr)
        if bus.hops or bus.interface == "socketcan":
            print(f"Anyone on {bus} can move the robot: a CAN bus knows no passwords.", file=sys.stderr)
        qtm = f"{host}:{addresses.mocap_port}"
        line = {"bus": str(bus), "qtm": qtm, "meter": addresses.meter, "nodes": len(tank.nodes)}
        only = "" if host != "127.0.0.1" or bus.hops else " (this computer only)"
        self.announce(line, " | ".join(f"{name} {value}" for name, value in line.items()) + only)


def _listen(lab: Lab) -> None:
    """Do what lines on the standard input say, until it ends."""
    for line in _lines():
        if line.strip():
            try:
                print(lab.call(lambda tank, line=line: assist(tank, line)), file=sys.stderr, flush=True)
            except ValueError as error:
                print(error, file=sys.stderr, flush=True)


def _lines() -> Iterator[str]:
    """The lines of the standard input, if there is one."""
    try:
        yield from sys.stdin or ()
    except OSError:
        return
