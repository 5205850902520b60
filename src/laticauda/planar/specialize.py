"""The kernels for a lane width, a drag law and a joint law, made of templates (see `laticauda.compiling.templates`)."""

from types import ModuleType

from laticauda.actuation.laws import JointLaw
from laticauda.compiling import Target
from laticauda.compiling.templates import specialized
from laticauda.fluid.laws import DragLaw, PolynomialDrag

TEMPLATES = {
    "loads": ("WIDTH", "law"),
    "recursion": ("WIDTH", "law"),
    "drives": ("WIDTH", "joint_law"),
    "stepping": ("WIDTH", "law", "joint_law"),
}


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
    own = None if joints is None else joints.own
    names = {"WIDTH": width, "law": (law or PolynomialDrag()).formula, "joint_law": own}
    return specialized("laticauda.planar", TEMPLATES, names, target)
