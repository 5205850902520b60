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

PERIOD = 0.01
"""Time between two cycles of the controllers [s]."""
EPOCH = 1.7e9
"""What the clocks of ROS 2 showed when the tank's began [s]."""
FOR_EVER = 1e6
"""A joint goes on holding without references [s]."""
SYNC_COUNTS = 65536
"""How many values the counter of a `Sync` has."""
UNSEEN = [math.nan] * 3
"""Position of a body that the cameras do not see [m]."""
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
"""Quaternion w, x, y, z of a body that is not turned."""
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
        self._states = f"{space}/{STATES}"
        self._goals = f"{space}/{GOALS}"
        self._motors = f"{space}/{MOTORS}"
        self._node = Node(domain)
        self._node.write(self._states, messages.JointState)
        for topic in (self._goals, self._motors):
            self._node.read(topic, messages.Float64MultiArray)
        self._positions = [0.0] * n
        self._switches = [0.0] * n
        self._measured: dict[int, JointState] = {}
        self._to_tank: deque[Any] = deque()
        self._due = time.monotonic()
        self._counter = 0

    def recv(self, timeout: float | None = None) -> Any:
        """Return the next frame for the modules: a hundred times a second they take up their goals and measure."""
        if not self._to_tank:
            self._wait(timeout)
        for positions in self._arrays(self._goals):
            self._positions = positions
        for switches in self._arrays(self._motors):
            self._switch(switches)
        now = time.monotonic()
        if not self._to_tank and now >= self._due:
            self._due = max(self._due + PERIOD, now)  # less often where a computer is too slow
            self._counter = (self._counter + 1) % SYNC_COUNTS
            self._to_tank += encode_references(self._positions)
            self._to_tank.append(Sync(counter=self._counter))
        if not self._to_tank:
            return None
        return to_frame(self._to_tank.popleft())

    def _wait(self, timeout: float | None) -> None:
        """Wait until the next cycle, or a message comes, but no longer than the timeout [s]."""
        time_left = self._due - time.monotonic()
        if timeout is not None:
            time_left = min(time_left, timeout)
        if time_left > 0.0:
            self._node.wait(time_left)

    def _switch(self, switches: list[float]) -> None:
        """Switch the motors that are to change: 1 is on, 0 is limp."""
        changes = zip(self._switches, switches, strict=True)
        for number, (before, after) in enumerate(changes, start=1):
            if after == before:
                continue
            order = Order.DISABLE
            if after:
                order = Order.ENABLE
            self._to_tank.append(NodeCommand(order=order, node=number))
        self._switches = switches

    def _arrays(self, topic: str) -> list[list[float]]:
        """Return what has come by the topic of a controller, and is as long as it must be."""
        arrays: list[list[float]] = []
        for message in self._node.taken(topic):
            if message is not None and len(message.data) == len(self.names):
                arrays.append(list(message.data))
        return arrays

    def send(self, frame: Any, timeout: float | None = None) -> None:
        """Publish what the modules measured, once all did; heartbeats are not told."""
        message = decode(frame.arbitration_id, bytes(frame.data))
        if isinstance(message, JointState):
            self._measured[message.node] = message
        if len(self._measured) == len(self.names):
            by_name = {self.names[node - 1]: state for node, state in self._measured.items()}
            self._publish(by_name)
            self._measured = {}

    def _publish(self, states: dict[str, JointState]) -> None:
        names = sorted(states, reverse=True)
        velocities: list[float] = []
        efforts: list[float] = []
        if "velocity" in self.tells:
            velocities = [states[name].rate for name in names]
        if "effort" in self.tells:
            efforts = [states[name].torque for name in names]
        message = messages.JointState(
            header=messages.stamped(time.time()),
            name=names,
            position=[states[name].angle for name in names],
            velocity=velocities,
            effort=efforts,
        )
        self._node.say(self._states, message)

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
        self._domain = domain
        self.topic = topic

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
        position = UNSEEN
        quaternion = UPRIGHT
        if pose is not None:
            position = pose.position.tolist()
            quaternion = to_quaternion(pose.rotation)
        w, x, y, z = map(float, quaternion)
        message = messages.PoseStamped(
            header=messages.stamped(EPOCH + frame.timestamp, "tank"),
            pose=messages.Pose(messages.Point(*position), messages.Quaternion(x=x, y=y, z=z, w=w)),
        )
        self._node.say(self.topic, message)


def tank_behind_ros(robot: str = "mamba", seed: int = 0) -> lab.Tank:
    """A tank whose modules have no time-outs, and angle sensors that know their zero.

    Args:
        robot: A preset.
        seed: Of all that is random.
    """
    settings = lab.LabSettings(seed=seed)
    nodes = replace(
        settings.nodes,
        hold_after=FOR_EVER,
        limp_after=FOR_EVER,
        startup_time=0.0,
        calibration_time=0.0,
        zero_error=0.0,
    )
    preset = lc.load_robot(robot)
    plant = lc.build_plant(preset, lc.load_water("paper-lateral"), joints="servo")
    body = lab.VirtualRobot(preset, plant)
    return lab.Tank(body, replace(settings, nodes=nodes))


def main(domain: str = "0", space: str = "") -> None:
    """A tank until Ctrl-C."""
    tank = tank_behind_ros()
    controllers = Controllers(len(tank.nodes), int(domain), space)
    poses = Poses(int(domain), f"{space}{TOPIC}")
    virtual_lab = lab.Lab(tank, bus=controllers)
    virtual_lab.server = poses
    meter = virtual_lab.open().meter
    joints = ",".join(controllers.names)
    if space:
        joints = f"{space}/{joints}"
    print(
        f"bus ros2@{joints}:{domain} | mocap ros2@{poses.topic}:{domain} | meter {meter}",
        flush=True,
    )
    try:
        virtual_lab.run()
    except KeyboardInterrupt:
        virtual_lab.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
