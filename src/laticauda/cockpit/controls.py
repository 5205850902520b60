"""The page's controls: what can be set, with its unit and its sensible limits, and what the page then asks for."""

import math
from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec
from typing import Any

from laticauda.cockpit.live import SPEEDS, Live
from laticauda.cockpit.settings import Setting, with_fin
from laticauda.cockpit.turns import Asked, Turns
from laticauda.control import StraightLine
from laticauda.errors import LaticaudaError, within
from laticauda.gaits import GAIT_KINDS, Gait
from laticauda.quantities import texts_of
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
        turns: Where what they ask for is done.
        changed: Called after every change.
    """

    def __init__(self, gui: Any, live: Live, turns: Turns, changed: Callable[[], None]) -> None:
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
        inputs = (*inputs, self._joints, *self._current, self._follow)
        # What the controls stand for: what is on the page may be further on.
        self._stands = {id(handle): handle.value for handle in inputs}
        for handle in inputs:
            handle.on_update(turns.hear(self._apply, then=self._settle))
        self._speed.on_update(turns.hear(self._set_speed, then=self._settle))
        self._pause.on_update(turns.hear(self._set_pause))

    @property
    def reset(self) -> Any:
        """The button that begins anew."""
        return self._reset

    def show(self, setting: Setting) -> None:
        """Let the controls show a setting that came from elsewhere."""
        self._put(self._kind, setting.gait.kind)
        for _, field, low, high, _ in ANGLES:
            self._put(self._angles[field], _shown(setting.gait, field, low, high))
        self._put(self._robot, self._own_name(setting.robot))
        fin = setting.robot.caudal_fin
        self._put(self._fin, _fin_of(setting.robot))
        rigidity = None if fin is None else fin.flexural_rigidity
        self._put(self._rigidity, self._stands[id(self._rigidity)] if rigidity is None else rigidity)
        self._put(self._model, setting.model)
        self._put(self._joints, setting.joints)
        for handle, value in zip(self._current, setting.current, strict=True):
            self._put(handle, value)
        self._put(self._follow, setting.path is not None)

    def _put(self, handle: Any, value: Any) -> None:
        handle.value = self._stands[id(handle)] = value

    def _read(self, handle: Any, asked: Asked) -> Any:
        """What a control stands for, if somebody asks for something."""
        return asked.value if handle is asked.target else self._stands[id(handle)]

    def asked_for(self, asked: Asked) -> Setting:
        """The setting that somebody asks for.

        Args:
            asked: Which control was used: only what it stands for is read, so that a value between a slider's steps
                stays what it is.

        Raises:
            ValueError: If there is no such setting.
        """
        setting, touched = self._live.setting, asked.target
        gait = setting.gait
        if touched is self._kind:
            kind = asked.value
            gait = replace(gait, kind=kind, envelope=self._envelope if kind == "custom" else None)
        for _, field, low, high, _ in ANGLES:
            if touched is self._angles[field]:  # what is typed beside a slider may lie beyond its ends
                value = math.radians(asked.value)
                gait = replace(gait, **{field: value})  # what no gait can have, it refuses itself
                within(_flag(field), asked.value, low, high)
        robot = setting.robot
        if touched in (self._robot, self._fin, self._rigidity):
            robot = self._robot_asked_for(asked)
        path = setting.path
        if touched is self._follow:
            path = self._new_path() if asked.value else None
        current = setting.current
        if touched in self._current:
            x, y = (within("current", self._read(handle, asked), -CURRENT, CURRENT, "m/s") for handle in self._current)
            current = (x, y)
        return replace(
            setting,
            gait=gait,
            robot=robot,
            model=asked.value if touched is self._model else setting.model,
            joints=asked.value if touched is self._joints else setting.joints,
            current=current,
            path=path,
        )

    def _robot_asked_for(self, asked: Asked) -> Robot:
        name, fin, rigidity = (self._read(handle, asked) for handle in (self._robot, self._fin, self._rigidity))
        own = self._own if name == self._own.name else load_robot(name)
        if asked.target is self._robot:  # another robot comes with the fin that it has
            return own
        elastic = fin == "elastic" or (asked.target is self._rigidity and fin != "none")
        return with_fin(own, fin != "none", rigidity if elastic else None)

    def _new_path(self) -> StraightLine:
        """Along the heading that the robot has, some way to its right: so that it can be seen to come to it."""
        sample = self._live.latest()
        x, y = (float(value) for value in sample["center_of_mass"][:2])
        angle = float(sample["heading"])
        return StraightLine(point=(x + 0.6 * math.sin(angle), y - 0.6 * math.cos(angle)), angle=angle)

    def _apply(self, asked: Asked) -> None:
        try:
            self._live.change(self.asked_for(asked))
        except (ValueError, LaticaudaError) as error:
            refuse(asked.client, error)
        else:
            self._stands[id(asked.target)] = asked.value

    def _settle(self) -> None:
        """All pages show what is so."""
        self.show(self._live.setting)
        self._speed.value = self._live.speed
        self._changed()

    def _set_speed(self, asked: Asked) -> None:
        try:
            self._live.speed = asked.value
        except ValueError as error:
            refuse(asked.client, error)

    def _set_pause(self, asked: Asked) -> None:
        self._live.paused = asked.value

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
    """What the field's declaration says, in the unit of the page."""
    title = texts_of(kind)[field]
    return f"{title} [{unit}]" if unit else title


def _flag(field: str) -> str:
    """What a field of `Gait` is called in the unit of the page, as on the command line."""
    return "frequency_deg_s" if field == "frequency" else f"{field}_deg"


def _shown(gait: Gait, field: str, low: float, high: float) -> float:
    """A gait's angle in degrees, without the last digits that degrees lose."""
    return min(max(round(math.degrees(getattr(gait, field)), 9), low), high)
