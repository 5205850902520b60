"""Other laws of the water that are tried if the model of a fit is in doubt.

They are the drag laws that exist, each with both forms of the added mass: without the water that
the tail sheds, as in the paper, and with it (Kirchhoff's equations and Lighthill's wake, as in the
textbook's water). The unknowns are those of the fit, apart from those of its own drag law.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.robot import Environment, Water
from laticauda.values import extensions
from laticauda.water.fluid.laws import DragLaw, PolynomialDrag, TotalSpeedDrag

DRAG_LAWS: Mapping[str, DragLaw] = {
    "polynomial-drag": PolynomialDrag(),
    "total-speed-drag beta 0": TotalSpeedDrag(beta=0.0),
    "total-speed-drag beta 0.5": TotalSpeedDrag(beta=0.5),
    "total-speed-drag beta 1": TotalSpeedDrag(beta=1.0),
}
"""Drag laws that are tried, by name."""
_WITHOUT_WAKE: Mapping[str, Any] = {
    "added_mass_form": "relative",
    "rotational": "paper",
    "trailing_edge": "none",
}
_WITH_WAKE: Mapping[str, Any] = {
    "added_mass_form": "kirchhoff",
    "rotational": "strip",
    "trailing_edge": "elongated",
}
_OF_DRAG = "water.drag."
"""Beginning of the names of a drag law's numbers."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RivalLaw:
    """Another law of the water for the same measurements."""

    name: str
    """Name for messages."""
    has_other_form: bool
    """Whether its added mass has another form than that of the fit."""
    problem: Problem
    """The measurements in such a water, and the unknowns that it has."""


def name_law(water: Water) -> str:
    """Return the name of the law of a water for messages.

    Args:
        water: The water.
    """
    name = extensions.name_of(type(water.drag))
    if isinstance(water.drag, TotalSpeedDrag):
        name += f" beta {water.drag.beta:g}"
    if water.added_mass_form == "relative":
        return name
    return f"{name}, {water.added_mass_form} added mass"


def list_rival_laws(problem: Problem) -> list[RivalLaw]:
    """Return the problems with other laws; none if there is no water whose law could be another.

    Those with the same form of the added mass come first.

    Args:
        problem: Measurements and unknowns.
    """
    waters = [scenario.environment for scenario in problem.scenarios]
    if not all(isinstance(water, Water) for water in waters):
        return []
    if any(_is_tied_to_drag(unknown.tied) for unknown in problem.unknowns):
        return []
    own = waters[0]
    assert isinstance(own, Water)
    other_drags = [drag for drag in DRAG_LAWS.values() if not _is_drag_of(problem, own, drag)]
    rivals: list[RivalLaw] = []
    for drag in other_drags:
        rivals.append(_rival_law(problem, {}, drag))
    for form in (_WITHOUT_WAKE, _WITH_WAKE):
        if own.added_mass_form != form["added_mass_form"]:
            rivals.append(_rival_law(problem, form, None))
            for drag in other_drags:
                rivals.append(_rival_law(problem, form, drag))
    return rivals


def _is_drag_of(problem: Problem, own: Water, drag: DragLaw) -> bool:
    """Return whether a drag law is that of the fit, whose numbers may be among the unknowns."""
    if drag == own.drag:
        return True
    is_fitted = any(unknown.parameter.name.startswith(_OF_DRAG) for unknown in problem.unknowns)
    return is_fitted and type(drag) is type(own.drag)


def _is_tied_to_drag(tied: Mapping[str, float]) -> bool:
    return any(name.startswith(_OF_DRAG) for name in tied)


def _rival_law(problem: Problem, form: Mapping[str, Any], drag: DragLaw | None) -> RivalLaw:
    """Return the problem with another form of the added mass, another drag law, or both.

    Args:
        problem: Measurements and unknowns.
        form: Fields of the waters that change; none: the form stays.
        drag: The drag law; None: each water keeps its own.
    """
    changes = dict(form)
    if drag is not None:
        changes["drag"] = drag
    changed_waters: dict[int, Water] = {}
    measurements: list[Measurement] = []
    for measurement in problem.measurements:
        water = measurement.scenario.environment
        # Measurements that share a water as an object go on to share it: see `body_key`.
        if id(water) not in changed_waters:
            changed_waters[id(water)] = _changed(water, changes)
        scenario = replace(measurement.scenario, environment=changed_waters[id(water)])
        measurements.append(replace(measurement, scenario=scenario))
    kept = list(range(len(problem.unknowns)))
    if drag is not None:
        kept = [
            k
            for k, unknown in enumerate(problem.unknowns)
            if not unknown.parameter.name.startswith(_OF_DRAG)
        ]
    return RivalLaw(
        name=name_law(next(iter(changed_waters.values()))),
        has_other_form=bool(form),
        problem=replace(
            problem,
            measurements=tuple(measurements),
            unknowns=tuple(problem.unknowns[k] for k in kept),
            depends_on=problem.depends_on[:, kept],
        ),
    )


def _changed(water: Environment, changes: Mapping[str, Any]) -> Water:
    assert isinstance(water, Water)  # checked by `list_rival_laws`
    return replace(water, **changes)
