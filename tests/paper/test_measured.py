import dataclasses
import math

import pytest

from laticauda import HeadingController, LineOfSight, PathFollowing, StraightLine, swim
from laticauda.control import PhaseOscillators
from laticauda.motion.gaits import Custom, Gait, envelope_of, lateral_undulation
from laticauda.paper import find_measured_trial, read_efficiency_trials, read_path_following_trials
from laticauda.robot import load_ground, load_parameters, load_robot
from laticauda.trials import measured_counterpart


def gait_deg(alpha, omega, delta, kind="lateral_undulation"):
    return Gait(
        envelope=envelope_of(kind),
        amplitude=math.radians(alpha),
        frequency=math.radians(omega),
        phase_shift=math.radians(delta),
    )


@pytest.mark.parametrize(
    ("gait", "has_fin", "speed", "power"),
    [
        (gait_deg(30, 130, 40), False, 0.1514, 106.63),
        (gait_deg(30, 110, 20), True, 0.2654, 173.58),
        (gait_deg(50, 110, 40, "eel_like"), False, 0.1291, 88.24),
        (gait_deg(30, 130, 40, "eel_like"), False, 0.1132, None),
    ],
)
def test_a_setting_of_the_paper_finds_what_was_measured(gait, has_fin, speed, power):
    measured = find_measured_trial(gait, has_fin)
    assert (measured.forward_velocity, measured.mean_power) == (speed, power)


def test_every_measured_trial_finds_itself():
    assert len(read_efficiency_trials()) == 20
    for trial in read_efficiency_trials():
        assert find_measured_trial(trial.gait, trial.has_fin) is trial


@pytest.mark.parametrize(
    "gait",
    [
        gait_deg(30, 110, 20),  # in the table, but not available without the fin
        gait_deg(30.001, 130, 40),
        gait_deg(30, 131, 40),
        gait_deg(30, 130, 40.1),
        dataclasses.replace(gait_deg(30, 130, 40), offset=0.1),
        dataclasses.replace(gait_deg(30, 130, 40), envelope=Custom(values=(1.0,) * 8)),
    ],
)
def test_another_setting_finds_nothing(gait):
    assert find_measured_trial(gait, has_fin=False) is None


def test_a_gait_rounded_to_seven_digits_is_still_the_papers():
    gait = lateral_undulation(amplitude=0.5235988, frequency=2.2689280, phase_shift=0.6981317)
    assert find_measured_trial(gait, has_fin=False).forward_velocity == 0.1514


def test_only_mamba_in_water_has_a_counterpart(make_trial):
    gait = gait_deg(30, 130, 40)
    assert measured_counterpart(make_trial(gait=gait)).forward_velocity == 0.1514
    assert (
        measured_counterpart(make_trial(gait=gait, robot=load_robot("mamba-fin"))).forward_velocity
        == 0.2226
    )
    assert (
        measured_counterpart(make_trial(gait=gait, robot=load_robot("mamba-modules"))).mean_power
        == 106.63
    )
    assert measured_counterpart(make_trial(gait=gait, robot=load_robot("mamba-thruster"))) is None
    assert measured_counterpart(make_trial(gait=gait, robot=load_robot("chain"))) is None
    assert measured_counterpart(make_trial(gait=gait, environment=load_ground("viscous"))) is None
    assert measured_counterpart(make_trial(gait=None)) is None


def test_a_robot_is_mamba_by_what_it_is_and_not_by_its_name(make_trial, tmp_path):
    gait = gait_deg(30, 130, 40)
    short = load_robot("mamba", n_links=5)
    assert (
        short.name == "mamba" and measured_counterpart(make_trial(gait=gait, robot=short)) is None
    )

    def described(text):
        path = tmp_path / "mine.toml"
        path.write_text(
            f'kind = "robot"\nextends = "mamba"\nname = "mamba-mine"\n{text}', encoding="utf-8"
        )
        return load_robot(path)

    assert (
        measured_counterpart(make_trial(gait=gait, robot=described(""))).forward_velocity == 0.1514
    )
    tuned = load_parameters("mamba-identified").robot(load_robot("mamba-fin"), gait.kind)
    assert measured_counterpart(make_trial(gait=gait, robot=tuned)).forward_velocity == 0.2226
    longer = "[[modules]]\ncount = 9\nlength = 0.2\nmass = 0.8\nsection = { half_height = 0.055, half_width = 0.05 }\n"
    for change in (longer, "[caudal_fin]\nlength = 0.3\n"):
        assert measured_counterpart(make_trial(gait=gait, robot=described(change))) is None
    fin = dataclasses.replace(load_robot("mamba-fin").caudal_fin, n_hinges=3, flexural_rigidity=0.2)
    bending = dataclasses.replace(load_robot("mamba-fin"), name="mamba", caudal_fin=fin)
    assert measured_counterpart(make_trial(gait=gait, robot=bending)) is None


def test_table_2_has_twelve_cases_of_path_following():
    trials = read_path_following_trials()
    assert len(trials) == 12
    case = next(t for t in trials if t.has_fin and t.gait.kind == "eel_like" and t.case == 3)
    assert case.initial_heading == pytest.approx(math.radians(49.51))
    assert (case.initial_cross_track_error, case.forward_velocity, case.mean_power) == (
        1.4722,
        0.1510,
        96.99,
    )
    assert case.gait.amplitude == pytest.approx(math.radians(40.0))


def test_table_1_has_twelve_stars_three_in_each_group():
    stars = [trial for trial in read_efficiency_trials() if trial.is_maximum]
    groups = [(trial.gait.kind, trial.has_fin) for trial in stars]
    assert len(stars) == 12 and {groups.count(group) for group in groups} == {3}


def test_the_table_is_found_by_whoever_asks_what_was_measured():
    from laticauda.trials import MeasuredTrials, all_measured

    assert "table1" in MeasuredTrials.names()
    (table,) = (one for one in all_measured() if type(one).__module__ == "laticauda.paper.measured")
    assert len(table.trials()) == 22


def test_a_steered_run_has_no_counterpart_as_all_were_measured_straight_ahead():
    gait = gait_deg(30, 130, 40)
    following = PathFollowing(
        gait=gait,
        path=StraightLine(),
        guidance=LineOfSight(look_ahead_distance=1.6),
        heading=HeadingController(gain=0.4, max_offset_deg=20),
    )
    severed = PhaseOscillators(gait=gait, cuts=tuple(range(7)))
    for motion in (following, severed):
        trial = swim("mamba", motion, 1.0, joints="servo")
        assert trial.gait == gait
        assert measured_counterpart(trial) is None
