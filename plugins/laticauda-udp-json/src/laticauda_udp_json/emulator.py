"""The cameras of the virtual tank, as a sender of such datagrams.

python -m laticauda_udp_json.emulator [HOST:PORT]
"""

import json
import math
import socket
import sys

import laticauda as lc
from laticauda.tank import lab, protocol
from laticauda.tank.operate.drivers.base import host_and_port
from laticauda.values import to_quaternion

DEFAULT_ADDRESS = "127.0.0.1:9870"


class Sender:
    """Stands for the cameras' server of a `laticauda.tank.lab.Lab`.

    Args:
        address: HOST:PORT where the driver listens.
        body: How the body is called.
    """

    def __init__(self, address: str = DEFAULT_ADDRESS, body: str = lab.BODY) -> None:
        self.host, self.port = host_and_port(address)
        self._body = body

    def start(self) -> None:
        """Open the socket."""
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def stop(self) -> None:
        """Close it."""
        self._socket.close()

    def publish(self, frame: protocol.MocapFrame) -> None:
        """Send what the cameras see."""
        pose = frame.bodies[0]
        message: dict[str, object] = {
            "body": self._body,
            "time": frame.timestamp,
            "position": None,
        }
        if pose is not None:
            message["position"] = pose.position.tolist()
            message["quaternion"] = to_quaternion(pose.rotation)
        if pose is not None and math.isfinite(pose.residual):
            message["residual"] = pose.residual
        self._socket.sendto(json.dumps(message).encode(), (self.host, self.port))


def main() -> None:
    """A tank until Ctrl-C."""
    robot = lc.load_robot("mamba")
    plant = lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo")
    tank = lab.Tank(lab.VirtualRobot(robot, plant))
    bus = protocol.bus_address("udp_multicast")
    sender = Sender(*sys.argv[1:2])
    virtual_lab = lab.Lab(tank, bus=bus)
    virtual_lab.server = sender
    addresses = virtual_lab.open()
    print(f"bus {bus} | udp-json {sender.host}:{sender.port} | meter {addresses.meter}", flush=True)
    try:
        virtual_lab.run()
    except KeyboardInterrupt:
        virtual_lab.close()


if __name__ == "__main__":
    main()
