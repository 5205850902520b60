"""Controls of the water: a uniform current, or a flow with fields for the numbers that it declares."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from laticauda.robot import Current, current_names, load_current
from laticauda.scenarios import Scenario
from laticauda.show.cockpit.changes import STILL, Changes
from laticauda.show.cockpit.control import Control, read_hint, read_water, spell_out
from laticauda.show.cockpit.live import Live
from laticauda.values import check_within, quantities_of
from laticauda.water.fluid import Flow

FASTEST_CURRENT = 2.0
"""Maximum along an axis [m/s]."""
AXES = ("x", "y")
UNIFORM = "uniform"
"""Name of a uniform current."""
FIRST_FLOW = "as it came"
"""Name of the flow with which the page started."""
PREFIX = "flow_"
"""Prefix of the names of a flow's own fields."""
DIGITS = 9
"""Digits that are shown at most: the conversion to degrees loses the last ones."""
HINT_OF_CURRENT = "V, the velocity of the water along world x and y [m/s]"
HINT_OF_FLOW = (
    "How the water moves; a flow that is new to this computer is compiled first, about 10 s"
)


class WaterControls:
    """Controls of the water's motion.

    Args:
        gui: GUI of the page's server; the controls are added at its current position.
        live: The simulation that they control.
        by_name: All controls of the page, to which those of the water are added.
        listen: Called by viser when a field of a flow is set.
    """

    def __init__(
        self,
        gui: Any,
        live: Live,
        by_name: dict[str, Control],
        listen: Callable[[Any], Any],
    ) -> None:
        self._gui = gui
        self._live = live
        self._by_name = by_name
        self._listen = listen
        for axis, name in enumerate(AXES):
            handle = gui.add_number(f"current {name} [m/s]", 0.0, step=0.01, hint=HINT_OF_CURRENT)
            field = CurrentField(live=live, axis=axis)
            by_name[f"current_{name}"] = Control(handle, field.read, field.change)
        self._currents = _collect_currents(live.scenario)
        self._chosen = FIRST_FLOW
        """Name of the water's motion that was chosen last."""
        handle = gui.add_dropdown("flow", tuple(self._currents), hint=HINT_OF_FLOW)
        by_name["flow"] = Control(handle, self._read_name, self._choose)
        self._class_of_flow: type = type(None)
        """Class of the flow whose fields are shown."""
        self._folder = gui.add_folder("Flow", visible=False)

    def _read_name(self, scenario: Scenario) -> str:
        """Return the name of the water's motion: the one chosen last, if it is of that kind."""
        class_of_current = type(read_water(scenario).current)
        for name in (self._chosen, *self._currents):
            if type(self._currents.get(name)) is class_of_current:
                return name
        return UNIFORM

    def _choose(self, name: str) -> Changes:
        self._chosen = name
        return {"current": self._currents[name]}

    def update_fields(self, scenario: Scenario) -> None:
        """Show fields for the parameters of a scenario's flow, in place of those of the previous flow."""
        flow = read_water(scenario).flow
        if type(flow) is self._class_of_flow:
            return
        self._class_of_flow = type(flow)
        for name in list(self._by_name):
            if name.startswith(PREFIX):
                self._by_name.pop(name).handle.remove()
        self._folder.visible = flow is not None
        for axis in AXES:
            self._by_name[f"current_{axis}"].handle.visible = flow is None
        if flow is not None:
            self._add_fields(flow)

    def _add_fields(self, flow: Flow) -> None:
        """Add a field for every number and every vector of a flow; its other parameters cannot be set."""
        for name, declared in quantities_of(type(flow)).items():
            value: Any = getattr(flow, name)
            is_number = type(value) in (int, float)
            is_vector = np.shape(value) == (3,)
            if is_number or is_vector:
                field = FlowField(live=self._live, name=name, unit=declared.unit)
                self._add_field(field, flow, value)

    def _add_field(self, field: "FlowField", flow: Flow, value: Any) -> None:
        add_handle = self._gui.add_number
        if isinstance(value, tuple):
            add_handle = self._gui.add_vector3
        hint = read_hint(type(flow), field.name)
        with self._folder:
            handle = add_handle(field.label, value, step=field.step_of(value), hint=hint)
        handle.on_update(self._listen)
        self._by_name[f"{PREFIX}{field.name}"] = Control(handle, field.read, field.change)


def _collect_currents(scenario: Scenario) -> dict[str, Current]:
    """Return the motions of the water that can be chosen, by their names."""
    currents: dict[str, Current] = {UNIFORM: STILL}
    first_flow = read_water(scenario).flow
    if first_flow:
        currents[FIRST_FLOW] = first_flow
    for name in current_names():
        currents[name] = load_current(name)
    return currents


@dataclass(frozen=True, kw_only=True)
class CurrentField:
    """A field for the velocity of a uniform current along one axis."""

    live: Live
    """The simulation."""
    axis: int
    """0 for x, 1 for y."""

    def read(self, scenario: Scenario) -> float:
        """Return the value of a scenario [m/s]."""
        return read_water(scenario).uniform[self.axis]

    def change(self, value: float) -> Changes:
        """Return the changes that result from setting the velocity [m/s]."""
        velocity = list(read_water(self.live.scenario).uniform[:2])
        velocity[self.axis] = check_within(
            "current", value, -FASTEST_CURRENT, FASTEST_CURRENT, "m/s"
        )
        return {"current": cast(Current, tuple(velocity))}


@dataclass(frozen=True, kw_only=True)
class FlowField:
    """A field for one parameter of a flow; angles are in degrees on the page."""

    live: Live
    """The simulation."""
    name: str
    """The parameter."""
    unit: str
    """Its unit in the flow."""

    @property
    def is_angle(self) -> bool:
        """Whether the page shows degrees."""
        return self.unit.startswith("rad")

    @property
    def label(self) -> str:
        """Label on the page."""
        unit = self.unit.replace("rad", "°") or "-"
        return spell_out(f"{self.name} [{unit}]")

    def step_of(self, value: Any) -> float:
        """Return the smallest step of the field, for a parameter with such a value."""
        if isinstance(value, int):
            return 1
        if self.is_angle:
            return 0.5
        return 0.001

    def read(self, scenario: Scenario) -> Any:
        """Return the value of a scenario."""
        value = getattr(read_water(scenario).flow, self.name)
        if self.is_angle:
            return round(math.degrees(1.0) * value, DIGITS)
        return value

    def change(self, value: Any) -> Changes:
        """Return the changes that result from setting the parameter."""
        flow: Any = read_water(self.live.scenario).flow
        if self.is_angle:
            value = value / math.degrees(1.0)
        return {"current": replace(flow, **{self.name: value})}
