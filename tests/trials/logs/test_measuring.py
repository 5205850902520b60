"""A known trial, written down as other people's programs write theirs, must come back as it was."""

import csv
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from laticauda.robot import Robot, load_robot
from laticauda.robot.kinematics import Posture
from laticauda.trials import Trial
from laticauda.trials.logs import load_trial
from laticauda.values.errors import TrialFileError

MAP = """
kind = "columns"
robot = "mamba-fin"

[gait]
kind = "lateral-undulation"
amplitude_deg = 30
frequency_deg_s = 144
phase_shift_deg = 40
"""
JOINTS = """
[joint_angle]
columns = "phi_{}"
unit = "deg"
"""
BODY = """
[time]
column = "t"

[body]
position = ["x", "y"]
length_unit = "mm"
yaw = "yaw"
angle_unit = "deg"
"""
ROBOT = load_robot("mamba-fin")


@pytest.fixture(scope="module")
def swum(make_trial: Callable[..., Trial]) -> Trial:
    """30 s at 0.15 m/s toward 0.4 rad, turning slowly."""
    return make_trial(robot=ROBOT, direction=0.4, turning_rate=0.02, dt=0.01)


def marker(trial: Trial, link: int = 0, offset: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Where a marker on a link is [m]."""
    posture, angle = (
        Posture(ROBOT, trial.center_of_mass, trial.link_angle),
        trial.link_angle[:, link],
    )
    middle = posture.link_centers[:, link]
    along, left = offset
    x = middle[:, 0] + along * np.cos(angle) - left * np.sin(angle)
    return np.stack((x, middle[:, 1] + along * np.sin(angle) + left * np.cos(angle)), axis=1)


def joints_deg(trial: Trial) -> dict[str, np.ndarray]:
    return {f"phi_{i}": np.degrees(one) for i, one in enumerate(trial.joint_angle.T)}


def tail_log(trial: Trial) -> dict[str, np.ndarray]:
    """What a motion capture system and the joints report, as most people's scripts write it."""
    place = 1e3 * marker(trial)
    yaw = (np.degrees(trial.link_angle[:, 0]) + 180.0) % 360.0 - 180.0
    return {"t": trial.time, "x": place[:, 0], "y": place[:, 1], "yaw": yaw, **joints_deg(trial)}


def write(path: Path, columns: dict[str, np.ndarray], separator: str = ",") -> Path:
    with path.open("w", newline="") as file:
        writer = csv.writer(file, delimiter=separator)
        writer.writerow(columns)
        writer.writerows(np.stack(list(columns.values()), axis=1).tolist())
    return path


def mapped(folder: Path, text: str) -> Path:
    path = folder / "map.toml"
    path.write_text(text, encoding="utf-8")
    return path


def assert_same(found: Trial, swum: Trial, places: float = 1e-9, rates: float = 2e-3) -> None:
    """The same run: places and angles to rounding, rates to what smoothing leaves of them."""
    for name in ("center_of_mass", "heading", "link_angle", "joint_angle"):
        assert getattr(found, name) == pytest.approx(getattr(swum, name), abs=places), name
    assert found.forward_velocity == pytest.approx(swum.forward_velocity, abs=places)
    assert found.heading_rate == pytest.approx(swum.heading_rate, abs=20 * rates)
    assert found.center_of_mass_velocity == pytest.approx(
        swum.center_of_mass_velocity, abs=20 * rates
    )
    assert found.turning_rate == pytest.approx(swum.turning_rate, abs=rates)


# ---- where the robot was -------------------------------------------------------------------------


def test_a_marker_on_the_tail_and_the_joint_angles_give_the_whole_trial(swum, tmp_path):
    found = load_trial(
        write(tmp_path / "log.csv", tail_log(swum)), mapped(tmp_path, MAP + BODY + JOINTS)
    )
    assert_same(found, swum)
    assert found.gait == swum.gait or found.gait.frequency == pytest.approx(swum.gait.frequency)
    assert found.status == "Measured, without gaps."
    assert found.settings["source"] == "log.csv"
    assert found.environment.name == "paper-lateral"


def test_what_was_not_measured_has_no_figures_and_says_so(swum, tmp_path):
    found = load_trial(
        write(tmp_path / "log.csv", tail_log(swum)), mapped(tmp_path, MAP + BODY + JOINTS)
    )
    assert found.not_measured == ("joint_angle_ref", "joint_torque", "work")
    with pytest.raises(
        ValueError, match="must have a measured `work` for a mechanical power, and it has none"
    ):
        _ = found.mechanical_power
    summary = found.summary()
    assert summary["mechanical_power"] is None
    assert summary["mean_power"] is None
    assert summary["cost_of_transport"] is None
    assert summary["forward_velocity"] is not None
    assert summary["strouhal_number"] is not None


@pytest.mark.parametrize("link", [0, 3, 8])
def test_the_marker_may_be_on_any_link_and_beside_its_middle(swum, tmp_path, link):
    offset = (0.03, -0.02)
    place = marker(swum, link, offset)
    # The rigid body of the motion capture is turned against the link by 25 deg.
    yaw = swum.link_angle[:, link] - math.radians(25.0)
    log = {"t": swum.time, "x": place[:, 0], "y": place[:, 1], "yaw": yaw, **joints_deg(swum)}
    text = f"""
    [time]
    column = "t"
    [body]
    position = ["x", "y"]
    yaw = "yaw"
    link = {link}
    offset = [0.03, -0.02]
    angle_offset_deg = 25.0
    """
    assert_same(
        load_trial(write(tmp_path / "log.csv", log), mapped(tmp_path, MAP + text + JOINTS)), swum
    )


@pytest.mark.parametrize("forward", ["x", "-x", "y", "-y", "z", "-z"])
@pytest.mark.parametrize("kind", ["quaternion", "rotation"])
def test_axes_of_the_tank_and_of_the_rigid_body_may_be_any(swum, tmp_path, forward, kind):
    """The file's y is up, its z points to our right; the body's forward axis is any of its own."""
    Rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    ours_in_file = np.array(
        [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
    )  # rows: our x, y, z
    place = marker(swum)
    in_file = np.hstack((place, np.zeros((len(place), 1)))) @ ours_in_file
    sign, axis = (-1.0 if forward[0] == "-" else 1.0), "xyz".index(forward[-1])
    ahead = np.stack(
        (np.cos(swum.link_angle[:, 0]), np.sin(swum.link_angle[:, 0]), np.zeros(len(place))), axis=1
    )
    matrix = np.empty((len(place), 3, 3))
    matrix[:, :, axis] = sign * ahead @ ours_in_file
    matrix[:, :, (axis + 1) % 3] = ours_in_file[2]  # up
    matrix[:, :, (axis + 2) % 3] = np.cross(matrix[:, :, axis], matrix[:, :, (axis + 1) % 3])
    log = {
        "t": swum.time,
        **{name: in_file[:, i] for i, name in enumerate(("X", "Y", "Z"))},
        **joints_deg(swum),
    }
    if kind == "rotation":
        log |= {f"R{i}": matrix[:, i % 3, i // 3] for i in range(9)}
        turn = [f"R{i}" for i in range(9)]
    else:
        x, y, z, w = Rotation.from_matrix(matrix).as_quat().T
        log |= {"qw": w, "qx": x, "qy": y, "qz": z}
        turn = ["qw", "qx", "qy", "qz"]
    text = f"""
    [time]
    column = "t"
    [frame]
    x = "x"
    y = "-z"
    [body]
    position = ["X", "Y", "Z"]
    {kind} = {json.dumps(turn)}
    forward = "{forward}"
    """
    assert_same(
        load_trial(write(tmp_path / "log.csv", log), mapped(tmp_path, MAP + text + JOINTS)), swum
    )


def test_the_origin_and_the_rotation_of_the_frame_move_the_path(swum, tmp_path):
    text = BODY + JOINTS + "[frame]\norigin = [0.5, -1.0]\nrotation_deg = 90\n"
    found = load_trial(write(tmp_path / "log.csv", tail_log(swum)), mapped(tmp_path, MAP + text))
    x, y = (swum.center_of_mass - np.array([0.5, -1.0])).T
    assert found.center_of_mass == pytest.approx(np.stack((-y, x), axis=1), abs=1e-9)
    assert found.heading == pytest.approx(swum.heading + 0.5 * math.pi, abs=1e-9)
    assert found.forward_velocity == pytest.approx(swum.forward_velocity)


def test_markers_on_all_ends_need_no_joint_angles(swum, tmp_path):
    ends = 1e3 * Posture(ROBOT, swum.center_of_mass, swum.link_angle).link_ends
    log = {"t": swum.time}
    for i in range(10):
        log |= {f"m{i} X": ends[:, i, 0], f"m{i} Y": ends[:, i, 1]}
    text = f"""
    [time]
    column = "t"
    [ends]
    markers = {json.dumps([f"m{i}" for i in range(10)])}
    length_unit = "mm"
    """
    assert_same(load_trial(write(tmp_path / "log.csv", log), mapped(tmp_path, MAP + text)), swum)


def test_a_place_alone_gives_speed_and_course_and_refuses_the_rest(swum, tmp_path):
    log = {"t": 1e3 * swum.time, "x": swum.center_of_mass[:, 0], "y": swum.center_of_mass[:, 1]}
    text = '[time]\ncolumn = "t"\nunit = "ms"\n[center_of_mass]\nposition = ["x", "y"]\n'
    found = load_trial(write(tmp_path / "log.csv", log), mapped(tmp_path, MAP + text))
    assert found.forward_velocity == pytest.approx(swum.forward_velocity, abs=1e-12)
    assert found.course == pytest.approx(swum.course, abs=1e-6)
    with pytest.raises(ValueError, match="measured `heading` for a turning rate"):
        _ = found.turning_rate
    with pytest.raises(ValueError, match="measured `heading` for a sideslip"):
        _ = found.sideslip
    with pytest.raises(ValueError, match="measured `link_angle` for a Strouhal number"):
        _ = found.strouhal_number


def test_a_heading_beside_the_place_gives_the_turning_rate(swum, tmp_path):
    log = {
        "t": swum.time,
        "x": swum.center_of_mass[:, 0],
        "y": swum.center_of_mass[:, 1],
        "h": swum.heading,
    }
    text = (
        '[time]\ncolumn = "t"\n[center_of_mass]\nposition = ["x", "y"]\n[heading]\ncolumn = "h"\n'
    )
    found = load_trial(write(tmp_path / "log.csv", log), mapped(tmp_path, MAP + text))
    assert found.turning_rate == pytest.approx(swum.turning_rate, abs=1e-5)
    assert "link_angle" in found.not_measured
    with_joints = load_trial(
        write(tmp_path / "log.csv", log | joints_deg(swum)), mapped(tmp_path, MAP + text + JOINTS)
    )
    assert with_joints.link_angle == pytest.approx(swum.link_angle, abs=1e-9)


# ---- joints and power ----------------------------------------------------------------------------


def test_joints_may_be_numbered_from_the_head_and_positive_to_the_right(swum, tmp_path):
    log = tail_log(swum)
    for i in range(8):
        del log[f"phi_{i}"]
    log |= {f"j{8 - i}": -one for i, one in enumerate(swum.joint_angle.T)}
    joints = '[joint_angle]\ncolumns = "j{}"\nfirst = 1\nhead_first = true\nsign = -1\n'
    found = load_trial(write(tmp_path / "log.csv", log), mapped(tmp_path, MAP + BODY + joints))
    assert_same(found, swum)


def test_torques_give_work_and_a_reference_is_kept(swum, tmp_path):
    log = tail_log(swum)
    log |= {f"u{i}": 1e3 * one for i, one in enumerate(swum.joint_torque.T)}
    log |= {f"r{i}": one for i, one in enumerate(swum.joint_angle_ref.T)}
    log |= {f"w{i}": one for i, one in enumerate(swum.joint_rate.T)}
    text = (
        '[joint_torque]\ncolumns = "u{}"\nunit = "N mm"\n'
        '[joint_rate]\ncolumns = "w{}"\n[joint_angle_ref]\ncolumns = "r{}"\n'
    )
    found = load_trial(
        write(tmp_path / "log.csv", log), mapped(tmp_path, MAP + BODY + JOINTS + text)
    )
    power = np.sum(np.abs(swum.joint_torque * swum.joint_rate), axis=1)
    assert found.not_measured == ()
    assert found.mechanical_power == pytest.approx(np.mean(power), rel=1e-3)
    assert found.net_power <= found.positive_power <= found.mechanical_power
    assert np.array_equal(found.joint_angle_ref, swum.joint_angle_ref)


def test_current_and_voltage_give_the_power_above_idle(swum, tmp_path):
    log = tail_log(swum) | {"I": np.full(swum.time.size, 1.18 + 2.0)}
    text = MAP + BODY + JOINTS + '[power]\ncurrent = "I"\nvoltage = 35.0\n'
    found = load_trial(write(tmp_path / "log.csv", log), mapped(tmp_path, text + "idle = 41.3\n"))
    assert found.electrical_power == pytest.approx(70.0)  # (4): V (I - I_0)
    assert found.mean_power_kind == "electrical"
    by_robot = load_trial(tmp_path / "log.csv", mapped(tmp_path, text))
    assert by_robot.total_power == pytest.approx(35.0 * 3.18)


def test_signals_and_a_part_of_the_log(swum, tmp_path):
    log = tail_log(swum) | {"p": np.arange(swum.time.size)}
    text = (
        MAP.replace("\n[gait]", "start = 5.0\nstop = 25.0\n[gait]")
        + BODY
        + JOINTS
        + '[signals]\ncount = "p"\n'
    )
    found = load_trial(write(tmp_path / "log.csv", log), mapped(tmp_path, text))
    assert (found.time[0], found.time[-1]) == pytest.approx((0.0, 20.0))
    assert found.signals["count"][0] == 500
    assert found.center_of_mass[0] == pytest.approx(swum.center_of_mass[500])


# ---- other kinds of files ------------------------------------------------------------------------


def test_semicolons_decimal_commas_comments_and_a_byte_order_mark_are_read(swum, tmp_path):
    path = write(tmp_path / "log.csv", tail_log(swum), ";")
    path.write_text("\ufeff# made by hand\n" + path.read_text().replace(".", ","), encoding="utf-8")
    text = MAP.replace("\n[gait]", 'decimal = ","\n[gait]') + BODY + JOINTS
    assert_same(load_trial(path, mapped(tmp_path, text)), swum)
    read = load_trial(path, mapped(tmp_path, MAP + BODY + JOINTS))
    assert_same(read, swum)
    assert read.settings["reading"] == (
        "3001 of 3001 rows, from 0 to 30 s; semicolons between columns; decimal commas"
    )
    with pytest.raises(TrialFileError, match=r"in row 3; is `decimal` a comma\?"):
        load_trial(path, mapped(tmp_path, text.replace('decimal = ","', 'decimal = "."')))


def test_a_parquet_file_and_a_mat_file_of_others(swum, tmp_path):
    pyarrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    savemat = pytest.importorskip("scipy.io").savemat
    log = tail_log(swum)
    parquet.write_table(
        pyarrow.table(log | {"words": ["a"] * swum.time.size}), tmp_path / "log.parquet"
    )
    assert_same(load_trial(tmp_path / "log.parquet", mapped(tmp_path, MAP + BODY + JOINTS)), swum)
    phi = np.stack([log.pop(f"phi_{i}") for i in range(8)], axis=1)
    savemat(tmp_path / "log.mat", log | {"phi": phi})
    assert_same(load_trial(tmp_path / "log.mat", mapped(tmp_path, MAP + BODY + JOINTS)), swum)


def test_a_csv_file_that_laticauda_wrote_is_taken_number_by_number(full_trial, tmp_path):
    from laticauda.robot import to_toml

    full_trial.save(tmp_path / "run.csv")
    (tmp_path / "odd.toml").write_text(to_toml(full_trial.robot), encoding="utf-8")
    found = load_trial(
        tmp_path / "run.csv", mapped(tmp_path, 'kind = "columns"\nrobot = "odd.toml"\n')
    )
    for name in (
        "time",
        "center_of_mass",
        "joint_torque",
        "work",
        "electrical_work",
        "heading_rate",
    ):
        assert np.array_equal(getattr(found, name), getattr(full_trial, name)), name
    assert set(found.signals) == set(full_trial.signals)
    assert found.not_measured == ()


def c3d(
    path: Path,
    points: dict[str, np.ndarray],
    unit: str,
    rate: float,
    analog: np.ndarray | None = None,
) -> None:
    """Markers by name [unit], and one analog channel I."""
    ezc3d = pytest.importorskip("ezc3d")
    file = ezc3d.c3d()
    data = np.ones((4, len(points), len(next(iter(points.values())))))
    for i, one in enumerate(points.values()):
        data[:3, i] = one.T
    file["parameters"]["POINT"]["RATE"]["value"] = [rate]
    file["parameters"]["POINT"]["LABELS"]["value"] = tuple(points)
    file["parameters"]["POINT"]["UNITS"]["value"] = (unit,)
    file["data"]["points"] = data
    if analog is not None:
        file["parameters"]["ANALOG"]["LABELS"]["value"] = ("I",)
        file["parameters"]["ANALOG"]["RATE"]["value"] = [rate * analog.size / data.shape[2]]
        file["data"]["analogs"] = analog[np.newaxis, np.newaxis]
    file.write(str(path))


def ends_in_space(trial: Trial) -> dict[str, np.ndarray]:
    ends = Posture(ROBOT, trial.center_of_mass, trial.link_angle).link_ends
    height = np.full((trial.time.size, 1), 0.3)
    return {f"m{i}": np.hstack((ends[:, i], height)) for i in range(10)}


ENDS = f"[ends]\nmarkers = {json.dumps([f'm{i}' for i in range(10)])}\n"


@pytest.mark.parametrize(("unit", "scale"), [("mm", 1e3), ("m", 1.0)])
def test_the_markers_of_a_c3d_file_in_its_own_unit(swum, tmp_path, unit, scale):
    path = tmp_path / "run.c3d"
    points = {name: scale * one for name, one in ends_in_space(swum).items()}
    current = np.repeat(2.0 + 0.1 * np.sin(swum.time), 10)
    c3d(path, points, unit, 100.0, current)
    text = MAP + ENDS + '[power]\ncurrent = "I"\nvoltage = 35\nidle = 0\n'
    found = load_trial(path, mapped(tmp_path, text))
    assert_same(found, swum, places=1e-5)  # the format has 32 bits per number
    assert found.electrical_power == pytest.approx(35.0 * np.mean(current), rel=1e-3)


def test_a_marker_that_was_lost_for_a_moment_is_filled_and_said(swum, tmp_path):
    path = tmp_path / "run.c3d"
    points = {name: 1e3 * one for name, one in ends_in_space(swum).items()}
    points["m4"][700:705] = np.nan
    c3d(path, points, "mm", 100.0)
    found = load_trial(path, mapped(tmp_path, MAP + ENDS))
    assert (
        found.status
        == "Measured; 5 of 3001 samples had gaps in m4 X, m4 Y, m4 Z, filled by straight lines."
    )
    assert found.settings["filled_samples"] == 5
    assert_same(found, swum, places=2e-3, rates=0.02)
    points["m4"][700:800] = np.nan
    c3d(path, points, "mm", 100.0)
    message = (
        r"run.c3d by .*map.toml: `m4 X` must have no gap longer than `longest_gap` = 0.1 s, got one of 1.01 s "
        "from 6.99 s to 8 s"
    )
    with pytest.raises(TrialFileError, match=message):
        load_trial(path, mapped(tmp_path, MAP + ENDS))


@pytest.mark.parametrize("share", [0.0, 0.002, 0.02, 0.5, 0.9])
def test_a_c3d_file_without_its_end_is_refused(swum, tmp_path, share):
    path = tmp_path / "run.c3d"
    c3d(path, ends_in_space(swum), "m", 100.0)
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(TrialFileError, match=r"Cannot load .*run.c3d"):
        load_trial(path, mapped(tmp_path, MAP + ENDS))


def qtm(trial: Trial, lost: Sequence[int] = ()) -> str:
    """The 6D export of a rigid body on the tail, beside one that is not ours."""
    place, angle = 1e3 * marker(trial), trial.link_angle[:, 0]
    part = "X\tY\tZ\tRoll\tPitch\tYaw\tResidual\t" + "\t".join(f"Rot[{i}]" for i in range(9))
    lines = [
        f"NO_OF_FRAMES\t{trial.time.size}",
        "NO_OF_CAMERAS\t8",
        "NO_OF_BODIES\t2",
        "FREQUENCY\t100",
        "NO_OF_ANALOG\t0",
        "ANALOG_FREQUENCY\t0",
        "DESCRIPTION\t--",
        "TIME_STAMP\t2026-11-21, 10:00:00.000\t22107.99179716",
        "DATA_INCLUDED\t6D",
        "BODY_NAMES\tboat\tMamba tail",
        f"Frame\tTime\tboat {part}\tMamba tail {part}\t",
    ]
    for k, time in enumerate(trial.time):
        c, s = math.cos(angle[k]), math.sin(angle[k])
        yaw = (math.degrees(angle[k]) + 180.0) % 360.0 - 180.0
        ours = [*place[k], -40.0, 0.0, 0.0, yaw, 0.8, c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0]
        if k in lost:
            ours = [0.0] * 16
        cells = [5.0, 6.0, 7.0, *[0.0] * 3, 1.0, 1.0, *[0.0] * 3, 1.0, *[0.0] * 3, 1.0, *ours]
        lines.append(f"{k + 1}\t{time:.5f}\t" + "\t".join(f"{cell:.7f}" for cell in cells) + "\t")
    return "\r\n".join(lines) + "\r\n"


@pytest.fixture(scope="module")
def still_tail(make_trial: Callable[..., Trial]) -> Trial:
    """A robot whose joints stay straight: a rigid body on the tail says everything."""
    return make_trial(robot=ROBOT, direction=0.4, turning_rate=0.02, dt=0.01, ripple=0.0)


def test_a_rigid_body_of_qtm_is_found_by_its_name(still_tail, tmp_path):
    path = tmp_path / "run_6D.tsv"
    path.write_text(qtm(still_tail, lost=[1000, 1001]))
    # Joint angles come from a column of the same file here: the roll of the other body, which is 0.
    joints = f"[joint_angle]\ncolumns = {json.dumps(['boat Roll'] * 8)}\n"
    found = load_trial(path, mapped(tmp_path, MAP + '[body]\nname = "Mamba tail"\n' + joints))
    assert_same(found, still_tail, places=1e-6)
    assert found.settings["filled_samples"] == 2


def test_trajectories_of_qtm_with_and_without_the_row_of_names(swum, tmp_path):
    points = {name: 1e3 * one for name, one in ends_in_space(swum).items()}
    head = [
        f"NO_OF_FRAMES\t{swum.time.size}",
        "NO_OF_MARKERS\t10",
        "FREQUENCY\t100",
        "DATA_INCLUDED\t3D",
    ]
    head += [
        "MARKER_NAMES\t" + "\t".join(points),
        "TRAJECTORY_TYPES\t" + "\t".join(["Measured"] * 10),
    ]
    names = "\t".join(f"{name} {axis}" for name in points for axis in "XYZ")
    rows = [
        "\t".join(f"{cell:.4f}" for one in points.values() for cell in one[k])
        for k in range(swum.time.size)
    ]
    numbered = [f"{k + 1}\t{0.01 * k:.5f}\t{row}" for k, row in enumerate(rows)]
    for lines in (
        [*head, *rows],
        [*head, names, *rows],
        [*head, f"Frame\tTime\t{names}\t", *numbered],
    ):
        path = tmp_path / "run.tsv"
        path.write_text("\n".join(lines) + "\n")
        assert_same(load_trial(path, mapped(tmp_path, MAP + ENDS)), swum, places=1e-5, rates=5e-3)
    path.write_text("\n".join([*head, *rows[:-10]]) + "\n")
    with pytest.raises(
        TrialFileError, match=r"NO_OF_FRAMES says 3001, but there are 2991 rows: is it cut off\?"
    ):
        load_trial(path, mapped(tmp_path, MAP + ENDS))
    path.write_text("\n".join([*head, *rows])[:-40] + "\n")
    with pytest.raises(TrialFileError, match=r"row 3007 must have 30 cells"):
        load_trial(path, mapped(tmp_path, MAP + ENDS))
    path.write_text("\n".join([*head, *rows]).replace("FREQUENCY\t100", "FREQUENCY\t0") + "\n")
    with pytest.raises(TrialFileError, match=r"`time.rate`: the file states a rate of 0 Hz"):
        load_trial(path, mapped(tmp_path, MAP + ENDS))


# ---- what is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda log: log | {"t": log["t"][::-1]},
            r"`t` must increase strictly, got 30.0 s and then 29.99",
        ),
        (
            lambda log: log | {"t": 1e3 * log["t"]},
            r"`t` must have steps of at most 1 s, got 10 s; is its unit ms\?",
        ),
        (
            lambda log: log | {"x": 1e3 * log["x"]},
            r"must swim at most 5 lengths per second, .*; is `length_unit` mm\?",
        ),
        (
            lambda log: log | {"phi_3": 60.0 * log["phi_3"]},
            r"`joint_angle` must be between -180 and 180 deg, got",
        ),
        (
            lambda log: {k: v for k, v in log.items() if k != "yaw"},
            r"The file has no column `yaw`.*; it has t, x, y",
        ),
        (lambda log: {k: v[:1] for k, v in log.items()}, r"`t` must have at least 2 samples"),
        (
            lambda log: {k: np.delete(v, range(500, 700)) for k, v in log.items()},
            r"`t` must have no gap longer than `longest_gap` = 0.1 s, got one of 2.01 s after 4.99 s",
        ),
    ],
)
def test_a_log_that_cannot_be_right_is_refused(swum, tmp_path, change, message):
    path = write(tmp_path / "log.csv", change(tail_log(swum)))
    with pytest.raises(TrialFileError, match=r"Cannot load .*log.csv by .*map.toml: .*" + message):
        load_trial(path, mapped(tmp_path, MAP + BODY + JOINTS))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"it is not a text file of columns, or it is empty"),
        ("t,x\n", r"it must have at least a row of names and a row of numbers"),
        ("1,2\n3,4\n", r"row 1 must have the names of the columns, got 1, 2"),
        ("t,x,t\n1,2,3\n", r"row 1 must name every column once, got `t` twice"),
        ("t,x\n1,2\n2\n", r"row 3 must have 2 cells, as row 1 has, got 1"),
        ("t,x,y,yaw\n0,0,0,0\n1,oops,0,0\n", r"Column `x` must hold numbers, got 'oops' in row 3"),
        (
            "NO_OF_FRAMES\t1\nDATA_INCLUDED\tanalog\n",
            r"DATA_INCLUDED must be 3D or 6D, got 'analog'",
        ),
    ],
)
def test_a_table_that_makes_no_sense_is_refused(tmp_path, text, message):
    (tmp_path / "log.csv").write_text(text)
    with pytest.raises(TrialFileError, match=r"Cannot load .*log.csv by .*map.toml: " + message):
        load_trial(
            tmp_path / "log.csv", mapped(tmp_path, MAP.replace("longest", "") + BODY + JOINTS)
        )


def test_a_file_that_is_not_there_is_said(tmp_path):
    for ending in ("csv", "c3d", "parquet", "mat"):
        with pytest.raises(
            TrialFileError, match=rf"Cannot read .*none.{ending} by .*map.toml: no such file"
        ):
            load_trial(tmp_path / f"none.{ending}", mapped(tmp_path, MAP + BODY + JOINTS))


def test_a_measured_trial_is_stored_and_loaded_equal(swum, tmp_path):
    found = load_trial(
        write(tmp_path / "log.csv", tail_log(swum)), mapped(tmp_path, MAP + BODY + JOINTS)
    )
    found.save(tmp_path / "run.nc")
    assert load_trial(tmp_path / "run.nc").equals(found)


def test_a_robot_with_pitch_joints_is_followed_as_its_planar_chain(make_trial, tmp_path):
    robot: Robot = load_robot("mamba-modules")
    trial = make_trial(robot=robot, duration=5.0)
    log = {
        "t": trial.time,
        "x": trial.center_of_mass[:, 0],
        "y": trial.center_of_mass[:, 1],
        "h": trial.heading,
    }
    log |= {f"phi_{i}": np.degrees(one) for i, one in enumerate(trial.joint_angle.T)}
    text = (
        '[time]\ncolumn = "t"\n[center_of_mass]\nposition = ["x", "y"]\n[heading]\ncolumn = "h"\n'
        + JOINTS
    )
    found = load_trial(
        write(tmp_path / "log.csv", log), mapped(tmp_path, MAP.replace("-fin", "-modules") + text)
    )
    assert found.link_angle == pytest.approx(trial.link_angle, abs=1e-9)


@pytest.mark.parametrize(
    ("header", "names", "message"),
    [
        ("t,x [ft],y [ft]", ("x", "y"), r"Column `x` must be in m, cm, mm, in, but the file says 'ft'"),
        ("t,x [deg],y [deg]", ("x [deg]", "y [deg]"), r"must be in m, cm, mm, in, but the file says 'deg'"),
        ("t,x [smoot],y [smoot]", ("x [smoot]", "y [smoot]"), r"but the file says 'smoot'"),
        ("t [min],x,y", ("x", "y"), r"`t` must be in s, ms, us, ns, but the file says min"),
    ],
)  # fmt: skip
def test_a_unit_in_brackets_that_is_none_of_a_column_is_refused(tmp_path, header, names, message):
    rows = [f"{0.05 * i},{0.01 * i},0" for i in range(20)]
    (tmp_path / "log.csv").write_text("\n".join([header, *rows]))
    names = json.dumps(names)
    text = f'kind = "columns"\nrobot = "mamba"\n[time]\ncolumn = "t"\n[center_of_mass]\nposition = {names}\n'
    (tmp_path / "map.toml").write_text(text)
    with pytest.raises(TrialFileError, match=message):
        load_trial(tmp_path / "log.csv", tmp_path / "map.toml")
