"""Controls of the page: the quantities that can be set, with units and sensible limits, and the resulting changes."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib.util import find_spec
from typing import Any, NamedTuple, cast

import numpy as np

from laticauda.connect.web.sliders import LIMITS
from laticauda.control import StraightLine
from laticauda.motion.gaits import Gait, Wave, envelope_of, list_kinds
from laticauda.motion.gaits.gait import STRAIGHT
from laticauda.motion.joints.laws import JointLaw
from laticauda.robot import (
    CaudalFin,
    Current,
    Robot,
    Water,
    current_names,
    load_current,
    load_robot,
    robot_names,
)
from laticauda.scenarios import MODELS, Scenario
from laticauda.show.cockpit.live import SPEEDS, Live
from laticauda.show.cockpit.pages import Event, EventQueue, refusing
from laticauda.show.cockpit.simulation import STILL, Changes, change_fin, depth_of, path_of
from laticauda.values.checks import check_positive, check_within
from laticauda.values.extensions import name_of
from laticauda.values.quantities import quantities_of, texts_of
from laticauda.water.fluid.flow import Flow

PITCH = "pitch_"  # prefix of the names of the pitch wave's controls
PITCH_LIMITS = {**LIMITS["gait"], "amplitude": (0.0, 45.0, 1.0), "phase": (-180.0, 180.0, 5.0)}
DEEPEST = 10.0  # largest depth that can be set [m]
CURRENT = 2.0  # maximum along an axis [m/s]
RIGIDITY = 0.2  # initial value of an elastic fin [N m^2]
FINS = ("none", "rigid", "elastic")
UNIFORM, OWN, IN_FLOW = (
    "uniform",
    "as it came",
    "flow_",
)  # a uniform current, and the water as when the page started
FLOW = "How the water moves; a flow that is new to this computer is compiled first, about 10 s"
ASIDE = 0.6  # from the robot to the start of a path [m]


class Control(NamedTuple):
    """One quantity that can be set."""

    handle: Any
    """Handle of the control on the page."""
    shown: Callable[[Scenario], Any]
    """Returns the value that it shows for a scenario."""
    changes: Callable[[Any], Changes]
    """Returns the changes that result from setting it to a value."""


class Controls:
    """Controls of one page's server; all pages show the same.

    Args:
        gui: GUI of the page's server.
        live: The simulation that they control.
        events: Queue in which their events are handled.
        changed: Called after every change.
    """

    def __init__(
        self, gui: Any, live: Live, events: EventQueue, changed: Callable[[], None]
    ) -> None:
        self._gui, self._live, self._changed = gui, live, changed
        self._listen = events.handler(self.apply, then=self.settle)
        self._own, self._envelope, self._rigidity = (
            live.scenario.robot,
            live.scenario.gait.envelope,
            RIGIDITY,
        )
        self.by_name: dict[str, Control] = {}
        """Controls by what they set."""
        with gui.add_folder("Gait"):
            self._add_gait(gui, live.scenario.gait)
        with gui.add_folder("Robot and water"):
            self._add_body(gui)
        with gui.add_folder("Path"):
            hint = "Follow a straight line with the paper's line-of-sight guidance; drag its gizmo to move or turn it."
            follow = gui.add_checkbox("follow a path", False, hint=hint)
            self._add(
                "path",
                follow,
                lambda now: path_of(now) is not None,
                lambda on: {"path": self._new_path(on)},
            )
        with gui.add_folder("Time"):
            self.speed = gui.add_slider("speed of time [-]", SPEEDS[0], SPEEDS[1], 0.1, live.speed)
            pause = gui.add_checkbox("pause", live.paused)
            self.reset = gui.add_button("reset")
        with gui.add_folder("In space"):
            hint = "Along the path, by the pitch joints of a robot in space; 0: depth is not steered [m]"
            depth = gui.add_number(
                "hold depth [m]", 0.0, min=0.0, max=DEEPEST, step=0.05, hint=hint
            )
            self._add("depth", depth, lambda now: depth_of(now) or 0.0, self._at_depth)
            self._add_wave(gui, PITCH, PITCH_LIMITS)
        for control in self.by_name.values():
            control.handle.on_update(self._listen)
        self.speed.on_update(events.handler(self.set_speed, then=self.settle))
        pause.on_update(events.handler(lambda event: setattr(live, "paused", event.value)))
        self.show(live.scenario)

    def show(self, scenario: Scenario) -> None:
        """Update the controls to a scenario that came from elsewhere."""
        fin = scenario.robot.caudal_fin
        self._rigidity = (fin.flexural_rigidity if fin else None) or self._rigidity
        flow = _water(scenario).flow
        if type(flow) is not self._flow_kind:
            self._add_numbers(flow)
        for control in self.by_name.values():
            control.handle.value = control.shown(scenario)

    @refusing
    def apply(self, event: Event) -> None:
        """Change only what a user has set: an untouched control may not show the full state."""
        control = next(one for one in self.by_name.values() if one.handle is event.target)
        self._live.alter(**control.changes(event.value))

    def settle(self) -> None:
        """Show the actual state on all pages."""
        self.show(self._live.scenario)
        self.speed.value = self._live.speed
        self._changed()

    @refusing
    def set_speed(self, event: Event) -> None:
        """Set the speed of time."""
        self._live.speed = event.value

    def _add(
        self,
        name: str,
        handle: Any,
        shown: Callable[[Scenario], Any],
        changes: Callable[[Any], Changes],
    ) -> None:
        self.by_name[name] = Control(handle, shown, changes)

    def _add_gait(self, gui: Any, gait: Gait) -> None:
        names = {_words(kind): kind for kind in (*list_kinds(), gait.kind)}
        handle = gui.add_dropdown("gait", tuple(names), hint=_hint(Gait, "envelope"))
        self._add(
            "kind",
            handle,
            lambda now: _words(now.gait.kind),
            lambda it: {"gait": self._of_kind(names[it])},
        )
        self._add_wave(gui, "", LIMITS["gait"])

    def _add_wave(
        self, gui: Any, wave: str, limits: Mapping[str, tuple[float, float, float]]
    ) -> None:
        """Add sliders for the gait's own parameters, or for those of its pitch wave."""
        kind: type = Wave if wave else Gait
        for field, (low, high, step) in limits.items():
            unit = quantities_of(kind)[field].unit
            label = _words(f"{wave}{field} [{unit.replace('rad', '°')}]")
            hint = _hint(kind, field, unit.replace("rad", "deg"))
            handle = gui.add_slider(label, low, high, step, max(low, 0.0), hint=hint)

            def shown(
                now: Scenario, field: str = field, low: float = low, high: float = high
            ) -> float:
                """Return the value without the last digits, which the conversion to degrees loses."""
                one = (now.gait.pitch or STRAIGHT) if wave else now.gait
                return min(max(round(math.degrees(getattr(one, field)), 9), low), high)

            def changes(
                value: float, field: str = field, low: float = low, high: float = high
            ) -> Changes:
                """Check the slider's range, which typed values may exceed; the gait itself rejects impossible ones."""
                gait, new = self._live.scenario.gait, {field: math.radians(value)}
                if wave:
                    usual = Wave(
                        amplitude=0.0, frequency=gait.frequency, phase_shift=gait.phase_shift
                    )
                    pitch = replace(gait.pitch or usual, **new)
                    new = {"pitch": pitch if value or pitch.amplitude or pitch.offset else None}
                gait = replace(gait, **new)
                name = f"{wave}{field}_deg"
                check_within(name.replace("frequency_deg", "frequency_deg_s"), value, low, high)
                return {"gait": gait}

            self._add(f"{wave}{field}", handle, shown, changes)

    def _add_body(self, gui: Any) -> None:
        names = tuple(dict.fromkeys((*robot_names(), self._own.name)))
        handle = gui.add_dropdown("robot", names)
        self._add(
            "robot",
            handle,
            lambda now: self._base(now.robot.name).name,
            lambda it: {"robot": self._base(it)},
        )
        handle = gui.add_dropdown("fin", FINS)
        self._add(
            "fin",
            handle,
            lambda now: _fin_of(now.robot),
            lambda it: {"robot": self._with(it, self._rigidity)},
        )
        hint = _hint(CaudalFin, "flexural_rigidity", "N m^2")
        handle = gui.add_number("rigidity [N m²]", RIGIDITY, step=0.01, hint=hint)
        self._add(
            "rigidity", handle, lambda _: self._rigidity, lambda it: {"robot": self._bent(it)}
        )
        handle = gui.add_dropdown("model", available_models())
        self._add("model", handle, lambda now: name_of(type(now.model)), lambda it: {"model": it})
        handle = gui.add_dropdown("joints", JointLaw.names())
        self._add(
            "joints", handle, lambda now: name_of(type(now.model.joints)), lambda it: {"joints": it}
        )
        hint = "V, the velocity of the water along world x and y [m/s]"
        for axis, name in enumerate(("x", "y")):
            handle = gui.add_number(f"current {name} [m/s]", 0.0, step=0.01, hint=hint)

            def changes(value: float, axis: int = axis) -> Changes:
                both = [*_water(self._live.scenario).uniform[:2]]
                both[axis] = check_within("current", value, -CURRENT, CURRENT, "m/s")
                return {"current": cast(Current, tuple(both))}

            self._add(
                f"current_{name}", handle, lambda now, axis=axis: _water(now).uniform[axis], changes
            )
        presets, own = (
            {name: load_current(name) for name in current_names()},
            _water(self._live.scenario).flow,
        )
        self._currents: dict[str, Current] = {
            UNIFORM: STILL,
            **({OWN: own} if own else {}),
            **presets,
        }
        self._flow, self._flow_kind = OWN, type(None)
        handle = gui.add_dropdown("flow", (*self._currents,), hint=FLOW)
        self._add("flow", handle, self._flow_name, self._of_flow)
        self._numbers = gui.add_folder("Flow", visible=False)

    def _flow_name(self, now: Scenario) -> str:
        """Return the name of the water's motion: the one chosen last, if it is of that kind."""
        names, kind = (self._flow, *self._currents), type(_water(now).current)
        return next((name for name in names if type(self._currents.get(name)) is kind), UNIFORM)

    def _of_flow(self, name: str) -> Changes:
        self._flow = name
        return {"current": self._currents[name]}

    def _add_numbers(self, flow: Flow | None) -> None:
        """Add fields for the parameters that a flow declares, in place of those of the previous flow."""
        for name in [name for name in self.by_name if name.startswith(IN_FLOW)]:
            self.by_name.pop(name).handle.remove()
        self._flow_kind, self._numbers.visible = type(flow), flow is not None
        for axis in "xy":
            self.by_name[f"current_{axis}"].handle.visible = flow is None
        for field, declared in quantities_of(type(flow)).items() if flow else ():
            value: Any = getattr(flow, field)
            if type(value) not in (int, float) and np.shape(value) != (3,):
                continue
            per = math.degrees(1.0) if declared.unit.startswith("rad") else 1.0
            step = 1 if isinstance(value, int) else 0.5 if per > 1.0 else 0.001

            def shown(now: Scenario, field: str = field, per: float = per) -> Any:
                """Return the value without the last digits, which the conversion to degrees loses."""
                value = getattr(_water(now).flow, field)
                return round(per * value, 9) if per > 1.0 else value

            def changes(value: Any, field: str = field, per: float = per) -> Changes:
                flow: Any = _water(self._live.scenario).flow
                return {"current": replace(flow, **{field: value / per if per > 1.0 else value})}

            with self._numbers:
                add = self._gui.add_vector3 if isinstance(value, tuple) else self._gui.add_number
                label = _words(f"{field} [{declared.unit.replace('rad', '°') or '-'}]")
                handle = add(label, value, step=step, hint=_hint(type(flow), field))
            handle.on_update(self._listen)
            self._add(f"{IN_FLOW}{field}", handle, shown, changes)

    def _of_kind(self, kind: str) -> Gait:
        envelope = self._envelope if kind == self._envelope.kind else envelope_of(kind)
        return replace(self._live.scenario.gait, envelope=envelope)

    def _base(self, name: str) -> Robot:
        """Return a robot with its original fin; the page's own robot if the name is not a preset."""
        return load_robot(name) if name != self._own.name and name in robot_names() else self._own

    def _with(self, fin: str, rigidity: float) -> Robot:
        base = self._base(self._live.scenario.robot.name)
        return change_fin(base, fin != "none", rigidity if fin == "elastic" else None)

    def _bent(self, rigidity: float) -> Robot:
        """Return the robot with an elastic fin of this rigidity; without a fin, keep the rigidity for the next one."""
        if self._live.scenario.robot.caudal_fin is None:
            self._rigidity = check_positive("flexural_rigidity", rigidity, "N m^2")
            return self._live.scenario.robot
        return self._with("elastic", rigidity)

    def _at_depth(self, depth: float) -> Changes:
        """Return the changes that hold a depth along the path, or straight ahead if there is none."""
        found: Changes = {"depth": depth or None}
        if depth and path_of(self._live.scenario) is None:
            found["path"] = self._new_path(True, aside=0.0)
        return found

    def _new_path(self, is_followed: bool, aside: float = ASIDE) -> StraightLine | None:
        """Return a path along the robot's heading, some distance to its right, so that the approach is visible."""
        if not is_followed:
            return None
        sample = self._live.latest()
        x, y = (float(value) for value in sample.center_of_mass[:2])
        angle = float(sample.heading)
        return StraightLine(
            point=(x + aside * math.sin(angle), y - aside * math.cos(angle)), angle=angle
        )


def available_models() -> tuple[str, ...]:
    """Return the models available in this installation."""
    return tuple(name for name in MODELS if name == "planar" or find_spec("mujoco"))


def _water(scenario: Scenario) -> Water:
    assert isinstance(scenario.environment, Water)
    return scenario.environment


def _fin_of(robot: Robot) -> str:
    if robot.caudal_fin is None:
        return "none"
    return "elastic" if robot.caudal_fin.n_hinges else "rigid"


def _words(name: str) -> str:
    """Return the name that the page shows."""
    return name.replace("_", " ")


def _hint(kind: type, field: str, unit: str = "") -> str:
    """Return the text of a field's declaration, with the unit used on the page."""
    title = texts_of(kind)[field]
    return f"{title} [{unit}]" if unit else title
