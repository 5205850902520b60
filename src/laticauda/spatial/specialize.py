"""Compile the stepping in MuJoCo for a joint law; `drives` and `stepping` are templates, as those of `planar`."""

import hashlib
from functools import cache
from pathlib import Path
from threading import Lock
from types import ModuleType
from typing import Any

from laticauda.actuation.laws import JointLaw
from laticauda.compiling import templates
from laticauda.compiling.formulas import digest_of
from laticauda.compiling.sources import is_kept, sources_digest
from laticauda.formulas import Formula

TEMPLATES = ("drives", "stepping")
_one_at_a_time = Lock()


def specialize(joints: JointLaw | None = None) -> ModuleType:
    """The module `laticauda.spatial.stepping`, compiled on first call.

    Args:
        joints: Whose formula is compiled beside the built-in ones, if it is none of them.
    """
    own = None if joints is None else joints.own
    with _one_at_a_time:
        return _specialize(own, own and digest_of(own))


@cache
def _specialize(own: Formula | None, digest: str | None) -> ModuleType:
    sources = sources_digest(__name__, *(f"laticauda.spatial.{template}" for template in TEMPLATES))
    key = hashlib.sha256(f"{digest} {sources}".encode()).hexdigest()[:16]
    names: dict[str, Any] = {"joint_law": own}
    for template in TEMPLATES:
        names[template] = templates.load(Path(__file__).with_name(f"{template}.py"), key, names)
    return names["stepping"]


def is_compiled(joints: JointLaw | None = None) -> bool:
    """Whether the machine code is at hand or on disk; if not, the first run takes some ten seconds."""
    return is_kept(specialize(joints).run)
