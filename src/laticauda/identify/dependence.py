"""Which measurements depend on which unknowns."""

from collections.abc import Mapping, Sequence
from itertools import compress

import numpy as np
from jaxtyping import Bool

from laticauda.identify.resolving import ScopedName
from laticauda.models.simulate import Parameter
from laticauda.models.simulate.numbers import check_disjoint
from laticauda.values import BadArgument

Dependence = Bool[np.ndarray, "n_measurements n_unknowns"]
"""Whether each measurement depends on each unknown."""


def find_dependence(
    scoped_names: Sequence[ScopedName],
    scopes: Sequence[set[str]],
    numbers: Sequence[Mapping[str, Parameter]],
) -> Dependence:
    """Determine which measurements depend on which unknowns.

    If a number is identified both in general and for a scope, the general one does not apply to
    that scope.

    Args:
        scoped_names: Scope and name of each unknown.
        scopes: Scopes to which each measurement belongs.
        numbers: Numbers of each measurement, by name.

    Raises:
        ValueError: If two unknowns stand for the same number of a measurement.
    """
    depends_on = np.zeros((len(numbers), len(scoped_names)), dtype=bool)
    for i, (own_scopes, own_numbers) in enumerate(zip(scopes, numbers, strict=True)):
        for k, (scope, name) in enumerate(scoped_names):
            depends_on[i, k] = name in own_numbers and (not scope or scope in own_scopes)
    _let_scopes_take_precedence(depends_on, scoped_names)
    _check_unambiguous(depends_on, scoped_names)
    return depends_on


def _let_scopes_take_precedence(depends_on: Dependence, scoped_names: Sequence[ScopedName]) -> None:
    for k, specific in enumerate(scoped_names):
        for j, general in enumerate(scoped_names):
            is_same_number = j != k and general.name == specific.name
            if is_same_number and specific.scope and not general.scope:
                depends_on[:, j] &= ~depends_on[:, k]


def _check_unambiguous(depends_on: Dependence, scoped_names: Sequence[ScopedName]) -> None:
    for k, scoped_name in enumerate(scoped_names):
        for j, rival in enumerate(scoped_names):
            is_same_number = j != k and rival.name == scoped_name.name
            if is_same_number and any(depends_on[:, j] & depends_on[:, k]):
                both_scopes = f"`{scoped_name.scope}` and `{rival.scope}`"
                rule = f"must list `{scoped_name.name}` once per measurement at most"
                raise BadArgument("parameters", f"{rule}, got both {both_scopes}")
    for own_dependence in np.unique(depends_on, axis=0):
        check_disjoint([name for _, name in compress(scoped_names, own_dependence)], "parameters")
