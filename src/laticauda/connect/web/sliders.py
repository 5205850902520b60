"""Sliders of a web page: what can be set, and in which ranges."""

from typing import Any

import laticauda as lc
from laticauda import control, robot
from laticauda.connect.slider_ranges import LIMITS, SliderRange
from laticauda.connect.web.robot_data import ELASTIC_FIN
from laticauda.motion.gaits import FIRST_GAIT
from laticauda.values import fields_of


def list_sliders() -> list[dict[str, Any]]:
    """Return all sliders in page order: group, kernel variable ("" for path following), flag, texts, limits."""
    water = lc.load_water("paper-lateral")
    owners: dict[str, object] = {
        "gait": FIRST_GAIT,
        "fin": robot.CaudalFin(**ELASTIC_FIN),
        "water": water,
        "current": water,
        "path": control.Following(),
    }
    sliders: list[dict[str, Any]] = []
    for group, ranges in LIMITS.items():
        for name, slider_range in ranges.items():
            if group == "current":
                slider = _make_current_slider(water, name, slider_range)
            else:
                slider = _make_slider(group, owners[group], name, slider_range)
            sliders.append(slider)
    return sliders


def _make_slider(group: str, owner: object, name: str, slider_range: SliderRange) -> dict[str, Any]:
    """Return the slider of a field; the owner holds its initial value."""
    field = fields_of(type(owner))[name]
    initial_value = getattr(owner, name)
    if field.display.differs_from_si:
        initial_value = round(field.display.from_si(initial_value), 9)
    variable = f"{group}.{name}"
    if group == "path":
        variable = ""
    flag = name + field.display.ending
    return {
        "group": group,
        "field": name,
        "variable": variable,
        "flag": flag.replace("_", "-").replace(" ", "-"),
        "label": name.replace("_", " "),
        "unit": _shown_unit(field.unit),
        "text": field.text,
        **slider_range._asdict(),
        "factor": field.display.in_si_unit,
        "usual": initial_value,
    }


def _make_current_slider(water: lc.Water, axis: str, slider_range: SliderRange) -> dict[str, Any]:
    """Return the slider of the velocity of the water along an axis, which is 0 at first."""
    field = fields_of(type(water))["current"]
    flag = f"current{field.display.ending}-{axis}"
    return {
        "group": "current",
        "field": "current",
        "variable": f"current.{axis}",
        "flag": flag.replace("_", "-").replace(" ", "-"),
        "label": f"current {axis}",
        "unit": _shown_unit(field.unit),
        "text": field.text,
        **slider_range._asdict(),
        "factor": field.display.in_si_unit,
        "usual": 0.0,
    }


def _shown_unit(unit: str) -> str:
    return unit.replace("rad", "°").replace("^2", "²")
