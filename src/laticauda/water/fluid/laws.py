"""Loads of the water (or the ground) on one rigid element: laws that own their numbers.

A law is a frozen value derived from `DragLaw`: its fields are its coefficients, its `__call__` the
formula. Python calls it directly, and the kernels compile it (`laticauda.values.formulas`). It is part of
the environment: `Water.drag`, `Ground.friction`. A user's law is a class like those here, in any
module, or a `FunctionDrag`.

All quantities are in the element's own axes: t along the element toward the head, n to its left.
Velocities are those of the element's middle relative to the water or the ground. The annotations
say float, but complex numbers work too (for complex-step derivatives with respect to any argument),
and so do lanes (for many trials computed at once). Conditions therefore use the real part only,
magnitudes use `magnitude`, choices `laticauda.values.scalars.where`, and transcendental functions come
from numpy. A law with an `if` works as well; in a batch it is then called trial by trial.
"""

from collections.abc import Callable
from typing import ClassVar, NamedTuple, TypeAlias

import numpy as np

from laticauda.values import Extensible, Law, OfFunction, magnitude, option, quantity, value_class

_AT_REST = 1e-30
"""Keeps the direction of a velocity defined at rest; far below any relevant speed [m^2/s^2]."""

Loads: TypeAlias = tuple[float, float, float]
"""f_t [N], f_n [N] and tau [N m]."""
MOTION = 4
"""Count of the arguments of a law before the element: v_t, v_n, across, rate."""


class Element(NamedTuple):
    """Coefficients of an element, given by its section and surroundings (`laticauda.robot.hydrodynamics`)."""

    c_t: float
    """Coefficient of drag along the element [N s^2/m^2]; on viscous ground [N s/m], on dry ground mu_t m g [N]."""
    c_n: float
    """Coefficient of drag across the element, in the same units."""
    lambda_2: float
    """Linear rotational drag per reference speed [N s^2]."""
    lambda_3: float
    """Quadratic rotational drag [N m s^2]."""


class DragLaw(Law, Extensible, group="drag_laws"):
    """Base class of laws for the loads on one element: a value whose fields are its coefficients.

    Example:
        >>> from laticauda.water.fluid.laws import DragLaw, PolynomialDrag
        >>> DragLaw.named("polynomial-drag") is PolynomialDrag
        True
    """

    of_weight: ClassVar[bool] = False
    """Whether the ground's coefficients are fractions of an element's weight."""

    def __call__(
        self, v_t: float, v_n: float, across: float, rate: float, element: Element
    ) -> Loads:
        """Return the loads on an element.

        In space it is called twice per element: with n to its left, then with n upward.

        Args:
            v_t: Velocity along the element [m/s].
            v_n: Velocity across it, to its left [m/s].
            across: Total speed across it, |v_n| in the plane, not negative [m/s].
            rate: Angular velocity theta' [rad/s].
            element: Coefficients of the element, not negative.

        Returns:
            f_t [N], f_n [N], tau about the element's middle [N m]. None of the three should ever
            add energy: f_t v_t <= 0, f_n v_n <= 0, tau theta' <= 0.
        """
        raise NotImplementedError

    def check(self) -> None:
        """Reject a law that the kernels cannot compile.

        Raises:
            ValueError: If the law cannot be compiled; the message gives the reason.
        """
        if self.formula.is_own:
            return
        from laticauda.compiling.formulas import check  # Numba is slow to import

        example = (0.3, -0.2, 0.2, 0.5, 1.0, 10.0, 0.1, 0.01)
        check(self.formula, self.numbers, Element, example, 3, "f_t [N], f_n [N] and tau [N m]")

    def steepest(self, speed: float) -> tuple[float, float]:
        """Return the largest drag per speed up to `speed`, along and across, of an element with coefficients 1 [1/s].

        Args:
            speed: Speed both along and across [m/s].
        """
        unit = Element(1.0, 1.0, 0.0, 0.0)
        along: list[float] = []
        across: list[float] = []
        for v in (1e-12, speed):
            f_t, f_n, _ = self(v, v, v, 0.0, unit)
            along.append(-f_t / v)
            across.append(-f_n / v)
        return max(along), max(across)


@value_class
class PolynomialDrag(DragLaw):
    """Linear plus quadratic drag: f = -c v (U_ref + |v|), tau = -(U_ref lambda_2 + lambda_3 |theta'|) theta'.

    The literature uses the same number for the linear and the quadratic part [1]; U_ref is the
    speed that this implies.

    Along the element, a third part may grow with the sideways speed of the element,

        f_t = -c_t v_t (U_ref + |v_t| + gamma |v_n|)

    because sideways motion keeps the boundary layer thin. This growth of friction is established
    (Bone in [2]; review [3]); proportionality to |v_n| is an assumption of this model, with one
    number to be identified: for a plate that moves along its normal into the flow, theory gives the
    square root of the normal velocity [4].

    References:
        [1] E. Kelasidi et al., IEEE Robot. Autom. Mag. 23(1), 2016, eq. (7), which implies U_ref = 1 m/s.
        [2] M. J. Lighthill, Large-amplitude elongated-body theory of fish locomotion, Proc. R. Soc. B 179, 1971.
        [3] F. E. Fish, G. V. Lauder, Passive and active flow control by swimming fishes and mammals, Annu. Rev. Fluid
            Mech. 38, 2006.
        [4] U. Ehrenstein, C. Eloy, Skin friction on a moving wall and its implications for swimming animals, J. Fluid
            Mech. 718, 2013.
    """

    reference_speed: float = quantity(
        "m/s", "U_ref, at which linear and quadratic drag are equal", ge=0.0, default=1.0
    )
    linear: bool = option(
        "Whether force and torque have a part that is linear in the speed", default=True
    )
    quadratic: bool = option(
        "Whether force and torque have a part that is quadratic in the speed", default=True
    )
    sway_friction: float = quantity(
        "", "gamma, growth of tangential drag with sideways speed", ge=0.0, default=0.0
    )

    def __call__(
        self, v_t: float, v_n: float, across: float, rate: float, element: Element
    ) -> Loads:
        """Return the loads; the directions are independent, except for the sway friction."""
        base = self.reference_speed * self.linear
        speed_t = base + self.quadratic * magnitude(v_t) + self.sway_friction * across
        speed_n = base + self.quadratic * magnitude(v_n)
        f_t = -element.c_t * v_t * speed_t
        f_n = -element.c_n * v_n * speed_n
        slope = base * element.lambda_2 + self.quadratic * element.lambda_3 * magnitude(rate)
        return f_t, f_n, -slope * rate

    @property
    def words(self) -> str:
        """Parts of the law, with the reference speed where it matters."""
        parts = self._describe_parts()
        if self.sway_friction:
            return f"{parts}, sway_friction {self.sway_friction:g}"
        return parts

    def _describe_parts(self) -> str:
        """Return which of the linear and the quadratic part there are."""
        if self.linear and self.quadratic:
            return f"linear and quadratic, equal at {self.reference_speed:g} m/s"
        if self.linear:
            return f"linear only, reference speed {self.reference_speed:g} m/s"
        if self.quadratic:
            return "quadratic only"
        return "none"


@value_class
class TotalSpeedDrag(DragLaw):
    """Quadratic drag in oblique flow: friction along the element from the total speed, and lift at small incidence.

        f_t = -c_t v_t sqrt(v_t^2 + gamma^2 across^2)
        f_n = -c_n v_n sqrt(across^2 + beta^2 v_t^2)
        tau = -lambda_3 |theta'| theta'

    There is no linear part and no reference speed. gamma = 1 is friction against the whole
    velocity, as on a rough surface; with gamma = 0 it depends on the speed along the element only.
    beta = 0 is the cross-flow principle, where motion along the element does not affect the drag
    across (mooring lines [1]); beta = 1 is the drag of Morison's equation as a vector, along the
    whole velocity [2], whose part across grows like a lift at small incidence, with the angle and
    not with its square. With both 0 it is `PolynomialDrag` without its linear part.

    References:
        [1] MoorDyn (github.com/FloatingArrayDesign/MoorDyn), source/Line.cpp, transverse and tangential drag of a line.
        [2] WEC-Sim, documentation for developers, Morison element: the moving body.
    """

    beta: float = quantity(
        "", "beta, share of the tangential speed in the normal drag", ge=0.0, le=1.0, default=0.5
    )
    gamma: float = quantity(
        "", "gamma, share of the normal speed in the tangential drag", ge=0.0, le=1.0, default=1.0
    )

    def __call__(
        self, v_t: float, v_n: float, across: float, rate: float, element: Element
    ) -> Loads:
        """Return the loads; each force opposes its own velocity, scaled by a speed that combines both."""
        along_2 = v_t * v_t
        across_2 = across * across
        speed_t = (along_2 + self.gamma * self.gamma * across_2 + _AT_REST) ** 0.5
        speed_n = (across_2 + self.beta * self.beta * along_2 + _AT_REST) ** 0.5
        f_t = -element.c_t * v_t * speed_t
        f_n = -element.c_n * v_n * speed_n
        return f_t, f_n, -element.lambda_3 * magnitude(rate) * rate


@value_class
class ViscousFriction(DragLaw):
    """Ground friction proportional to the speed: f = -c v, along and across independently."""

    called: ClassVar[str] = "viscous"

    def __call__(
        self, v_t: float, v_n: float, across: float, rate: float, element: Element
    ) -> Loads:
        """Return the loads, without a torque about the contact."""
        return -element.c_t * v_t, -element.c_n * v_n, 0.0 * rate


def dry(v: float, c: float, regularization_speed: float) -> float:
    """Return the dry friction -c v / sqrt(v^2 + eps^2) [N].

    Args:
        v: Velocity [m/s].
        c: Friction at speeds far above eps [N].
        regularization_speed: eps, positive [m/s].
    """
    return -c * v / (v * v + regularization_speed * regularization_speed) ** 0.5


@value_class
class CoulombFriction(DragLaw):
    """Dry anisotropic ground friction: f = -c v / sqrt(v^2 + eps^2), along and across independently.

    This is -c sgn(v) with the jump at v = 0 spread over a few eps, so |f| < c, with c = mu m g.
    There is no torque about the contact.
    """

    called: ClassVar[str] = "coulomb"
    of_weight: ClassVar[bool] = True

    regularization_speed: float = quantity(
        "m/s", "eps, below which dry friction fades out", gt=0.0, default=1e-3
    )

    def __call__(
        self, v_t: float, v_n: float, across: float, rate: float, element: Element
    ) -> Loads:
        """Return the loads, without a torque about the contact."""
        eps = self.regularization_speed
        return dry(v_t, element.c_t, eps), dry(v_n, element.c_n, eps), 0.0 * rate


@value_class
class FunctionDrag(OfFunction, DragLaw):
    """A plain function as a law, with the arguments of a law; the values it closes over are compiled into it.

    It has no numbers to sweep or identify and cannot be described in a file: write a class for
    that.
    """

    function: Callable[..., tuple[float, float, float]] = option(
        "f(v_t, v_n, across, rate, element)"
    )

    def __call__(
        self, v_t: float, v_n: float, across: float, rate: float, element: Element
    ) -> Loads:
        """Return the loads from the function."""
        return self.function(v_t, v_n, across, rate, element)


def plate(
    v_t: float,
    v_n: float,
    half_density_area: float,
    lift_slope: float,
    stall_angle: float,
    sharpness: float,
    parasitic_drag: float,
) -> tuple[float, float]:
    """Return lift and drag of a flat plate, including stall, in the plate's axes (chord, normal).

        C_L = (1 - s) a sin(alpha) cos(alpha) + s 2 sin(alpha) |sin(alpha)| cos(alpha)
        C_D = C_D0 + 2 |sin(alpha)|^3
        1 - s = 1 / ((1 + exp(-M (sin(alpha_0) - sin(alpha)))) (1 + exp(-M (sin(alpha_0) + sin(alpha)))))

    alpha is the angle of attack, a the lift slope, alpha_0 the stall angle, M the sharpness. The
    share s of separated flow and its blending of the lift follow Beard and McLain [1], eqs. (4.9)
    and (4.10). Three things differ, so that the law holds for all angles and needs no aspect ratio:

    - s depends on sin(alpha) where they have alpha, so that flow from behind counts as attached
      again. To lowest order this is their stall with M cos(alpha_0) for M.
    - The attached lift is a sin(alpha) cos(alpha) where they have C_L0 + a alpha: the same for
      small alpha (C_L0 = 0).
    - Their drag, (4.11), adds the induced drag C_L^2 / (pi e R), R the aspect ratio. Ours adds
      2 |sin(alpha)|^3, the drag that goes with the separated lift: their resultant is normal to
      the plate, and 2 rho S v^2 / 2 at 90 deg. Induced drag before stall is neglected: include its
      relevant part in `parasitic_drag`.

    Args:
        v_t: Velocity along the chord relative to the water [m/s].
        v_n: Velocity across the chord [m/s].
        half_density_area: rho S / 2 [kg/m].
        lift_slope: a, slope of the lift coefficient at small angles [1/rad].
        stall_angle: alpha_0, between 0 and pi/2, where the flow separates: s = 1/2 [rad].
        sharpness: M, sharpness of the stall [-]; below 4 / sin(alpha_0), s reduces the slope at
            alpha = 0 too.
        parasitic_drag: C_D0 [-].

    Returns:
        Force along the chord and across it [N]. It never adds energy: f . v = -rho S/2 |v|^3 C_D <=
        0.

    References:
        [1] R. W. Beard, T. W. McLain, Small Unmanned Aircraft: Theory and Practice, Princeton
        University Press, 2012, ch. 4; the equations as in published implementations of the book.
    """
    speed = (v_t * v_t + v_n * v_n + _AT_REST) ** 0.5
    sine = -v_n / speed  # alpha is positive when the flow comes from the right
    cosine = v_t / speed
    size = magnitude(sine)
    half = 0.5 * sharpness
    stall = np.sin(stall_angle)
    # A logistic function is (1 + tanh) / 2, which cannot overflow however sharp the stall.
    below = 1.0 + np.tanh(half * (stall - sine))
    above = 1.0 + np.tanh(half * (stall + sine))
    attached = 0.25 * below * above
    lift = (attached * lift_slope + (1.0 - attached) * 2.0 * size) * sine * cosine
    drag = parasitic_drag + 2.0 * size * size * size
    scale = half_density_area * speed
    # Drag acts against v, lift a quarter turn to the left of v.
    along = scale * (-drag * v_t - lift * v_n)
    across = scale * (-drag * v_n + lift * v_t)
    return along, across
