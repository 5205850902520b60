"""Samples check themselves once and never change; a mount says where on the planar robot the markers are."""

import math
from dataclasses import replace

import jaxtyping
import numpy as np
import pytest

import laticauda as lc
from laticauda.control.estimation import (
    Estimate,
    JointSample,
    KinematicEstimator,
    Mount,
    PoseSample,
    ReferenceSample,
    StateEstimator,
)
from laticauda.robot.kinematics import turn

ROBOT = lc.load_robot("mamba")


@pytest.fixture
def without_checks_of_shapes():
    """As users have it."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (
            lambda: PoseSample(time=0.0, position=np.zeros(2)),
            r"`position` must hold 3 numbers, got an array of shape",
        ),
        (
            lambda: PoseSample(time=0.0, position=np.zeros(3), rotation=np.zeros((3, 2))),
            r"`rotation` must hold 3 x 3 numbers, got an array of shape \(3, 2\)",
        ),
        (
            lambda: JointSample(time=math.nan, angle=np.zeros(3)),
            r"`time` must be a finite number in s, got nan",
        ),
        (
            lambda: JointSample(time=0.0, angle=np.zeros((2, 3))),
            r"`angle` must hold n numbers, got .* \(2, 3\)",
        ),
        (
            lambda: JointSample(time=0.0, angle=np.zeros(3), rate=np.zeros(2)),
            r"`rate` must hold 3 numbers, got",
        ),
        (
            lambda: JointSample(time=0.0, angle=np.zeros(3), torque=np.zeros(4)),
            r"`torque` must hold 3 numbers, got",
        ),
        (
            lambda: ReferenceSample(time=0.0, angle=np.zeros(())),
            r"`angle` must hold n numbers, got",
        ),
        (
            lambda: ReferenceSample(time=0.0, angle=np.zeros(3), frequency=-1.0),
            r"`frequency` must be >= 0 rad/s",
        ),
    ],
)
def test_a_sample_that_makes_no_sense_is_refused(make, says, without_checks_of_shapes):
    with pytest.raises(ValueError, match=says):
        make()


def test_a_sample_has_arrays_of_its_own_that_nobody_changes():
    angle = np.zeros(3)
    sample = JointSample(time=1, angle=angle)
    angle[0] = 9.0
    assert sample.angle.tolist() == [0.0, 0.0, 0.0] and isinstance(sample.time, float)
    assert sample.rate is None and sample.torque is None
    with pytest.raises(ValueError, match="read-only"):
        sample.angle[0] = 1.0
    assert ReferenceSample(time=0.0, angle=angle).frequency == 0.0


def test_a_body_is_lost_if_any_of_its_place_is_unknown():
    seen = PoseSample(time=0.0, position=np.zeros(3))
    assert not seen.is_lost and seen.residual == 0.0 and seen.rotation is None
    for axis in range(3):
        place = np.zeros(3)
        place[axis] = math.nan
        assert PoseSample(time=0.0, position=place).is_lost


def test_an_estimate_that_knows_nothing_of_its_errors_says_none():
    found = Estimate(
        time=0.0,
        status="lost",
        age=1.0,
        center_of_mass=np.zeros(2),
        center_of_mass_velocity=np.zeros(2),
        heading=0.0,
        heading_rate=0.0,
        link_angle=np.zeros(1),
        joint_angle=np.zeros(0),
        joint_rate=np.zeros(0),
    )
    assert (found.center_of_mass_std, found.heading_std, found.current, found.current_std) == (
        0.0,
        0.0,
        None,
        0.0,
    )


def test_the_markers_sit_on_the_tail_unless_it_is_said_where():
    assert Mount() == Mount(module=0, offset=(0.0, 0.0), angle=0.0)
    assert Mount().on_link(ROBOT) == (0, (0.0, 0.0))
    assert Mount(module=2, offset=(0.03, -0.02, 0.5)).on_link(ROBOT) == (2, (0.03, -0.02))
    built = lc.load_robot("mamba-modules")
    links = [Mount(module=k).on_link(built)[0] for k in range(len(built.modules))]
    assert links == sorted(links) and set(links) == set(range(built.planar().n_links))
    shifts = [
        Mount(module=k).on_link(built)[1][0] for k in range(len(built.modules)) if links[k] == 1
    ]
    assert len(shifts) == 2 and shifts[0] < 0.0 < shifts[1]  # two modules, one link
    with pytest.raises(ValueError, match=r"`module` must be < 9, the number of modules, got 9\."):
        Mount(module=9).on_link(ROBOT)
    with pytest.raises(ValueError, match=r"`module` must be a whole number >= 0, got -1"):
        Mount(module=-1)
    with pytest.raises(ValueError, match=r"`module` must be < 9, the number of modules, got 12\."):
        KinematicEstimator(robot=ROBOT, mount=Mount(module=12))


def test_the_angle_of_the_link_is_that_of_the_body_less_the_mounts():
    assert Mount(angle=0.3).link_yaw(turn("yaw", 0.8)) == pytest.approx(0.5)
    assert Mount(angle=-0.3).link_yaw(turn("yaw", -0.8)) == pytest.approx(-0.5)


def test_the_status_is_by_the_time_without_a_frame():
    base = StateEstimator(robot=ROBOT)
    assert (base.bridging_after, base.lost_after) == (0.05, 1.5)
    ages = (0.0, 0.05, 0.0501, 1.5, 1.501)
    assert [base.status_at(age) for age in ages] == [
        "tracking",
        "tracking",
        "bridging",
        "bridging",
        "lost",
    ]
    for name in ("bridging_after", "lost_after"):
        with pytest.raises(ValueError, match=rf"`{name}` must be > 0 s, got 0"):
            replace(base, **{name: 0.0})


def test_the_base_of_the_estimators_estimates_nothing_itself():
    base = StateEstimator(robot=ROBOT)
    for call in (
        base.init,
        lambda: base.step(None, PoseSample(time=0.0, position=np.zeros(3))),
        lambda: base.estimate(0),
    ):
        with pytest.raises(NotImplementedError):
            call()
