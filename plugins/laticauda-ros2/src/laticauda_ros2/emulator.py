"""The robot and the cameras of the virtual tank as ROS 2 has them: ros2_control, and a publisher of poses.

python -m laticauda_ros2.emulator [DOMAIN [NAMESPACE]]

The controllers are written to the documentation of ros2_controllers: a joint_state_broadcaster,
whose names are in no order that means anything, and two forward_command_controllers, which take
arrays of their joints' length alone.
"""

import math
import sys
import time
from collections import deque
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import Any

import laticauda as lc
from laticauda.tank import lab, protocol
from laticauda.tank.protocol import (
    JointState,
    NodeCommand,
    Order,
    Sync,
    decode,
    encode_references,
    to_frame,
)
from laticauda.values import to_quaternion
from laticauda_ros2 import messages
from laticauda_ros2.bus import GOALS, MOTORS, STATES
from laticauda_ros2.node import Node

PERIOD = 0.01  # of the controllers [s]
EPOCH = 1.7e9  # what the clocks of ROS 2 showed when the tank's began [s]
FOR_EVER = 1e6  # s; a joint goes on holding without references
TOPIC = f"/{lab.BODY.replace('-', '_')}/pose"


class Controllers(AbstractContextManager["Controllers"]):
    """Stands for the CAN bus of a `laticauda.tank.lab.Lab`.

    Args:
        n: How many joints there are.
        domain: Of DDS.
        space: Namespace of the topics; "" is none.
    """

    def __init__(self, n: int, domain: int, space: str = "") -> None:
        self.names = [f"joint_{number}" for number in range(1, n + 1)]
        self.tells = ("velocity", "effort")
        """Which of the arrays that may be left out it fills."""
        self._states, self._goals, self._motors = (
            f"{space}/{name}" for name in (STATES, GOALS, MOTORS)
        )
        self._node = Node(domain)
        self._node.write(self._states, messages.JointState)
        for topic in (self._goals, self._motors):
            self._node.read(topic, messages.Float64MultiArray)
        self._goal, self._on = [0.0] * n, [0.0] * n
        self._measured: dict[int, JointState] = {}
        self._to_tank: deque[Any] = deque()
        self._due, self._counter = time.monotonic(), 0

    def recv(self, timeout: float | None = None) -> Any:
        """The next frame for the modules: a hundred times a second they take up their goals and measure."""
        left = self._due - time.monotonic()
        if not self._to_tank and left > 0.0:
            self._node.wait(min(left, left if timeout is None else timeout))
        for one in self._arrays(self._goals):
            self._goal = one
        for one in self._arrays(self._motors):
            changed = [
                (number, new)
                for number, (old, new) in enumerate(zip(self._on, one, strict=True), 1)
                if old != new
            ]
            self._to_tank += [
                NodeCommand(order=Order.ENABLE if on else Order.DISABLE, node=number)
                for number, on in changed
            ]
            self._on = one
        if (
            not self._to_tank and time.monotonic() >= self._due
        ):  # where a computer is too slow, it is less often
            self._due = max(self._due + PERIOD, time.monotonic())
            self._counter = (self._counter + 1) % 65536
            self._to_tank += [*encode_references(self._goal), Sync(counter=self._counter)]
        return to_frame(self._to_tank.popleft()) if self._to_tank else None

    def _arrays(self, topic: str) -> list[list[float]]:
        """What has come by the topic of a controller, and is as long as it must be."""
        found = [message.data for message in self._node.taken(topic) if message is not None]
        return [list(one) for one in found if len(one) == len(self.names)]

    def send(self, frame: Any, timeout: float | None = None) -> None:
        """What all modules measured becomes a message; heartbeats are not told."""
        said = decode(frame.arbitration_id, bytes(frame.data))
        if isinstance(said, JointState):
            self._measured[said.node] = said
        if len(self._measured) == len(self.names):
            found = sorted(
                self._measured.values(), key=lambda one: self.names[one.node - 1], reverse=True
            )
            columns = {
                "velocity": [one.rate for one in found],
                "effort": [one.torque for one in found],
            }
            self._measured = {}
            self._node.say(
                self._states,
                messages.JointState(
                    header=messages.stamped(time.time()),
                    name=[self.names[one.node - 1] for one in found],
                    position=[one.angle for one in found],
                    **{key: value if key in self.tells else [] for key, value in columns.items()},
                ),
            )

    def __exit__(self, *_: object) -> None:
        """Leave the network."""
        self._node.close()


class Poses:
    """Stands for the cameras' server of a `laticauda.tank.lab.Lab`: `PoseStamped` of one body.

    Args:
        domain: Of DDS.
        topic: Its name.
    """

    host, port = "127.0.0.1", 1  # a lab tells some; topics have none

    def __init__(self, domain: int, topic: str = TOPIC) -> None:
        self._domain, self.topic = domain, topic

    def start(self) -> None:
        """Join the network."""
        self._node = Node(self._domain)
        self._node.write(self.topic, messages.PoseStamped)

    def stop(self) -> None:
        """Leave it."""
        self._node.close()

    def publish(self, frame: protocol.MocapFrame) -> None:
        """Say what the cameras see."""
        pose = frame.bodies[0]
        place = [math.nan] * 3 if pose is None else pose.position.tolist()
        w, x, y, z = (1.0, 0.0, 0.0, 0.0) if pose is None else to_quaternion(pose.rotation)
        point, turned = (
            messages.Point(*place),
            messages.Quaternion(x=float(x), y=float(y), z=float(z), w=float(w)),
        )
        header = messages.stamped(EPOCH + frame.timestamp, "tank")
        self._node.say(
            self.topic, messages.PoseStamped(header=header, pose=messages.Pose(point, turned))
        )


def tank_behind_ros(robot: str = "mamba", seed: int = 0) -> lab.Tank:
    """A tank whose modules have no time-outs, and angle sensors that know their zero.

    Args:
        robot: A preset.
        seed: Of all that is random.
    """
    usual = lab.LabSettings(seed=seed)
    nodes = replace(
        usual.nodes,
        hold_after=FOR_EVER,
        limp_after=FOR_EVER,
        startup_time=0.0,
        calibration_time=0.0,
        zero_error=0.0,
    )
    what = lc.load_robot(robot)
    body = lab.VirtualRobot(
        what, lc.build_plant(what, lc.load_water("paper-lateral"), joints="servo")
    )
    return lab.Tank(body, replace(usual, nodes=nodes))


def main(domain: str = "0", space: str = "") -> None:
    """A tank until Ctrl-C."""
    tank = tank_behind_ros()
    controllers, poses = (
        Controllers(len(tank.nodes), int(domain), space),
        Poses(int(domain), f"{space}{TOPIC}"),
    )
    served = lab.Lab(tank, bus=controllers)
    served.server = poses
    meter = served.open().meter
    joints = f"{space and f'{space}/'}{','.join(controllers.names)}"
    print(
        f"bus ros2@{joints}:{domain} | mocap ros2@{poses.topic}:{domain} | meter {meter}",
        flush=True,
    )
    try:
        served.run()
    except KeyboardInterrupt:
        served.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
