"""`laticauda lab`: the virtual tank, with one line that says where to reach it."""

import json
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

from laticauda.cli.flags import File, Number, Numbers, Preset, Switch, Text, Whole, changed, choice, default
from laticauda.cli.groups import Coefficients, WaterChanges, radians
from laticauda.cli.messages import given
from laticauda.cli.outputs import check_output
from laticauda.cli.swim import COMPILING
from laticauda.robot import load_robot, load_water

if TYPE_CHECKING:
    from laticauda.lab import Lab, LabAddresses, Tank

ROBOT, WATER = "mamba-modules", "paper-lateral"


@dataclass(frozen=True, kw_only=True)
class BodyFlags:
    """What swims, where."""

    robot: Annotated[Preset, default(ROBOT)] = None
    """A preset (`laticauda robots` lists them) or a TOML file, with 18 joints or fewer."""
    water: Annotated[Preset, default(WATER)] = None
    """A preset or a TOML file."""
    model: Annotated[str | None, choice("planar", "spatial"), default("planar")] = None
    """The model of the body; the joints are servos in either."""
    position: Annotated[Numbers, default("0 0")] = None
    """Where the center of mass starts, x y [m]."""
    heading_deg: Annotated[Number, default("0")] = None
    """Initial heading, counter-clockwise from the x axis [deg]."""


@dataclass(frozen=True, kw_only=True)
class WireFlags:
    """How it is reached."""

    bus: Annotated[Text, default("udp_multicast:239.74.163.2:43113")] = None
    """The CAN bus: udp_multicast[:GROUP[:PORT]] between processes, or socketcan[:NAME]."""
    host: Annotated[Text, default("127.0.0.1: this computer alone")] = None
    """Where the cameras' server listens."""
    port: Annotated[Whole, default("22223")] = None
    """Likewise; 0: any that is free."""
    hops: Annotated[Whole, default("0: frames stay on this computer")] = None
    """Routers that CAN frames of udp_multicast may pass; 1: this network."""


@dataclass(frozen=True, kw_only=True)
class TimeFlags:
    """Its clock, its chance, its faults."""

    speed: Annotated[Number, default("1")] = None
    """Seconds of the lab for one second of yours."""
    duration: Annotated[Number, default("until Ctrl-C")] = None
    """How long, by the lab's clock [s]."""
    seed: Annotated[Whole, default("0")] = None
    """Of all that is random."""
    faults: File = None
    """A schedule of what goes wrong (.toml)."""


@dataclass(frozen=True, kw_only=True)
class LabCommand:
    """Run the virtual tank until Ctrl-C: joint modules on a CAN bus, cameras that QTM's clients read, a power meter.

    It prints one line that says where to reach them. Lines that you type are for the person at the tank: `leak node=5
    duration=2` and other faults, `clear`, `carry X Y HEADING_DEG`, `truth`, `help`.

    For example: laticauda lab --robot mamba-modules --position 0 0.5 --seed 1
    """

    body: BodyFlags = field(default_factory=BodyFlags)
    coefficients: Coefficients = field(default_factory=WaterChanges)
    """Replace what the chosen water has."""
    wires: WireFlags = field(default_factory=WireFlags)
    time: TimeFlags = field(default_factory=TimeFlags)
    json: Switch = False
    """Print the line as a JSON object."""
    save: File = None
    """Write what was really so, since the robot was last put into the water, to this netCDF file (.nc)."""

    def __call__(self) -> int:
        """Serve, and return the exit status."""
        check_output("save", self.save, (".nc",))
        from laticauda.lab import Lab
        from laticauda.protocol import bus_address
        from laticauda.protocol.qtm import PORT

        bus = bus_address(self.wires.bus or "udp_multicast", hops=self.wires.hops or 0)
        if bus.interface == "virtual":
            raise ValueError(f"`bus` must be udp_multicast or socketcan, which other processes reach, got {bus}.")
        port = PORT if self.wires.port is None else self.wires.port
        if not 0 <= port <= 65535:
            raise ValueError(f"`port` must be between 0 and 65535, got {port}.")
        tank = self._tank()
        speed = 1.0 if self.time.speed is None else self.time.speed
        lab = Lab(tank, bus=bus, host=self.wires.host or "127.0.0.1", port=port, speed=speed)
        addresses = lab.open()
        try:
            self._announce(addresses, tank)
            threading.Thread(target=_listen, args=(lab,), daemon=True).start()
            lab.run(self.time.duration)
        except KeyboardInterrupt:
            print("stopped.", file=sys.stderr)
        finally:
            lab.close()
        if lab.lag > 0.0:
            print(f"This computer could not follow: the lab's clock waited for {lab.lag:.1f} s.", file=sys.stderr)
        if self.save is not None:
            from laticauda.packaging import __version__

            tank.body.trial(__version__).save(self.save)
        return 0

    def _tank(self) -> "Tank":
        """The tank that is asked for, its kernels compiled."""
        from laticauda.interfaces import Start
        from laticauda.lab import LabSettings, Tank, VirtualRobot, load_faults
        from laticauda.simulate import needs_compiling, plant

        robot = load_robot(ROBOT if self.body.robot is None else self.body.robot)
        water = changed(load_water(WATER if self.body.water is None else self.body.water), self.coefficients)
        position = (0.0, 0.0) if self.body.position is None else self.body.position
        if len(position) != 2:
            raise ValueError(f"`position` must be two numbers, x y [m], got {len(position)}.")
        start = Start(center_of_mass=(position[0], position[1]), heading=radians(self.body.heading_deg, 0.0))
        faults = () if self.time.faults is None else load_faults(self.time.faults)
        settings = LabSettings(seed=0 if self.time.seed is None else self.time.seed)
        model = self.body.model or "planar"
        if needs_compiling(water, model=model):
            print(COMPILING, file=sys.stderr, flush=True)
        chosen = {name: value for name, value in given(self.body).items() if name == "model"}
        body = plant(robot, water, joints="servo", **chosen)
        return Tank(VirtualRobot(robot, body, start, depth=settings.mocap.depth), settings, faults)

    def _announce(self, addresses: "LabAddresses", tank: "Tank") -> None:
        if addresses.mocap_host not in ("127.0.0.1", "localhost", "::1"):
            print(
                f"Anyone who reaches {addresses.mocap_host} can read the cameras: the protocol knows no passwords.",
                file=sys.stderr,
            )
        if addresses.bus.hops or addresses.bus.interface == "socketcan":
            print(f"Anyone on {addresses.bus} can move the robot: a CAN bus knows no passwords.", file=sys.stderr)
        told: dict[str, Any] = {
            "bus": str(addresses.bus),
            "qtm": f"{addresses.mocap_host}:{addresses.mocap_port}",
            "meter": addresses.meter,
            "nodes": len(tank.nodes),
        }
        if self.json:
            print(json.dumps(told), flush=True)
        else:
            only = "" if addresses.mocap_host != "127.0.0.1" or addresses.bus.hops else " (this computer only)"
            print(" | ".join(f"{name} {value}" for name, value in told.items()) + only, flush=True)


def _listen(lab: "Lab") -> None:
    """Do what lines on the standard input say, until it ends."""
    from laticauda.lab import assist

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
