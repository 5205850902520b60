"""The robot that somebody else operates, in a lab or in a tank, shown as it is: nothing on the page can move it."""

import math
from collections import deque
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda import interfaces, series
from laticauda.cockpit import pages, shapes
from laticauda.cockpit.scene import Body, Scene, Trail
from laticauda.operate.settings import Connection
from laticauda.robot import Robot, load_robot, robot_names

if TYPE_CHECKING:
    from laticauda.estimation import Estimate
    from laticauda.operate.observer import Listener, Sight

TRAIL: shapes.Color = (250, 120, 80)
SPAN = 5.0  # over which its speed is taken [s]
HINT_BUS = "udp_multicast:GROUP:PORT, virtual:NAME or socketcan:can0, as `laticauda lab` and `operate` have it"
HINT_MOCAP = "HOST:PORT of the motion capture's real-time server"


class OperatedRobot:
    """Its picture, and the controls that belong to it.

    Args:
        gui: Of the page's server; the controls go where it is.
        pictures: Of the same server.
        scene: Where the simulated robot is.
        own: A robot that is perhaps no preset, and can be chosen, too.
    """

    def __init__(self, gui: Any, pictures: Any, scene: Scene, own: Robot) -> None:
        self._scene, self._own = scene, own
        self._listener: Listener | None = None
        self._body = Body(pictures, "operated")
        self._trail = Trail(pictures, "/operated_trail", TRAIL)
        self._places: deque[tuple[float, np.ndarray]] = deque()
        gui.add_markdown("The robot that `laticauda operate` moves, in `laticauda lab` or in a tank. Read-only.")
        self._can = gui.add_text("CAN bus", "", hint=HINT_BUS)
        self._mocap = gui.add_text("cameras", "", hint=HINT_MOCAP)
        names = tuple(dict.fromkeys((*robot_names(), own.name)))
        self._robot = gui.add_dropdown("robot", names, initial_value=own.name, hint="The one that is in the tank")
        self._on = gui.add_button("connect", hint="It only listens: nothing is sent on the bus")
        self._off = gui.add_button("disconnect", visible=False)
        self._alone = gui.add_checkbox("hide the simulated robot", True)
        self._text = gui.add_markdown("")
        self._offer(Connection())
        self._on.on_click(self._clicked)
        self._off.on_click(self._left)

    @property
    def is_on(self) -> bool:
        """Whether it is connected, or tries to be."""
        return self._listener is not None

    def connect(self, connection: Connection, robot: Robot, **mount: Any) -> None:
        """Look on from now on.

        Args:
            connection: Where bus and cameras are.
            robot: What is operated.
            mount: Where the marker body sits, if it is not in the middle of the last module.

        Raises:
            ValueError: If the robot has no module for the markers.
            MissingExtra: If a library is not installed.
        """
        from laticauda.operate.observer import Listener

        listener = Listener(connection, robot, **mount)
        self.disconnect()
        self._listener = listener
        self._offer(connection)
        if robot.name in self._robot.options:
            self._robot.value = robot.name
        self._on.visible, self._off.visible = False, True

    def disconnect(self) -> None:
        """Look on no more."""
        if self._listener is not None:
            self._listener.close()
            self._listener = None
        self._body.remove()
        self._trail.forget()
        self._places.clear()
        self._scene.set_visible(True)
        self._text.content = ""
        self._on.visible, self._off.visible = True, False

    def show(self, *, with_text: bool) -> np.ndarray | None:
        """Bring it up to date; where the robot is, or None if nothing is known of it [m].

        Args:
            with_text: Whether its numbers are written anew, and its trail grows.
        """
        listener = self._listener
        if listener is None:
            return None
        sight = listener.look()
        estimate = sight.estimate
        if estimate is None:
            if with_text:
                self._text.content = f"**{sight.trouble}**" if sight.trouble else "Waiting for the first picture ..."
            return None
        robot = listener.robot.planar()
        self._body.show(robot, _sample(estimate, sight.fin_angle))
        self._scene.set_visible(not self._alone.value)
        if with_text:
            self._trail.grow(estimate.center_of_mass)
            self._trail.draw()
            self._text.content = self._numbers(estimate, sight, has_fin=len(robot.driven_joints) > robot.n_joints)
        return estimate.center_of_mass

    def _numbers(self, estimate: "Estimate", sight: "Sight", *, has_fin: bool) -> str:
        """Where it is and how fast, and what is wrong, as Markdown."""
        now, place = estimate.time, estimate.center_of_mass
        if not self._places or now > self._places[-1][0]:
            self._places.append((now, place))
        while now - self._places[0][0] > SPAN:
            self._places.popleft()
        then, there = self._places[0]
        speed = float(np.linalg.norm(place - there)) / (now - then) if now - then > 0.5 * SPAN else math.nan
        rows = [
            ("place", f"{place[0]:z.2f}, {place[1]:z.2f} m"),
            ("heading", f"{math.degrees(estimate.heading):z.1f} deg"),
            (f"speed over {SPAN:g} s", f"{speed:.3f} m/s" if math.isfinite(speed) else "..."),
            ("joints", f"up to {math.degrees(float(np.max(np.abs(estimate.joint_angle), initial=0.0))):.0f} deg"),
        ]
        rows += [("fin", f"{math.degrees(sight.fin_angle):z.0f} deg")] if has_fin else []
        lines = [f"| {estimate.status} | |", "|:--|--:|", *(f"| {name} | **{value}** |" for name, value in rows)]
        return "\n".join(lines) + (f"\n\n**{sight.trouble}**" if sight.trouble else "")

    def _offer(self, connection: Connection) -> None:
        """Let the fields show where bus and cameras are."""
        mocap = f"{connection.mocap_host}:{connection.mocap_port}"
        self._can.value, self._mocap.value = str(connection.bus), mocap

    def _left(self, event: Any) -> None:
        self.disconnect()

    @pages.refusing
    def _clicked(self, event: Any) -> None:
        name = self._robot.value
        connection = Connection().at(can=self._can.value.strip(), mocap=self._mocap.value.strip())
        self.connect(connection, self._own if name == self._own.name else load_robot(name))


def _sample(estimate: "Estimate", fin_angle: float) -> series.Log:
    """An estimate as a sample to draw, which says nothing of the motors; with the angle of a driven fin [rad]."""
    names = [name for name in interfaces.Observation.__dataclass_fields__ if name in series.Log.__dataclass_fields__]
    known: dict[str, Any] = {name: np.asarray(getattr(estimate, name)) for name in names}
    nothing = np.zeros_like(estimate.joint_angle)
    fin = {"fin_angle_0": np.asarray(fin_angle)}
    return series.Log(**known, joint_angle_ref=nothing, joint_torque=nothing, work=np.zeros(3), signals=fin)
