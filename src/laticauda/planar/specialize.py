"""Compile the kernels for a lane width, a drag law and a joint law.

`loads`, `recursion`, `drives` and `stepping` are templates: each reads `WIDTH`, the laws' formulas and the templates
before it from here while it is loaded, and `specialize` loads each once per combination of what it is made for: another
drag law takes the drives as they are. A specialization's name carries a digest of all sources it is made of and of the
law's own code, so compiled code on disk is found again by the next process and is never stale: an edited law, or an
edited kernel, has another name and compiles anew. The numbers of a law are rows, and not part of it.
"""

import hashlib
import threading
from pathlib import Path
from types import ModuleType
from typing import Any

from laticauda.actuation.laws import JointLaw
from laticauda.compiling import PROCESSOR, Target, compiling_for, templates
from laticauda.compiling.formulas import digest_of
from laticauda.compiling.sources import is_kept, sources_digest
from laticauda.fluid.laws import DragLaw, PolynomialDrag

# What each template is made for; it may use those before it that are made for no more.
TEMPLATES = {"loads": ("law",), "recursion": ("law",), "drives": ("joints",), "stepping": ("law", "joints")}
_one_at_a_time = threading.Lock()
_loaded: dict[tuple[str, str, Target], ModuleType] = {}


def specialize(
    width: int = 1, law: DragLaw | None = None, joints: JointLaw | None = None, target: Target | None = None
) -> ModuleType:
    """The stepping kernels for `width` lanes, one drag law and one joint law.

    Args:
        width: Number of trials that run side by side in one set of vector registers.
        law: Whose formula is compiled; what it calls counts as part of it, its numbers do not. None: the polynomial.
        joints: Whose formula is compiled beside the built-in ones, if it is none of them.
        target: What to compile for; None for this machine's processor.

    Returns:
        The module `laticauda.planar.stepping`, compiled for them on first call.
    """
    formula, target = (law or PolynomialDrag()).formula, target or PROCESSOR
    own = None if joints is None else joints.own
    digests = {"law": digest_of(formula), "joints": own and digest_of(own)}
    names: dict[str, Any] = {"WIDTH": width, "law": formula, "joint_law": own}
    with _one_at_a_time, compiling_for(target):
        sources = sources_digest(__name__, *(f"laticauda.planar.{template}" for template in TEMPLATES))
        for template, made_for in TEMPLATES.items():
            other = "" if target is PROCESSOR else id(target)
            made_of = f"{width} {[digests[one] for one in made_for]} {sources} {other}"
            key = hashlib.sha256(made_of.encode()).hexdigest()[:16]
            module = _loaded.get((template, key, target))
            if module is None:
                module = templates.load(Path(__file__).parent / f"{template}.py", key, names)
                for name, value in target.instead.items():
                    if hasattr(module, name):
                        setattr(module, name, value)
                _loaded[template, key, target] = module
            names[template] = module
    return names["stepping"]


def is_compiled(width: int = 1, law: DragLaw | None = None, joints: JointLaw | None = None) -> bool:
    """Whether the machine code for this combination is at hand or on disk; if not, the first run takes seconds."""
    return is_kept(specialize(width, law, joints).run)
