"""Other laws of the water that are tried beside that of a fit.

They are the drag laws that exist, each with both forms of the added mass: without the water that
the tail sheds, as in the paper, and with it (Kirchhoff's equations and Lighthill's wake, as in the
textbook's water). The unknowns are those of the fit, apart from those of its own drag law. Linear
plus quadratic drag is tried twice: with both equal at 1 m/s, as the literature has it, and with
that speed, U_ref, fitted in addition.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.identify.unknowns import ResolvedUnknown
from laticauda.models.simulate import Parameter
from laticauda.robot import Environment, Water
from laticauda.values import extensions
from laticauda.water.fluid.laws import DragLaw, PolynomialDrag, TotalSpeedDrag

DRAG_LAWS: Mapping[str, DragLaw] = {
    "total-speed-drag beta 0": TotalSpeedDrag(beta=0.0),
    "total-speed-drag beta 0.5": TotalSpeedDrag(beta=0.5),
    "total-speed-drag beta 1": TotalSpeedDrag(beta=1.0),
    "polynomial-drag": PolynomialDrag(),
}
"""Drag laws that are tried, by name."""
_REFERENCE_SPEED = ResolvedUnknown(
    name="water.drag.reference_speed",
    parameter=Parameter(
        name="water.drag.reference_speed",
        unit="m/s",
        title="U_ref, at which linear and quadratic drag are equal",
    ),
    start=1.0,
    lower=0.01,  # far below the speeds of robots: the drag is quadratic
    upper=10.0,  # far above: it is linear
    is_log=True,
    size=1.0,
)
"""The number of the drag law that is fitted in addition."""
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
    fits_reference_speed: bool = False
    """Whether the reference speed of its drag law is fitted in addition."""

    def name_with(self, values: Mapping[str, float]) -> str:
        """Return the name, with the reference speed if that was fitted.

        Args:
            values: Fitted values, by name.
        """
        if not self.fits_reference_speed:
            return self.name
        speed = values[_REFERENCE_SPEED.name]
        return f"{self.name} (linear and quadratic drag equal at {speed:.2g} m/s)"


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

    Those with the same form of the added mass come first. One with a fitted reference speed follows
    the same law without, from whose values its search may begin.

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
    rivals = _rivals_of_form(problem, {}, other_drags)
    for form in (_WITHOUT_WAKE, _WITH_WAKE):
        if own.added_mass_form != form["added_mass_form"]:
            rivals.append(_rival_law(problem, form, None))
            rivals += _rivals_of_form(problem, form, other_drags)
    return rivals


def _rivals_of_form(
    problem: Problem, form: Mapping[str, Any], drags: Sequence[DragLaw]
) -> list[RivalLaw]:
    """Return the problems with other drag laws, in waters with some form of the added mass."""
    rivals = [_rival_law(problem, form, drag) for drag in drags]
    if not any(_is_reference_speed(unknown) for unknown in problem.unknowns):
        fixed = _rival_law(problem, form, PolynomialDrag())
        if fixed.problem.observed.size > len(fixed.problem.unknowns) + 1:
            rivals.append(_with_fitted_reference_speed(fixed))
    return rivals


def _is_reference_speed(unknown: ResolvedUnknown) -> bool:
    return unknown.parameter.name == _REFERENCE_SPEED.name


def _with_fitted_reference_speed(rival: RivalLaw) -> RivalLaw:
    problem = rival.problem
    on_every_run = np.ones((len(problem.measurements), 1), dtype=bool)
    return replace(
        rival,
        name=rival.name.replace("polynomial-drag", "polynomial-drag with fitted U_ref"),
        fits_reference_speed=True,
        problem=replace(
            problem,
            unknowns=(*problem.unknowns, _REFERENCE_SPEED),
            depends_on=np.hstack([problem.depends_on, on_every_run]),
        ),
    )


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
