import dataclasses
import math

import pytest
from hypothesis import given
from robot.strategies import robots

from laticauda.robot import CaudalFin, Joint, Module, Robot, Section, Thruster, load_robot

SECTION = Section(half_height=0.055, half_width=0.05)
LINK = Module(length=0.18, mass=0.8, section=SECTION)


def robot(**changes):
    return Robot(
        **{"name": "test", "modules": (LINK, LINK, LINK), "joints": (Joint(), Joint()), **changes}
    )


def alternating(n_modules, **changes):
    axes = ["yaw", "pitch"] * n_modules
    return robot(
        modules=[Module(length=0.09, mass=0.77, section=SECTION)] * n_modules,
        joints=[Joint(axis=axis) for axis in axes[: n_modules - 1]],
        **changes,
    )


def positions(found: Robot):
    """Middle of each module from the tail end [m]."""
    start, middles = 0.0, []
    for module in found.modules:
        middles.append(start + module.half_length)
        start += module.length
    return middles


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": ""}, r"`name` must be a text on one line"),
        ({"name": 3}, r"`name` must be a text, got 3"),
        ({"name": "a\nb"}, r"`name` must be a text on one line"),
        ({"description": None}, r"`description` must be a text, got None"),
        ({"modules": ()}, r"`modules` must hold at least one Module, got none"),
        ({"modules": LINK}, r"`modules` must be a tuple of Module, got Module"),
        (
            {"modules": (LINK, SECTION, LINK)},
            r"`modules\[1\]` must be of class Module, got Section",
        ),
        (
            {"joints": (Joint(),)},
            r"`joints` must hold one Joint fewer than there are modules, 2 for 3 modules, got 1",
        ),
        ({"joints": (Joint(), "yaw")}, r"`joints\[1\]` must be of class Joint, got str"),
        ({"caudal_fin": True}, r"`caudal_fin` must be of class CaudalFin, got bool"),
        (
            {"thrusters": (Thruster(link=3, thrust=1.0),)},
            r"`thrusters\[0\]\.link` must be 0 \(tail\) to 2 \(head\), got 3",
        ),
        ({"tether": None}, r"`tether` must be of class Tether, got NoneType"),
        ({"electronics_power": -1.0}, r"`electronics_power` must be >= 0 W"),
    ],
)
def test_a_robot_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        robot(**changes)


def test_one_link_is_a_robot_too():
    assert robot(modules=[LINK], joints=[]).n_joints == 0


def test_lists_become_tuples():
    assert robot(modules=[LINK] * 3, joints=[Joint()] * 2) == robot()


def test_length_is_the_bodys_and_mass_includes_the_fin():
    finned = robot(caudal_fin=CaudalFin())
    assert finned.length == robot().length == pytest.approx(0.54)
    assert finned.mass - robot().mass == pytest.approx(CaudalFin().mass)
    assert finned.volume - robot().volume == pytest.approx(CaudalFin().volume)


def test_a_robot_without_pitch_joints_is_its_own_reduction():
    plain = robot()
    assert plain.planar() is plain


def test_two_equal_modules_merge_to_a_uniform_rod():
    merged = alternating(3).planar().modules[1]
    assert merged.length == pytest.approx(0.18)
    assert merged.center == pytest.approx(0.0, abs=1e-15)
    assert merged.moment_of_inertia == pytest.approx(1.54 * 0.18**2 / 12.0)


def test_a_heavy_head_moves_the_center_of_mass_of_its_link_forward():
    light = Module(length=0.1, mass=1.0, section=SECTION)
    heavy = Module(length=0.2, mass=3.0, section=SECTION)
    link = robot(modules=(light, heavy), joints=(Joint(axis="pitch"),)).planar().modules[0]
    # From the tail end: light at 0.05, heavy at 0.2, together at 0.1625; the middle of the link is
    # at 0.15.
    assert link.center == pytest.approx(0.0125)
    own = light.moment_of_inertia + heavy.moment_of_inertia
    assert link.moment_of_inertia == pytest.approx(own + 1.0 * 0.1125**2 + 3.0 * 0.0375**2)


def test_effectors_stay_where_they_are_on_the_body():
    body = alternating(
        5,
        thrusters=(
            Thruster(link=0, thrust=1.0, x=0.01),
            Thruster(link=3, thrust=2.0, x=0.01, y=0.02),
        ),
    )
    flat = body.planar()
    assert [(one.link, one.y) for one in flat.thrusters] == [(0, 0.0), (2, 0.02)]
    for before, after in zip(body.thrusters, flat.thrusters, strict=True):
        assert positions(flat)[after.link] + after.x == pytest.approx(
            positions(body)[before.link] + before.x
        )


def test_modules_of_different_section_do_not_merge():
    other = Module(length=0.18, mass=0.8, section=Section(half_height=0.1, half_width=0.1))
    mixed = robot(modules=(LINK, other, LINK), joints=(Joint(), Joint(axis="pitch")))
    with pytest.raises(
        ValueError,
        match=r"`modules\[2\]\.section` must equal that of `modules\[1\]`, because a pitch joint",
    ):
        mixed.planar()
    assert robot(modules=(LINK, other, LINK)).planar().n_links == 3


def test_modules_with_different_coefficients_do_not_merge():
    other = dataclasses.replace(LINK, normal_drag=1.0)
    mixed = robot(modules=(LINK, other), joints=(Joint(axis="pitch"),))
    with pytest.raises(
        ValueError, match=r"`modules\[1\]\.normal_drag` must equal that of `modules\[0\]`.*got 1\.0"
    ):
        mixed.planar()


@given(robots())
def test_the_reduction_keeps_length_mass_volume_power_and_the_first_two_moments(body):
    flat = body.planar()
    assert all(joint.axis == "yaw" for joint in flat.joints)
    assert flat.n_links == 1 + sum(joint.axis == "yaw" for joint in body.joints)
    for name in ("length", "mass", "volume", "idle_power"):
        assert getattr(flat, name) == pytest.approx(getattr(body, name), rel=1e-12)
    for moment in (first_moment, second_moment):
        assert moment(flat) == pytest.approx(moment(body), rel=1e-9)


def first_moment(body):
    return math.fsum(
        one.mass * (x + one.center) for one, x in zip(body.modules, positions(body), strict=True)
    )


def second_moment(body):
    return math.fsum(
        one.moment_of_inertia + one.mass * (x + one.center) ** 2
        for one, x in zip(body.modules, positions(body), strict=True)
    )


@given(robots())
def test_reducing_twice_changes_nothing_more(body):
    assert body.planar().planar() == body.planar()


def test_equal_links_can_be_had_in_any_number():
    mamba = load_robot("mamba")
    longer = mamba.with_links(10)
    assert (longer.n_links, longer.n_joints, longer.modules[0]) == (10, 9, mamba.modules[0])
    assert mamba.with_links(1).joints == ()
    assert mamba.with_links(9) is mamba


@pytest.mark.parametrize(
    ("name", "n_links", "message"),
    [
        ("mamba", 0, r"`n_links` must be a whole number >= 1, got 0"),
        ("mamba", 9.0, r"`n_links` must be a whole number >= 1, got 9\.0"),
        (
            "mamba-modules",
            9,
            r"`n_links` must stay 19 for robot `mamba-modules`, whose modules or joints are not all alike",
        ),
    ],
)
def test_a_number_of_links_is_refused(name, n_links, message):
    with pytest.raises(ValueError, match=message):
        load_robot(name).with_links(n_links)
