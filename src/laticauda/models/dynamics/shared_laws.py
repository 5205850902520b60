"""Scalar laws that the kernels of both models call, in one list."""

import functools
from types import ModuleType
from typing import Any

from laticauda.compiling import Target, compile_scalar, current_target
from laticauda.models.dynamics import semi_implicit
from laticauda.motion.gaits import reference
from laticauda.motion.joints import laws

SHARED_LAWS = (
    # the reference generator
    reference.advance_wave,
    reference.advance_time,
    reference.smooth_start,
    reference.wave_motion,
    reference.wave_reference,
    reference.between_knots,
    # the semi-implicit step
    semi_implicit.implicit_inertia,
    semi_implicit.count_parts,
    semi_implicit.length_of_part,
    # the work of the joints
    laws.joint_powers,
    laws.motor_power,
    laws.servo_power,
)


def compile_shared_laws() -> Any:
    """Return a module of all `SHARED_LAWS` under their own names, compiled for the current target."""
    return _compile_for(current_target())


@functools.cache
def _compile_for(target: Target) -> ModuleType:
    module = ModuleType("shared_laws")
    for law in SHARED_LAWS:
        setattr(module, law.__name__, compile_scalar(law))
    return module
