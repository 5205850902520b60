"""Joint angles over time as a motion: the spline, the file, and what swims by it."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.interpolate import CubicSpline

import laticauda as lc
from laticauda.cli import main
from laticauda.cli.report import describe_trial
from laticauda.identify import Measurement, fit
from laticauda.models.simulate import compute_sensitivities
from laticauda.motion.gaits import Generator
from laticauda.motion.gaits.reference import between_knots
from laticauda.show.figures import swim_sheet
from laticauda.show.pictures.description import describe_run
from laticauda.values.errors import TrialFileError

ANGLES = lc.JointAngles(
    time=(0.0, 0.3, 0.55, 1.0, 1.4, 2.0),
    angle=((0.0, 0.3, 0.1, -0.3, 0.0, 0.2), (0.1, 0.0, -0.4, 0.2, 0.3, 0.0)),
)
MIRRORED = replace(ANGLES, angle=tuple(tuple(-one for one in joint) for joint in ANGLES.angle))
CHAIN = lc.load_robot("chain", n_links=3)
WATER = lc.load_water("paper-lateral")
WAVE = lc.eel_like(amplitude=0.5, frequency=3.0, phase_shift=0.9)


def swum(gait, robot=CHAIN, duration=2.5, **changes):
    return lc.swim(
        robot, gait, duration, environment=WATER, **{"dt": 0.01, "sample_interval": 0.1, **changes}
    )


@settings(max_examples=50)
@given(
    steps=st.lists(st.floats(0.01, 2.0), min_size=1, max_size=8),
    numbers=st.lists(st.floats(-3.0, 3.0), min_size=9, max_size=9),
)
def test_the_spline_passes_the_knots_at_rest_at_its_ends_and_with_continuous_accelerations(
    steps, numbers
):
    time = [0.5, *(0.5 + np.cumsum(steps)).tolist()]
    one = lc.JointAngles(time=tuple(time), angle=(tuple(numbers[: len(time)]),))
    knots = one.knots
    for k, t in enumerate(time):
        assert one.at(t)[0, 0] == pytest.approx(numbers[k], abs=1e-12)
    assert knots[0, 2] == knots[-1, 2] == 0.0
    for a, b, c in zip(knots, knots[1:], knots[2:], strict=False):
        near = 1e-9 * (b[0] - a[0])
        before = between_knots(b[0] - near, a[0], b[0], a[1], a[2], b[1], b[2])
        after = between_knots(b[0], b[0], c[0], b[1], b[2], c[1], c[2])
        assert after == pytest.approx(before, rel=1e-5, abs=1e-4 * max(1.0, abs(before[2])))


def test_the_rates_are_those_of_the_clamped_spline():
    spline = CubicSpline(ANGLES.time, np.array(ANGLES.angle).T, bc_type="clamped")
    for t in (0.1, 0.77, 1.9):
        found = ANGLES.at(t)
        np.testing.assert_allclose(
            found, [spline(t, order) for order in range(3)], rtol=1e-12, atol=1e-12
        )


@pytest.mark.parametrize("t", [-1.0, 0.0, 2.0, 7.0])
def test_before_and_after_the_record_the_ends_are_held(t):
    end = 0 if t <= 0.0 else -1
    assert ANGLES.at(t)[:2, 1] == pytest.approx((ANGLES.angle[1][end], 0.0), abs=1e-14)


@pytest.mark.parametrize("model", ["planar", "spatial"])
@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_both_models_and_the_generator_give_the_same_references(model, joints):
    gait = replace(WAVE, recorded=ANGLES)
    trial = swum(gait, model=model, joints=joints)
    generator = Generator(
        n_links=3, ramp=trial.scenario.model.ramp or (1.0 if joints == "prescribed" else 0.0)
    )
    state = generator.init(gait)
    for sample in range(trial.time.size):
        expected = generator.joints(state, gait)[0]
        np.testing.assert_allclose(trial.joint_angle_ref[sample], expected, atol=1e-12)
        state = generator.step(state, gait, 0.1)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_gait_that_was_recorded_swims_as_it_did(model):
    first = swum(WAVE, duration=4.0, sample_interval=0.02, model=model)
    again = swum(
        lc.recorded_gait(lc.JointAngles.of(first)), duration=4.0, sample_interval=0.02, model=model
    )
    np.testing.assert_allclose(again.joint_angle, first.joint_angle, atol=2e-4)  # it ends at rest
    np.testing.assert_allclose(again.center_of_mass[:-10], first.center_of_mass[:-10], atol=2e-5)


def test_mirrored_angles_swim_the_mirrored_way():
    left, right = swum(lc.recorded_gait(ANGLES)), swum(lc.recorded_gait(MIRRORED))
    np.testing.assert_allclose(left.center_of_mass, right.center_of_mass * (1.0, -1.0), atol=1e-14)


def test_a_joint_that_does_a_share_does_it_of_the_recording_too():
    joint = replace(CHAIN.joints[0], actuator=replace(CHAIN.joints[0].actuator, tracking=0.8))
    lazy = swum(lc.recorded_gait(ANGLES), robot=replace(CHAIN, joints=(joint, joint)))
    full = swum(lc.recorded_gait(ANGLES))
    np.testing.assert_allclose(lazy.joint_angle, 0.8 * full.joint_angle, atol=1e-14)
    np.testing.assert_allclose(lazy.joint_angle_ref, full.joint_angle_ref, atol=1e-14)


@pytest.mark.usefixtures("limit_case")  # one recording ends early
def test_a_batch_of_recordings_and_gaits_gives_what_single_runs_give():
    short = lc.JointAngles(time=(0.0, 1.0), angle=((0.0, 0.5), (0.0, -0.5)))
    gaits = [
        lc.recorded_gait(ANGLES),
        WAVE,
        lc.recorded_gait(MIRRORED),
        lc.recorded_gait(short),
        WAVE,
    ]
    many = lc.swim_many(CHAIN, gaits, 2.5, environments=WATER, dt=0.01)
    for i, gait in enumerate(gaits):
        np.testing.assert_allclose(
            many.center_of_mass[i], swum(gait).center_of_mass[-1], rtol=1e-9, atol=1e-12
        )


def test_derivatives_of_recordings_are_slopes():
    gaits, step = [lc.recorded_gait(ANGLES), WAVE], 1e-4
    found = compute_sensitivities(
        CHAIN, gaits, 2.5, names=["water.normal_drag"], environments=WATER, dt=0.01
    )
    up, down = (
        lc.swim_many(CHAIN, gaits, 2.5, environments=replace(WATER, normal_drag=1.75 + d), dt=0.01)
        for d in (step, -step)
    )
    slope = (up.forward_velocity - down.forward_velocity) / (2.0 * step)
    np.testing.assert_allclose(found.of("forward_velocity", "water.normal_drag"), slope, rtol=1e-6)


def test_it_is_stored_with_its_trials_and_runs_again_bit_for_bit(tmp_path):
    first = swum(lc.recorded_gait(ANGLES), joints="pd", dt=0.002)
    first.save(tmp_path / "run.nc")
    read = lc.load_trial(tmp_path / "run.nc")
    assert read.gait == first.gait
    assert np.array_equal(lc.swim(read.scenario).center_of_mass, first.center_of_mass)
    lc.save_scenario(first.scenario, tmp_path / "run.toml")
    assert lc.load_scenario(tmp_path / "run.toml") == first.scenario


def csv(path, text="time_s,joint_2_deg,noise,joint_1_deg\n0.0,0,9,5\n# a note\n0.5,30,9,0\n"):
    path.write_text(text, encoding="utf-8")
    return path


def test_a_scenario_file_names_a_table_or_holds_it(tmp_path):
    csv(tmp_path / "angles.csv")
    head = 'kind = "scenario"\nrobot = "chain"\nn_links = 3\n'
    (tmp_path / "by-name.toml").write_text(
        head + '[gait]\nrecorded = "angles.csv"\noffset_deg = 3\n'
    )
    inline = "[gait]\noffset_deg = 3\n[gait.recorded]\ntime = [0.0, 0.5]\nangle_deg = [[5, 0], [0, 30]]\n"
    (tmp_path / "inline.toml").write_text(head + inline)
    named, held = (lc.load_scenario(tmp_path / name) for name in ("by-name.toml", "inline.toml"))
    assert named == held
    assert named.gait == lc.recorded_gait(
        lc.JointAngles.read(tmp_path / "angles.csv"), offset=radians(3)
    )
    assert named.gait.recorded.angle[0] == (radians(5), 0.0)


def test_the_command_line_takes_a_table_or_a_trial(tmp_path, capsys):
    words = [
        "swim",
        "--robot",
        "chain",
        "--n-links",
        "3",
        "--duration",
        "1",
        "--dt",
        "0.02",
        "--json",
    ]
    csv(tmp_path / "angles.csv")
    run = tmp_path / "run.nc"
    assert main([*words, "--joint-angles", str(tmp_path / "angles.csv"), "--save", str(run)]) == 0
    first = lc.load_trial(run)
    assert first.joint_angle[-1] == pytest.approx([0.0, radians(30)])
    assert main([*words, "--joint-angles", str(run), "--save", str(tmp_path / "again.nc")]) == 0
    again = lc.load_trial(tmp_path / "again.nc")
    np.testing.assert_allclose(again.joint_angle, first.joint_angle, atol=1e-9)
    assert main([*words, "--joint-angles", str(tmp_path / "none.csv")]) == 2
    assert "no such file" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("time_s,joint_2_deg\n0,1\n1,2\n", "must have a column `time_s` and columns `joint_1_deg`"),
        ("joint_1_deg\n1\n2\n", "must have a column `time_s`"),
        (
            "time_s,joint_1_deg\n0,1\n0,2\n",
            "`time_s` must increase strictly, got 0.0 s and then 0.0 s in row 3",
        ),
        (
            "time_s,joint_1_deg\n0,1\n1,left\n",
            "`joint_1_deg` must hold numbers, got 'left' in row 3",
        ),
        ("time_s,joint_1_deg\n", "at least a row of names and a row of numbers"),
        ("time_s,joint_1_deg\n0,1\n", "`time_s` must have at least two times, got one"),
        ("time_s,joint_1_deg\n0,1\n1,nan\n", "a number in every row, but has none in row 3"),
        ("time_s,joint_1_deg\n0,1\n1,\n2,3\n3,\n", "but has none in row 3, row 5"),
    ],
)
def test_a_table_that_makes_no_sense_is_refused(tmp_path, text, match):
    with pytest.raises(TrialFileError, match=match):
        lc.JointAngles.read(csv(tmp_path / "angles.csv", text))


def test_another_number_of_joints_is_refused():
    with pytest.raises(ValueError, match="`recorded` must have angles of all 9 yaw joints, got 2"):
        swum(lc.recorded_gait(ANGLES), robot=lc.load_robot("chain"))
    with pytest.raises(ValueError, match=r"`angle\[0\]` must have one angle per time, 2, got 1"):
        lc.JointAngles(time=(0.0, 1.0), angle=((0.0,),))


def test_the_frequency_is_that_of_the_strongest_oscillation():
    t = np.linspace(0.0, 8.0, 160)
    waves = [0.5 * np.sin(8.0 * t + k) + 0.1 * np.sin(16.0 * t) + 0.2 for k in range(3)]
    assert lc.JointAngles(time=tuple(t), angle=tuple(map(tuple, waves))).frequency == pytest.approx(
        8.0, rel=2e-3
    )
    assert replace(ANGLES, angle=((0.3,) * 6,)).frequency == 0.0


def test_the_water_of_recorded_trials_is_identified():
    gaits = [lc.recorded_gait(ANGLES), lc.recorded_gait(MIRRORED, offset=0.1)]
    scenarios = [lc.build_scenario(CHAIN, gait, 2.5, environment=WATER, dt=0.01) for gait in gaits]
    speeds = lc.swim_many(scenarios).forward_velocity
    trials = [
        Measurement(name=f"{i}", scenario=one, figures={"forward_velocity": (speed, 1e-4)})
        for i, (one, speed) in enumerate(zip(scenarios, map(float, speeds), strict=True))
    ]
    guess = replace(WATER, normal_drag=1.2)
    guessed = [replace(one, scenario=replace(one.scenario, environment=guess)) for one in trials]
    found = fit(guessed, parameters=["water.normal_drag"], n_starts=1)
    assert found["water.normal_drag"].value == pytest.approx(WATER.normal_drag, rel=1e-5)


def test_it_is_called_what_it_is_wherever_a_gait_is_named():
    alone, both = swum(lc.recorded_gait(ANGLES)), swum(replace(WAVE, recorded=ANGLES))
    assert "gait    recorded motion: 2 joints, 0 to " in describe_trial(alone)
    assert "amplitude" not in describe_trial(alone).split("\n")[1]
    assert "recorded motion" in describe_trial(both) and "eel-like: amplitude" in describe_trial(
        both
    )
    titles = [swim_sheet(one).get_suptitle() for one in (alone, both)]
    assert titles[0] == "chain, recorded motion"
    assert titles[1].startswith("chain, recorded motion, ") and "°/s" in titles[1]
    assert describe_run(alone)[1] == "recorded motion" and "°/s" in describe_run(both)[1]
