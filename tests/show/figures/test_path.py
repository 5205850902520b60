import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from show.figures.runs import RUNS, run

from laticauda.robot.kinematics import Posture
from laticauda.show.figures import new_figure, path_strip, posture as postures


@pytest.fixture
def ax() -> Axes:
    return new_figure(7.0, 2.0).add_subplot()


def test_the_path_is_drawn_at_equal_scales_in_meters(ax: Axes):
    trial = run("lateral")
    assert path_strip(trial, ax) is ax
    assert ax.get_aspect() == 1.0
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")
    path, start = ax.get_lines()
    np.testing.assert_array_equal(path.get_xydata(), trial.center_of_mass)
    np.testing.assert_array_equal(start.get_xydata(), trial.center_of_mass[:1])


@pytest.mark.parametrize("name", ["lateral", "fin", "eel with fin"])
def test_a_posture_has_the_robots_real_lengths(name: str):
    trial = run(name)
    robot = trial.chain
    for sample in (0, 100, -1):
        steps = np.diff(postures.outline(robot, trial, sample), axis=0)
        fin = robot.caudal_fin.length if robot.caudal_fin else 0.0
        lengths = [fin, *(module.length for module in robot.modules)]
        np.testing.assert_allclose(np.linalg.norm(steps, axis=1), lengths, atol=1e-12)


def test_a_body_has_its_real_width_and_its_head_in_front(ax: Axes):
    trial = run("lateral")
    robot = trial.chain
    postures.draw_posture(ax, robot, postures.outline(robot, trial, 0), 0.0)
    body, head, _ = (found for found in ax.collections if isinstance(found, PolyCollection))
    corners = np.vstack([path.vertices for path in body.get_paths() + head.get_paths()])
    np.testing.assert_allclose(np.ptp(corners, axis=0), (robot.length, 0.1), atol=1e-12)
    assert max(path.vertices[:, 0].max() for path in head.get_paths()) == corners[:, 0].max()


@pytest.mark.parametrize("name", RUNS)
def test_the_last_posture_is_always_drawn(name: str):
    trial = run(name)
    samples = postures.choose_instants(trial)
    assert samples[-1] == trial.time.size - 1
    assert samples == sorted(set(samples))


@pytest.mark.parametrize("name", ["lateral", "eel", "fin", "curve", "circle", "ground", "north"])
def test_postures_of_a_long_run_do_not_lie_on_each_other(name: str):
    trial = run(name)
    robot = trial.chain
    bodies = [postures.outline(robot, trial, sample) for sample in postures.choose_instants(trial)]
    assert len(bodies) >= 2
    for i, one in enumerate(bodies):
        for other in bodies[:i]:
            assert np.linalg.norm(one[:, np.newaxis] - other, axis=2).min() > 0.1


def test_postures_between_the_ends_are_drawn_at_times_that_are_easily_read():
    trial = run("lateral")
    _, *inner, _ = postures.choose_instants(trial)
    assert inner
    for sample in inner:
        assert 10.0 * trial.time[sample] == pytest.approx(round(10.0 * trial.time[sample]))


def test_older_postures_are_lighter(ax: Axes):
    trial = run("lateral")
    path_strip(trial, ax)
    bodies = [found for found in ax.collections if isinstance(found, PolyCollection)][::3]
    lightness = [float(np.mean(found.get_facecolor()[0][:3])) for found in bodies]
    assert len(lightness) == 3
    assert lightness == sorted(lightness, reverse=True)


def test_a_fin_ends_at_the_trailing_edge(ax: Axes):
    trial = run("fin")
    robot = trial.chain
    points = postures.outline(robot, trial, 200)
    expected = Posture(robot, trial.center_of_mass[200], trial.link_angle[200]).trailing_edge
    np.testing.assert_allclose(points[0], expected)
    postures.draw_posture(ax, robot, points, 0.0)
    fin = next(found for found in ax.collections if not isinstance(found, PolyCollection))
    opening, plate = (path.vertices for path in fin.get_paths())
    assert np.linalg.norm(opening[1] - opening[0]) == pytest.approx(0.12)
    assert np.linalg.norm(plate[1] - plate[0]) == pytest.approx(0.38)


def test_a_current_is_told_with_its_strength(ax: Axes):
    path_strip(run("current"), ax)
    assert "current 0.112 m/s" in [text.get_text() for text in ax.texts]
    (arrow,) = [text for text in ax.texts if text.arrow_patch is not None]
    (x0, y0), (x1, y1) = arrow.xyann, arrow.xy
    assert (y1 - y0) / (x1 - x0) == pytest.approx(0.1 / -0.05)
