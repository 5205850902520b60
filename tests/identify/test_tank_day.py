"""A tank day, simulated: the verdict is right on water that sheds its momentum and on water that does not."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.identify import tank_day
from laticauda.identify.conversion import from_tow
from laticauda.identify.towing import Tow
from laticauda.motion.joints.speed_servo import SpeedServo
from laticauda.robot import load_parameters, textbook_water
from laticauda.robot.kinematics import Posture
from laticauda.trials.metrics import towing_drag
from laticauda.values.errors import TrialFileError
from laticauda.water.fluid.laws import TotalSpeedDrag

ROBOT = lc.load_robot("chain", n_links=6)
BOOK = textbook_water(ROBOT).water
SHEDS = replace(BOOK, tangential_friction=0.1, normal_drag=1.3, added_mass=1.05)
STAYS = replace(
    BOOK,
    tangential_friction=0.2,
    normal_drag=1.5,
    added_mass=1.3,
    drag=TotalSpeedDrag(beta=1.0),
    added_mass_form="relative",
    rotational="paper",
    trailing_edge="none",
)
ASKED = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=120, phase_shift_deg=50)
LIMIT = 1.1


def log(folder, name, trial, rng):
    place = Posture(ROBOT, trial.center_of_mass, trial.link_angle).link_centers[:, 0] + rng.normal(
        0, 0.0045, (trial.time.size, 2)
    )
    angles = np.column_stack((trial.link_angle[:, :1], trial.joint_angle))
    angles = np.degrees(angles + rng.normal(0, 0.005, angles.shape))
    with (folder / f"{name}.csv").open("a", newline="") as file:
        csv.writer(file).writerows(np.column_stack((trial.time, place, angles)).tolist())


def tow(folder, water, rng):
    with (folder / "tows.csv").open() as file:
        head, *rows = csv.reader(file)
    for row in rows:
        how = Tow(speed=float(row[0]), angle=math.radians(float(row[1]) + rng.normal(0.0, 0.5)))
        loads = how.loads(lc.build_scenario(ROBOT, ASKED, environment=water))
        row[2:] = [str(one + rng.normal(0.0, 0.03)) for one in loads.values()]
    with (folder / "tows.csv").open("w", newline="") as file:
        csv.writer(file).writerows([head, *rows])


def fill(folder, water):
    rng = np.random.default_rng(3)
    tank = {"environment": water, "sample_interval": 0.05}
    swim = lc.swim(ROBOT, ASKED, 10.0, joints=SpeedServo(speed_limit=LIMIT), **tank)
    log(folder, "swim", swim, rng)
    glide = lc.swim(
        ROBOT,
        replace(ASKED, amplitude=0.0),
        8.0,
        start=lc.Start(velocity=swim.forward_velocity),
        **tank,
    )
    log(folder, "glide", glide, rng)
    tow(folder, water, rng)


@pytest.fixture(scope="module", params=[SHEDS, STAYS], ids=["sheds", "stays"])
def judged(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("day")
    tank_day.prepare_folder(folder, ROBOT)
    text = (
        (folder / "swim.toml").read_text().replace("phase_shift_deg = 40", "phase_shift_deg = 50")
    )
    (folder / "swim.toml").write_text(text)
    fill(folder, request.param)
    day = tank_day.load_day(folder)
    return request.param, folder, day, tank_day.evaluate(day)


def test_the_law_is_told_and_its_numbers_are_near_the_truth(judged):
    truth, _, _, found = judged
    law, best = next(iter(found.fits.items()))
    assert law == ("kirchhoff" if truth is SHEDS else "relative")
    assert all(odds > tank_day.DECISIVE for name, odds in found.odds.items() if name != law)
    assert found.verdict[0].startswith(f"The law is `{law}`")
    assert best["water.tangential_friction"].value == pytest.approx(
        truth.tangential_friction, rel=0.06
    )
    assert best["water.normal_drag"].value == pytest.approx(truth.normal_drag, rel=0.12)
    assert best["water.added_mass"].value == pytest.approx(truth.added_mass, rel=0.12)
    assert best["water.drag.beta"].value == pytest.approx(truth.drag.beta, abs=0.15)
    low, high = found.joints["joints.speed_limit"].interval
    assert low * 0.97 < LIMIT < high * 1.03


def test_the_drag_area_is_that_of_the_straight_robot(judged):
    truth, _, day, found = judged
    (row,) = (row for row in found.numbers if row["name"].startswith("drag area at"))
    speed = day.trials["swim"].forward_velocity
    assert row["value"] == pytest.approx(
        2.0 * towing_drag(ROBOT, truth, speed) / (1000.0 * speed**2), rel=0.06
    )
    assert row["low"] < row["value"] < row["high"]
    assert "joints.speed_limit" in tank_day.format_evaluation(found)


def test_what_was_not_done_is_said(judged):
    *_, found = judged
    assert "Without turn.csv the data tell less: RUNS.md explains what it is for." in found.verdict
    assert not any("glide.csv" in sentence for sentence in found.verdict)


def test_another_lab_reads_the_result(judged):
    _, folder, day, found = judged
    files = tank_day.write_result(folder, day, found)
    place = folder / "result"
    assert {
        "swim.nc",
        "glide.nc",
        "robot.toml",
        "tows.csv",
        "parameters.toml",
        "summary.json",
        "summary.md",
    } <= {*files}
    trial = lc.load_trial(place / "swim.nc")
    np.testing.assert_allclose(trial.center_of_mass, day.trials["swim"].center_of_mass)
    parameters = load_parameters(place / "parameters.toml")
    law, best = next(iter(found.fits.items()))
    assert parameters.water("lateral_undulation").normal_drag == pytest.approx(
        best["water.normal_drag"].value
    )
    assert parameters.joints.speed_limit == pytest.approx(found.joints["joints.speed_limit"].value)
    said = json.loads((place / "summary.json").read_text())
    assert next(iter(said["laws"])) == law
    assert said["verdict"] == [*found.verdict]
    assert lc.load_robot(place / "robot.toml").n_links == ROBOT.n_links


def test_a_number_that_no_trial_determines_leaves_the_odds_of_the_laws_finite():
    """Tows to the side do not show the friction along the body."""
    still = lc.build_scenario(ROBOT, replace(ASKED, amplitude=0.0), environment=SHEDS)
    sideways = [Tow(speed=speed, angle=0.5 * math.pi) for speed in (0.2, 0.4)]
    tows = tuple(
        from_tow(ROBOT, BOOK, each, {"side_force": each.loads(still)["side_force"]}, name=str(i))
        for i, each in enumerate(sideways)
    )
    day = tank_day.Day(robot=ROBOT, noise=tank_day.Noise(), trials={}, tows=tows)
    evaluation = tank_day.evaluate(day, threads=1)
    for law_fit in evaluation.fits.values():
        assert law_fit.estimates[0].interval is None
    assert all(math.isfinite(odds) for odds in evaluation.odds.values())
    assert all(odds >= 1.0 for odds in evaluation.odds.values())


def test_a_folder_is_begun_once_and_empty_tables_are_refused(tmp_path):
    new = tank_day.prepare_folder(tmp_path / "day", ROBOT)
    assert {
        "RUNS.md",
        "robot.toml",
        "swim.csv",
        "glide.csv",
        "turn.csv",
        "tows.csv",
        tank_day.DAY,
    } <= {*new}
    assert (
        (tmp_path / "day" / "swim.csv")
        .read_text()
        .splitlines()[0]
        .endswith("yaw_deg,joint_1_deg,joint_2_deg,joint_3_deg,joint_4_deg,joint_5_deg")
    )
    (tmp_path / "day" / "swim.toml").write_text("mine")
    assert tank_day.prepare_folder(tmp_path / "day", ROBOT) == []
    assert (tmp_path / "day" / "swim.toml").read_text() == "mine"
    with pytest.raises(TrialFileError, match=r"No file was filled in"):
        tank_day.evaluate(tank_day.load_day(tmp_path / "day"))
    (tmp_path / "day" / "tows.csv").write_text("speed_m_s,angle_deg,drag_n\n0.4,15,1.0\n")
    with pytest.raises(TrialFileError, match=r"tows.csv: row 1: column"):
        tank_day.load_day(tmp_path / "day")
    (tmp_path / "day" / "tows.csv").write_text(
        "speed_m_s,angle_deg,drag_n,side_force_n,yaw_moment_n_m\nfast,15,1.0,,\n"
    )
    with pytest.raises(
        TrialFileError, match=r"tows.csv: row 2: could not convert string to float: 'fast'"
    ):
        tank_day.load_day(tmp_path / "day")
