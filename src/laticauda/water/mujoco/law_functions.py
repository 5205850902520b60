"""Drag laws and flows as functions that the callback calls by their address.

Each is a cfunc of two addresses. The first holds the `table.LOADS` numbers that a law takes, followed
by its loads; or position and time, followed by the flow felt there. The second holds the law's own
numbers, or those of a flow's parts.
"""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from laticauda.compiling.formulas import digest_of
from laticauda.compiling.templates import load
from laticauda.values import Formula
from laticauda.values.sources import sources_digest
from laticauda.water.fluid.flow import Flow, Rows
from laticauda.water.fluid.laws import DragLaw

TEMPLATE = "law_entry"
"""Template of these functions, next to this module."""
_compiled: dict[str, Any] = {}
"""Functions by the digest of everything that they are made of."""


def compile_law(law: DragLaw) -> Any:
    """Return the compiled function of a drag law.

    Args:
        law: Drag law.

    Raises:
        ValueError: If the law cannot be compiled.
    """
    return _compile(law, [law.formula], {"law": law.formula})


def compile_flow(flow: Flow, parts: Rows) -> Any:
    """Return the compiled function of a flow.

    Args:
        flow: Flow.
        parts: The same flow, as kernels take it.

    Raises:
        ValueError: If the flow cannot be compiled.
    """
    return _compile(flow, parts.kinds, {"flow": parts.kinds})


def _compile(law: DragLaw | Flow, formulas: Sequence[Formula], bindings: dict[str, Any]) -> Any:
    """Return the function of a law or flow, which is checked unless its formulas are known.

    Args:
        law: Law or flow.
        formulas: Its formulas.
        bindings: The bindings of the template.
    """
    digests = [digest_of(formula) for formula in formulas]
    template_digest = sources_digest(f"laticauda.water.mujoco.{TEMPLATE}")
    made_of = " ".join([*bindings, *digests, template_digest])
    key = hashlib.sha256(made_of.encode()).hexdigest()[:16]
    if key not in _compiled:
        law.check()
        template = Path(__file__).with_name(f"{TEMPLATE}.py")
        _compiled[key] = load(template, key, bindings).call
    return _compiled[key]
