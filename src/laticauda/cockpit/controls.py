"""The page's controls: what can be set, with its unit and its sensible limits, and what the page then asks for."""

import math
from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec
from typing import Any

from laticauda.cockpit.live import SPEEDS, Live
from laticauda.cockpit.settings import Setting, with_fin
from laticauda.control import StraightLine
from laticauda.errors import LaticaudaError, within
from laticauda.fields import field_docs, split_unit
from laticauda.gaits import GAIT_KINDS, Gait
from laticauda.robot import CaudalFin, Robot, load_robot, robot_names

# Label, field of `Gait`, limits and step, in degrees and degrees per second: the paper's sweeps and some more.
ANGLES = (
    ("amplitude [°]", "amplitude", 0.0, 60.0, 1.0),
    ("frequency [°/s]", "frequency", 0.0, 220.0, 5.0),
    ("phase shift [°]", "phase_shift", -90.0, 90.0, 1.0),
    ("offset [°]", "offset", -20.0, 20.0, 0.5),
)
CURRENT = 2.0  # most of it along an axis [m/s]
RIGIDITY = 0.2  # of a fin that begins to bend [N m^2]
FINS = ("none", "rigid", "elastic")
KINDS = tuple(kind for kind in GAIT_KINDS if kind != "custom")


def models() -> tuple[str, ...]:
    """The models that this installation has."""
    return ("planar", "spatial") if find_spec("mujoco") else ("planar",)


class Controls:
    """The controls of one page's server, all pages showing the same.

    Args:
        gui: Of the page's server.
        live: What they set.
        changed: Called after every change.
    """

    def __init__(self, gui: Any, live: Live, changed: Callable[[], None]) -> None:
        self._live, self._changed = live, changed
        setting = live.setting
        self._own, self._envelope = setting.robot, setting.gait.envelope
        with gui.add_folder("Gait"):
            kinds = tuple(dict.fromkeys((*KINDS, setting.gait.kind)))
            self._kind = gui.add_dropdown("gait", kinds, initial_value=setting.gait.kind, hint=_hint(Gait, "kind"))
            self._angles = {
                field: gui.add_slider(label, low, high, step, _shown(setting.gait, field, low, high), hint=hint)
                for label, field, low, high, step in ANGLES
                for hint in [_hint(Gait, field, "deg/s" if field == "frequency" else "deg")]
            }
        with gui.add_folder("Robot and water"):
            names = [*robot_names()]
            names += [] if setting.robot.name in names else [setting.robot.name]
            self._robot = gui.add_dropdown("robot", names, initial_value=setting.robot.name)
            self._fin = gui.add_dropdown("fin", FINS, initial_value=_fin_of(setting.robot))
            hint = _hint(CaudalFin, "flexural_rigidity", "N m^2")
            self._rigidity = gui.add_number("rigidity [N m²]", RIGIDITY, step=0.01, hint=hint)
            self._model = gui.add_dropdown("model", models(), initial_value=setting.model)
            self._joints = gui.add_dropdown("joints", ("prescribed", "pd", "servo"), initial_value=setting.joints)
            hint = "V, the velocity that the water moves to, along world x and y [m/s]"
            self._current = [
                gui.add_number(f"current {axis} [m/s]", value, step=0.01, hint=hint)
                for axis, value in zip("xy", setting.current, strict=True)
            ]
        with gui.add_folder("Path"):
            hint = "Follow a straight line by the paper's line of sight; drag its gizmo to move or turn it."
            self._follow = gui.add_checkbox("follow a path", setting.path is not None, hint=hint)
        with gui.add_folder("Time"):
            self._speed = gui.add_slider("speed of time [-]", SPEEDS[0], SPEEDS[1], 0.1, live.speed)
            self._pause = gui.add_checkbox("pause", live.paused)
            self._reset = gui.add_button("reset")
        inputs = (self._kind, *self._angles.values(), self._robot, self._fin, self._rigidity, self._model)
        for handle in (*inputs, self._joints, *self._current, self._follow):
            handle.on_update(self._apply)
        self._speed.on_update(self._set_speed)
        self._pause.on_update(self._set_pause)

    @property
    def reset(self) -> Any:
        """The button that begins anew."""
        return self._reset

    def show(self, setting: Setting) -> None:
        """Let the controls show a setting that came from elsewhere."""
        self._kind.value = setting.gait.kind
        for _, field, low, high, _ in ANGLES:
            self._angles[field].value = _shown(setting.gait, field, low, high)
        self._robot.value = self._own_name(setting.robot)
        fin = setting.robot.caudal_fin
        self._fin.value = _fin_of(setting.robot)
        if fin is not None and fin.flexural_rigidity is not None:
            self._rigidity.value = fin.flexural_rigidity
        elif self._rigidity.value <= 0.0:
            self._rigidity.value = RIGIDITY
        self._model.value, self._joints.value = setting.model, setting.joints
        for handle, value in zip(self._current, setting.current, strict=True):
            handle.value = value
        self._follow.value = setting.path is not None

    def asked_for(self, touched: Any = None) -> Setting:
        """The setting that the controls show.

        Args:
            touched: The control that somebody has just used: only what it stands for is read, so that a value between
                a slider's steps stays what it is.

        Raises:
            ValueError: If it is none.
        """
        setting = self._live.setting
        gait = setting.gait
        if touched is self._kind:
            kind = self._kind.value
            gait = replace(gait, kind=kind, envelope=self._envelope if kind == "custom" else None)
        for _, field, low, high, _ in ANGLES:
            if touched is self._angles[field]:  # what is typed beside a slider may lie beyond its ends
                value = math.radians(touched.value)
                gait = replace(gait, **{field: value})  # what no gait can have, it refuses itself
                within(_flag(field), touched.value, low, high)
        robot = setting.robot
        if touched in (self._robot, self._fin, self._rigidity):
            robot = self._robot_asked_for(touched)
        path = setting.path
        if touched is self._follow:
            path = self._new_path() if self._follow.value else None
        current = setting.current
        if touched in self._current:
            x, y = (within("current", handle.value, -CURRENT, CURRENT, "m/s") for handle in self._current)
            current = (x, y)
        return replace(
            setting,
            gait=gait,
            robot=robot,
            model=self._model.value if touched is self._model else setting.model,
            joints=self._joints.value if touched is self._joints else setting.joints,
            current=current,
            path=path,
        )

    def _robot_asked_for(self, touched: Any) -> Robot:
        name = self._robot.value
        own = self._own if name == self._own.name else load_robot(name)
        if touched is self._robot:  # another robot comes with the fin that it has
            return own
        elastic = self._fin.value == "elastic" or (touched is self._rigidity and self._fin.value != "none")
        return with_fin(own, self._fin.value != "none", self._rigidity.value if elastic else None)

    def _new_path(self) -> StraightLine:
        """Along the heading that the robot has, some way to its right: so that it can be seen to come to it."""
        sample = self._live.latest()
        x, y = (float(value) for value in sample["center_of_mass"][:2])
        angle = float(sample["heading"])
        return StraightLine(point=(x + 0.6 * math.sin(angle), y - 0.6 * math.cos(angle)), angle=angle)

    def _apply(self, event: Any) -> None:
        if event.client is None:  # set by the program itself
            return
        try:
            self._live.change(self.asked_for(event.target))
        except (ValueError, LaticaudaError) as error:
            refuse(event.client, error)
        self.show(self._live.setting)
        self._changed()

    def _set_speed(self, event: Any) -> None:
        if event.client is None:
            return
        try:
            self._live.speed = event.target.value
        except ValueError as error:
            refuse(event.client, error)
            self._speed.value = self._live.speed

    def _set_pause(self, event: Any) -> None:
        self._live.paused = event.target.value

    def _own_name(self, robot: Robot) -> str:
        return robot.name if robot.name in self._robot.options else self._own.name


def refuse(client: Any, error: Exception) -> None:
    """Say on one page what is wrong."""
    client.add_notification("Refused", str(error), color="red", auto_close_seconds=12.0)


def _fin_of(robot: Robot) -> str:
    if robot.caudal_fin is None:
        return "none"
    return "elastic" if robot.caudal_fin.n_hinges else "rigid"


def _hint(kind: type, field: str, unit: str = "") -> str:
    """What the field's docstring says, in the unit of the page."""
    title, _ = split_unit(field_docs(kind)[field])
    return f"{title} [{unit}]" if unit else title


def _flag(field: str) -> str:
    """What a field of `Gait` is called in the unit of the page, as on the command line."""
    return "frequency_deg_s" if field == "frequency" else f"{field}_deg"


def _shown(gait: Gait, field: str, low: float, high: float) -> float:
    """A gait's angle in degrees, without the last digits that degrees lose."""
    return min(max(round(math.degrees(getattr(gait, field)), 9), low), high)
