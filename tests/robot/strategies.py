"""Random robots, waters and grounds, for any test that states a law about them."""

import math

from hypothesis import strategies as st

from laticauda.robot import (
    Actuator,
    CaudalFin,
    DragArea,
    Ground,
    Joint,
    Module,
    PectoralFin,
    Robot,
    Section,
    Tether,
    Thruster,
    Water,
)
from laticauda.water.fluid.laws import CoulombFriction, PolynomialDrag, ViscousFriction


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False)


coefficients = st.none() | numbers(0.0, 3.0)
sections = st.builds(Section, half_height=numbers(0.01, 0.2), half_width=numbers(0.01, 0.2))
names = st.text(
    st.characters(codec="utf-8", categories=("L", "N", "P", "S")), min_size=1, max_size=12
)
prose = st.text(st.characters(codec="utf-8", exclude_characters="\r"), max_size=30)


@st.composite
def modules(draw: st.DrawFn, section: Section | None = None) -> Module:
    length = draw(numbers(0.02, 0.5))
    return Module(
        length=length,
        mass=draw(numbers(0.01, 5.0)),
        section=section or draw(sections),
        center=length * draw(numbers(-0.4, 0.4)),
        inertia=draw(st.none() | numbers(1e-6, 0.1)),
    )


actuators = st.builds(
    Actuator,
    proportional_gain=numbers(0.0, 100.0),
    derivative_gain=numbers(0.0, 20.0),
    stall_torque=numbers(0.1, 20.0),
    friction_torque=numbers(0.0, 1.0),
    idle_current=numbers(0.0, 1.0),
)
joints = st.builds(
    Joint,
    axis=st.sampled_from(["yaw", "pitch"]),
    limit=numbers(0.01, math.pi),
    actuator=st.just(Actuator()) | actuators,
    stiffness=numbers(0.0, 5.0),
    damping=numbers(0.0, 5.0),
)
fins = st.builds(
    CaudalFin,
    length=numbers(0.2, 1.0),
    opening_length=numbers(0.0, 0.19),
    opening=st.sampled_from(["open", "closed"]),
    n_strips=st.integers(1, 20),
    added_mass=coefficients,
    density=numbers(500.0, 3000.0),
    n_hinges=st.sampled_from([0, 0, 1, 3, 6]),
    flexural_rigidity=numbers(1e-3, 1e3),
    bending_damping=st.just(0.0) | numbers(0.0, 1.0),
    joint=st.none() | st.builds(Joint, limit=numbers(0.01, math.pi), stiffness=numbers(0.0, 5.0)),
)


@st.composite
def robots(draw: st.DrawFn, max_links: int = 8) -> Robot:
    """Robots whose modules may differ in all but the section, so that every one has a planar reduction."""
    n = draw(st.integers(1, max_links))
    section = draw(sections)
    overrides = {
        name: draw(coefficients)
        for name in ("tangential_friction", "normal_drag", "added_mass", "added_inertia")
    }
    pieces = [
        Module(
            length=one.length,
            mass=one.mass,
            section=section,
            center=one.center,
            inertia=one.inertia,
            **overrides,
        )
        for one in draw(st.lists(modules(section), min_size=n, max_size=n))
    ]
    repeated = draw(st.booleans())
    links = st.integers(0, n - 1)
    return Robot(
        name=draw(names),
        description=draw(prose),
        modules=pieces[:1] * n if repeated else pieces,
        joints=draw(st.lists(joints, min_size=n - 1, max_size=n - 1)),
        caudal_fin=draw(st.none() | fins),
        thrusters=draw(
            st.lists(
                st.builds(
                    Thruster, link=links, thrust=numbers(-50.0, 50.0), angle=numbers(-7.0, 7.0)
                ),
                max_size=2,
            )
        ),
        pectoral_fins=draw(
            st.lists(
                st.builds(
                    PectoralFin,
                    link=links,
                    x=numbers(-1.0, 1.0),
                    area=numbers(1e-4, 0.1),
                    lift_slope=numbers(0.0, 7.0),
                    stall_angle=numbers(0.01, 1.5),
                ),
                max_size=2,
            )
        ),
        drag_areas=draw(
            st.lists(
                st.builds(
                    DragArea,
                    link=links,
                    x=numbers(-1.0, 1.0),
                    along=numbers(0.0, 0.1),
                    across=numbers(0.0, 0.1),
                ),
                max_size=2,
            )
        ),
        tether=draw(
            st.builds(
                Tether, drag=numbers(0.0, 2.0), force=st.tuples(numbers(-1, 1), numbers(-1, 1))
            )
        ),
        electronics_power=draw(numbers(0.0, 100.0)),
    )


@st.composite
def waters(draw: st.DrawFn) -> Water:
    form = draw(st.sampled_from(["relative", "kirchhoff", "classic"]))
    return Water(
        name=draw(names),
        density=draw(numbers(1.0, 1100.0)),
        tangential_friction=draw(numbers(0.0, 1.0)),
        normal_drag=draw(numbers(0.0, 3.0)),
        added_mass=draw(numbers(0.0, 3.0)),
        drag=PolynomialDrag(
            linear=draw(st.booleans()),
            quadratic=draw(st.booleans()),
            reference_speed=draw(numbers(0.0, 3.0)),
            sway_friction=draw(numbers(0.0, 3.0)),
        ),
        friction_taper=draw(numbers(-1.0, 1.0)),
        added_mass_form=form,
        rotational=draw(st.sampled_from(["paper", "strip"])),
        trailing_edge=draw(st.sampled_from(["none", "elongated", "finite-span"]))
        if form == "kirchhoff"
        else "none",
        current=draw(st.tuples(numbers(-1.0, 1.0), numbers(-1.0, 1.0))),
        depth=draw(st.none() | numbers(0.01, 10.0)),
    )


grounds = st.builds(
    Ground,
    name=names,
    friction=st.one_of(
        st.just(ViscousFriction()),
        st.builds(CoulombFriction, regularization_speed=numbers(1e-4, 1.0)),
    ),
    tangential=numbers(0.0, 10.0),
    normal=numbers(0.0, 10.0),
)
