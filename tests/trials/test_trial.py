import dataclasses
import pickle
import re

import numpy as np
import pytest

from laticauda.robot import load_ground, load_robot
from laticauda.trials import Trial


def test_arrays_are_read_only_and_not_the_ones_handed_in(make_trial):
    time = np.linspace(0.0, 30.0, 1501)
    trial = make_trial(time=time)
    assert trial.time is not time and time.flags.writeable
    for field in dataclasses.fields(Trial):
        value = getattr(trial, field.name)
        if isinstance(value, np.ndarray):
            assert not value.flags.writeable
            assert value.dtype == np.float64
    time[0] = -1.0
    assert trial.time[0] == 0.0


def test_a_view_that_its_maker_can_still_write_to_is_copied(make_trial):
    base = np.linspace(0.0, 30.0, 1501)
    view = base[:]
    view.flags.writeable = False
    trial = make_trial(time=view)
    base[0] = -1.0
    assert trial.time[0] == 0.0


def test_replacing_a_field_shares_the_other_arrays(make_trial):
    trial = make_trial()
    other = dataclasses.replace(trial, status="Renamed.")
    assert other.link_angle is trial.link_angle
    assert not other.equals(trial)


def test_lists_and_integers_become_arrays_of_floats(make_trial):
    trial = make_trial(duration=2.0, dt=1.0, time=[0, 1, 2])
    assert trial.time.dtype == np.float64


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("time", [0.0, 2.0, 1.0], "`time` must increase strictly, got 2.0 s and then 1.0 s."),
        ("time", [0.0, 1.0, 1.0], "`time` must increase strictly"),
        ("time", [], "`time` must have at least 1 sample, got 0."),
        ("time", 0.0, "`time` must have shape (any), got ()."),
        ("time", "soon", "`time` must be an array of numbers, got str"),
        ("time", [[0.0], [1.0, 2.0]], "`time` must be an array of numbers, got list"),
        ("time", [0.0, np.inf, 1.0], "`time` must hold finite numbers only, got inf at sample 1."),
        ("center_of_mass", np.zeros((3, 4)), "`center_of_mass` must have 2 or 3 columns, got 4."),
        ("center_of_mass_velocity", np.zeros((3, 3)), "must have shape (3, 2), got (3, 3)."),
        ("heading", np.zeros((3, 1)), "`heading` must have shape (3), got (3, 1)."),
        ("link_angle", np.zeros((3, 8)), "`link_angle` must have shape (3, 9), got (3, 8)."),
        ("joint_angle", np.zeros((2, 8)), "`joint_angle` must have shape (3, 8), got (2, 8)."),
        (
            "joint_torque",
            np.full((3, 8), np.nan),
            "`joint_torque` must hold finite numbers only, got",
        ),
        ("joint_rate", np.zeros((3, 8), dtype=complex), "`joint_rate` must be an array of numbers"),
        ("work", np.zeros((3, 2)), "`work` must have shape (3, 3)"),
        ("electrical_work", np.zeros(2), "`electrical_work` must have shape (3)"),
        (
            "link_force",
            {"drag": np.zeros((3, 9, 3))},
            "`link_force['drag']` must have shape (3, 9, 2)",
        ),
        ("link_force", {"a/b": np.zeros((3, 9, 2))}, "`link_force` must have names of letters"),
        (
            "notes",
            {"gains": object()},
            "`notes['gains']` must be a text, number or truth value, got",
        ),
        ("notes", {"gain": float("nan")}, "`notes['gain']` must not be nan."),
        ("notes", [1], "`notes` must be of class Mapping, got list."),
        ("gait", "eel", "`gait` must be of class Gait, got str."),
        (
            "environment",
            load_robot("mamba"),
            "`environment` must be of class Water or Ground, got Robot.",
        ),
        ("scenario", None, "`scenario` must be of class Scenario or Experiment, got NoneType."),
        ("succeeded", 1, "`succeeded` must be true or false, got 1."),
        ("status", None, "`status` must be a text, got None."),
        (
            "state",
            {"all": np.array(["text"])},
            "`state['all']` must be an array of numbers or truth values",
        ),
        (
            "state",
            {"a b": np.zeros(1)},
            "`state` must have names of letters, digits and underscores",
        ),
    ],
)
def test_what_does_not_fit_is_refused_by_name(make_trial, name, value, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        make_trial(duration=2.0, dt=1.0, **{name: value})


def test_a_planar_log_has_the_links_of_the_planar_robot_and_a_spatial_one_all_modules(make_trial):
    robot = load_robot("mamba-modules")
    assert make_trial(robot=robot).link_angle.shape[1] == 10
    spatial = make_trial(robot=robot, n_axes=3)
    assert spatial.link_angle.shape[1] == 19
    assert spatial.forward_velocity == pytest.approx(0.15)
    assert spatial.steady_velocity == pytest.approx(0.15)
    assert spatial.strouhal_number > 0.0


def test_numpy_scalars_in_the_notes_become_plain_numbers(make_trial):
    settings = make_trial(notes={"dt": np.float64(0.02), "n": np.int64(3)}).settings
    assert settings == {"dt": 0.02, "n": 3}
    assert type(settings["n"]) is int


def test_equal_means_every_bit(make_trial, full_trial):
    trial = make_trial(created="now")
    assert trial.equals(make_trial(created="now"))
    assert not trial.equals(make_trial(created="later"))
    assert not trial.equals(
        make_trial(created="now", joint_torque=trial.joint_torque * (1 + 1e-15))
    )
    assert not trial.equals(make_trial(created="now", heading=-0.0 * trial.heading))
    assert not trial.equals(make_trial(created="now", notes={"n": 1}))
    assert not make_trial(created="now", notes={"n": True}).equals(
        make_trial(created="now", notes={"n": 1})
    )
    assert not trial.equals("a trial")
    assert full_trial.equals(full_trial)


def test_a_trial_survives_the_way_to_another_process(full_trial):
    assert full_trial.feasibility  # and is kept from now on
    assert pickle.loads(pickle.dumps(full_trial)).equals(full_trial)


def test_mean_power_says_which_power_it_is(make_trial):
    mechanical = make_trial()
    assert (mechanical.mean_power_kind, mechanical.mean_power) == ("mechanical", pytest.approx(3.0))
    with pytest.raises(ValueError, match="The power of the motors is unknown: give --joints servo"):
        _ = mechanical.total_power
    electrical = make_trial(electrical_work=100.0 * mechanical.time)
    assert (electrical.mean_power_kind, electrical.mean_power) == (
        "electrical",
        pytest.approx(100.0),
    )
    assert electrical.mechanical_power == pytest.approx(3.0)
    assert electrical.total_power == pytest.approx(141.3)


def test_power_is_the_difference_of_the_counted_work_even_if_the_count_began_before(make_trial):
    trial = make_trial()
    later = make_trial(work=trial.work + 1000.0)
    powers = later.mechanical_power, later.net_power, later.positive_power
    assert powers == pytest.approx((3.0, 1.0, 2.0))


def test_on_ground_the_robots_own_weight_counts_and_nothing_is_towed(make_trial):
    ground = load_ground("viscous")
    trial = make_trial(environment=ground)
    assert trial.cost_of_transport == pytest.approx(
        3.0 / (trial.robot.mass * ground.gravity * 0.15)
    )
    with pytest.raises(ValueError, match="must be water for a towing drag"):
        _ = trial.quasi_propulsive_efficiency
    with pytest.raises(ValueError, match="must be water for a share of the linear drag"):
        _ = trial.linear_drag_share


def test_figures_in_a_current_are_those_of_the_speed_through_the_water(make_trial):
    still = make_trial()
    drifting = dataclasses.replace(
        still,
        center_of_mass=still.center_of_mass + still.time[:, np.newaxis] * np.array([0.3, -0.2]),
        center_of_mass_velocity=still.center_of_mass_velocity + np.array([0.3, -0.2]),
        scenario=dataclasses.replace(
            still.scenario, environment=dataclasses.replace(still.environment, current=(0.3, -0.2))
        ),
    )
    assert drifting.speed_through_water == pytest.approx(still.speed_through_water)
    assert drifting.quasi_propulsive_efficiency == pytest.approx(still.quasi_propulsive_efficiency)
    assert drifting.linear_drag_share == pytest.approx(still.linear_drag_share)
    assert drifting.forward_velocity == pytest.approx(np.hypot(0.45, -0.2))


def test_figures_over_cycles_need_a_gait_that_moves(make_trial):
    trial = make_trial(gait=None)
    assert trial.period is None
    assert trial.steady_velocity == pytest.approx(0.15)
    for figure in ("heading_cycle_mean", "sideslip", "turning_rate", "strouhal_number"):
        with pytest.raises(ValueError, match="must have a gait that moves"):
            getattr(trial, figure)
    standing = dataclasses.replace(make_trial().gait, frequency=0.0)
    assert make_trial(gait=standing).period is None


def test_a_trial_introduces_itself_on_one_line(make_trial):
    assert repr(make_trial()) == (
        "<Trial of mamba: lateral_undulation, 30 s in 1501 samples, 0.15 m/s; The run reached its end.>"
    )


def test_signals_have_one_number_per_sample(make_trial):
    assert make_trial(duration=1.0).signals == {}
    with pytest.raises(
        ValueError, match=r"`signals\['offset'\]` must have shape \(51\), got \(50,\)"
    ):
        make_trial(duration=1.0, signals={"offset": np.zeros(50)})
    with pytest.raises(
        ValueError, match="`signals` must have names of letters, digits and underscores as keys"
    ):
        make_trial(duration=1.0, signals={"an offset": np.zeros(51)})
    with pytest.raises(ValueError, match="must hold finite numbers only, got nan at sample 3"):
        make_trial(duration=1.0, signals={"offset": np.where(np.arange(51) == 3, np.nan, 0.0)})


def test_a_trial_says_what_nobody_measured_and_refuses_figures_of_it(make_trial):
    trial = make_trial(not_measured=["work", "heading"])
    assert trial.not_measured == ("heading", "work")  # in the order of the fields
    for figure, name in {
        "mechanical_power": "work",
        "turning_rate": "heading",
        "sideslip": "heading",
    }.items():
        with pytest.raises(
            ValueError, match=f"The trial must have a measured `{name}` for .*, and it has none"
        ):
            getattr(trial, figure)
    assert trial.forward_velocity == make_trial().forward_velocity
    assert not trial.equals(make_trial())


def test_where_the_robot_was_is_what_every_trial_has(make_trial):
    with pytest.raises(
        ValueError, match=r"`not_measured` must be one of `heading`, .*, got 'center_of_mass'"
    ):
        make_trial(not_measured=("center_of_mass",))
    with pytest.raises(ValueError, match=r"`not_measured` must be one of `heading`, .*, got 3"):
        make_trial(not_measured=3)
