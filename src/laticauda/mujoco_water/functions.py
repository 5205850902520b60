"""Laws and flows as functions that the water's callback calls by their address."""

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from laticauda.compiling.formulas import digest_of
from laticauda.compiling.templates import load, sources_digest
from laticauda.fluid.flow import Flow
from laticauda.fluid.laws import DragLaw
from laticauda.formulas import Formula

_entries: dict[str, Any] = {}


def compiled_law(law: DragLaw) -> Any:
    """A cfunc of two addresses: of what `table.LOADS` numbers a law gets, its loads behind them, and of its own.

    Raises:
        ValueError: If it cannot be compiled.
    """
    return _compiled(law, [law.formula], {"law": law.formula})


def compiled_flow(flow: Flow, kinds: tuple[Formula, ...]) -> Any:
    """A cfunc of two addresses: of place and time, what is felt there behind them, and of the numbers of its parts.

    Args:
        flow: How the water moves.
        kinds: Those of its parts, see `fluid.flow.rows_of`.

    Raises:
        ValueError: If it cannot be compiled.
    """
    return _compiled(flow, kinds, {"flow": kinds})


def _compiled(law: DragLaw | Flow, formulas: Sequence[Formula], names: Mapping[str, Any]) -> Any:
    """The entry for a law, which is checked, or for one of the same formulas."""
    made_of = [*names, *map(digest_of, formulas), sources_digest("laticauda.mujoco_water.law_entry")]
    key = hashlib.sha256(" ".join(made_of).encode()).hexdigest()[:16]
    if key not in _entries:
        law.check()
        _entries[key] = load(Path(__file__).with_name("law_entry.py"), key, names).call
    return _entries[key]
