"""A tank without wires and without chance, for tests."""

from laticauda.models.simulate import build_plant
from laticauda.robot import load_robot, load_water
from laticauda.tank.lab import LabSettings, MocapSettings, NodeSettings, Tank, VirtualRobot
from laticauda.tank.protocol import NodeCommand, Order, Sync, decode, encode, encode_references

EXACT = LabSettings(
    nodes=NodeSettings(
        zero_error=0.0,
        angle_noise=0.0,
        angle_step=0.0,
        backlash=0.0,
        rate_noise=0.0,
        current_noise=0.0,
        torque_noise=0.0,
        force_noise=0.0,
        force_zero_error=0.0,
        acceleration_noise=0.0,
        startup_time=0.1,
        calibration_time=0.1,
    ),
    mocap=MocapSettings(
        position_noise=0.0, rotation_noise=0.0, drop_share=0.0, lost_share=0.0, reflection_share=0.0
    ),
)


class Operator:
    """A tank and the frames that an operator sends to it, without wires."""

    def __init__(self, tank: Tank) -> None:
        self.tank, self.counter = tank, 0

    def tell(self, message, time=None):
        self.tank.receive(*encode(message), time)
        return self.heard()

    def heard(self):
        return [decode(*wire) for wire in self.tank.sent()]

    def ready(self, *, enable=True):
        """Past start-up, zeros set, and following references."""
        s = self.tank.settings.nodes
        self.tank.advance(s.startup_time + s.calibration_time + 0.05)
        self.tell(NodeCommand(order=Order.SET_ZERO))
        if enable:
            self.tell(NodeCommand(order=Order.ENABLE))
        return self

    def cycle(self, angles, n=1):
        """References and a sync, 100 times a second; all that was heard."""
        found = []
        for _ in range(n):
            for message in encode_references(angles):
                self.tell(message)
            self.counter = (self.counter + 1) % 65536
            found += self.tell(Sync(counter=self.counter))
            self.tank.advance(0.01)
            found += self.heard()
        return found

    @property
    def states(self):
        return [node.state.name for node in self.tank.nodes]


def make_tank(settings=EXACT, model="planar", faults=()):
    robot = load_robot("mamba-modules")
    return Tank(
        VirtualRobot(
            robot, build_plant(robot, load_water("paper-lateral"), model=model, joints="servo")
        ),
        settings,
        faults,
    )
