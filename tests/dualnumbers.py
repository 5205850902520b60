"""Dual numbers in plain Python, and the kernels' own sources run with them: a second way to the same derivatives."""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from laticauda.models.dynamics import bounds, semi_implicit
from laticauda.models.dynamics.shared_laws import SHARED_LAWS
from laticauda.models.planar import number_types, rows, sample_format
from laticauda.motion.joints import laws as joint_laws
from laticauda.water.fluid import edges, flow, inertia, laws

PLANAR = Path(rows.__file__).parent


@dataclass(frozen=True, eq=False)
class Dual:
    """value + slope e, with e e = 0; `real` is the value, as for a complex step."""

    real: float
    slope: float = 0.0

    @property
    def imag(self):
        """The slope, as a complex step shows whether there is any."""
        return self.slope

    def __add__(self, other):
        other = dual(other)
        return Dual(self.real + other.real, self.slope + other.slope)

    def __sub__(self, other):
        return self + -dual(other)

    def __rsub__(self, other):
        return -self + other

    def __mul__(self, other):
        other = dual(other)
        return Dual(self.real * other.real, self.real * other.slope + self.slope * other.real)

    def __truediv__(self, other):
        other = dual(other)
        return Dual(
            self.real / other.real,
            (self.slope * other.real - self.real * other.slope) / other.real**2,
        )

    def __rtruediv__(self, other):
        return dual(other) / self

    def __neg__(self):
        return Dual(-self.real, -self.slope)

    def __pow__(self, exponent):
        return Dual(
            self.real**exponent,
            exponent * self.real ** (exponent - 1) * self.slope if self.real else 0.0,
        )

    __radd__, __rmul__ = __add__, __mul__

    def sin(self):
        return Dual(math.sin(self.real), math.cos(self.real) * self.slope)

    def cos(self):
        return Dual(math.cos(self.real), -math.sin(self.real) * self.slope)

    def tanh(self):
        return Dual(math.tanh(self.real), (1.0 - math.tanh(self.real) ** 2) * self.slope)


def dual(x):
    return x if isinstance(x, Dual) else Dual(float(x))


def _expm1(x):
    x = dual(x)
    return Dual(math.expm1(x.real), math.exp(x.real) * x.slope)


def _differs(x, number):
    return x.real != number or getattr(x, "slope", 0.0) != 0.0


def _by_numbers(formula, record, n_first):
    """A law's formula as a function of numbers."""
    last = n_first + len(record._fields)

    def call(*numbers):
        own = SimpleNamespace(**dict(zip(formula.fields, numbers[last:], strict=True)))
        return formula.function(own, *numbers[:n_first], record(*numbers[n_first:last]))

    return call


def _driven(code, motion, drive, numbers):
    """The built-in joint laws."""
    law = {joint_laws.PD_DRIVEN: joint_laws.PD(), joint_laws.SERVO_DRIVEN: joint_laws.Servo()}.get(
        code
    )
    return (0.0, 0.0, 0.0) if law is None else law(*motion, joint_laws.Drive(*drive))


def python_kernels(law=None):
    """The templates, not compiled."""
    same = lambda function: function  # noqa: E731
    namespace = {name: value for name, value in vars(rows).items() if name.isupper()}
    namespace |= {
        "np": np,
        "no_type_check": same,
        "kernel": same,
        "entry": same,
        "compile_scalar": same,
        "in_lanes": same,
        "any_lane": same,
        "differs": _differs,
        "first_lane": same,
        "uncounted": same,
        "keep_until_here": same,
        "where": lambda condition, a, b: a if condition else b,
        "magnitude": lambda x: -x if x.real < 0.0 else x,
        "sincos": lambda x: (dual(x).sin(), dual(x).cos()),
        "expm1": _expm1,
        "laws": __import__("laticauda.motion.joints.laws", fromlist=["laws"]),
        "in_rows": _by_numbers,
        "rows_from": lambda first, count: lambda S, b=0: tuple(S[b + first : b + first + count]),
        "actuator_of": lambda own: _driven,
        "compile_shared_laws": lambda: SimpleNamespace(
            **{law.__name__: law for law in SHARED_LAWS}
        ),
        "plate": laws.plate,
        "edges": edges,
        "flow": flow,
        "inertia": inertia,
        "summed": lambda kinds, count: None,
        "Element": laws.Element,
        "MOTION": laws.MOTION,
        "reference": __import__("laticauda.motion.gaits.reference", fromlist=["reference"]),
        "sample_format": sample_format,
        "number_types": number_types,
        "semi_implicit": semi_implicit,
        "OWN_DRIVEN": joint_laws.OWN_DRIVEN,
        "SERVO_DRIVEN": joint_laws.SERVO_DRIVEN,
        "LAST_LINEAR": joint_laws.LAST_LINEAR,
        "FARTHEST": bounds.FARTHEST,
        "STRONGEST": bounds.STRONGEST,
        **{name: value for name, value in vars(semi_implicit).items() if name.isupper()},
        "lane_types": SimpleNamespace(rows_of=lambda width: same),
    }
    names = {
        "n_lanes": 1,
        "joint_law": None,
        "flow_parts": (),
        "drag_law": (law or laws.PolynomialDrag()).formula,
    }
    for template in ("loads", "recursion", "drives", "prescribed", "driven", "stepping"):
        source = (PLANAR / f"{template}.py").read_text(encoding="utf-8")
        source = re.sub(r"^(from|import) [^\n(]*(\([^)]*\))?.*$", "", source, flags=re.MULTILINE)
        inside = {**namespace, "bindings": lambda name: names, "__name__": template}
        exec(compile(source, template, "exec"), inside)
        names[template] = SimpleNamespace(**inside)
    return names["stepping"]
