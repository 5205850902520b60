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

USUAL = "127.0.0.1:9870"


class Sender:
    """Stands for the cameras' server of a `laticauda.tank.lab.Lab`.

    Args:
        address: HOST:PORT where the driver listens.
        body: How the body is called.
    """

    def __init__(self, address: str = USUAL, body: str = lab.BODY) -> None:
        (self.host, self.port), self._body = host_and_port(address), body

    def start(self) -> None:
        """Open the socket."""
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def stop(self) -> None:
        """Close it."""
        self._socket.close()

    def publish(self, frame: protocol.MocapFrame) -> None:
        """Send what the cameras see."""
        pose = frame.bodies[0]
        said: dict[str, object] = {"body": self._body, "time": frame.timestamp, "position": None}
        if pose is not None:
            said |= {"position": pose.position.tolist(), "quaternion": to_quaternion(pose.rotation)}
            said |= {"residual": pose.residual} if math.isfinite(pose.residual) else {}
        self._socket.sendto(json.dumps(said).encode(), (self.host, self.port))


def main() -> None:
    """A tank until Ctrl-C."""
    robot = lc.load_robot("mamba")
    body = lab.VirtualRobot(
        robot, lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo")
    )
    sender, bus = Sender(*sys.argv[1:2]), protocol.bus_address("udp_multicast")
    served = lab.Lab(lab.Tank(body), bus=bus)
    served.server = sender
    addresses = served.open()
    print(f"bus {bus} | udp-json {sender.host}:{sender.port} | meter {addresses.meter}", flush=True)
    try:
        served.run()
    except KeyboardInterrupt:
        served.close()


if __name__ == "__main__":
    main()
