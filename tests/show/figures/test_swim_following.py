import numpy as np
import pytest

import laticauda as lc
from laticauda.show.figures import follow_sheet, save_figure


def followed(duration=40.0, y=1.0, heading=0.0, path=None):
    controller = lc.PathFollowing(
        gait=lc.lateral_undulation(
            amplitude=np.deg2rad(30), frequency=np.deg2rad(90), phase_shift=np.deg2rad(40)
        ),
        path=path or lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=0.18),
        heading=lc.HeadingController(gain=0.4, max_offset=np.deg2rad(20)),
    )
    plant = lc.build_plant(lc.load_robot("mamba-fin"), lc.load_water("paper-lateral"))
    return lc.run(
        plant, controller, duration, start=lc.Start(center_of_mass=(0.0, y), heading=heading)
    )


def test_the_sheet_shows_way_error_and_heading_with_their_units(tmp_path):
    figure = follow_sheet(followed())
    labels = [(ax.get_xlabel(), ax.get_ylabel()) for ax in figure.axes]
    assert labels == [
        ("x [m]", "y [m]"),
        ("time [s]", "cross-track error [m]"),
        ("time [s]", "heading [deg]"),
    ]
    for name in ("follow.png", "follow.pdf"):
        save_figure(figure, tmp_path / name)
        assert (tmp_path / name).stat().st_size > 10_000


def test_the_path_is_drawn_where_it_is():
    drawn = follow_sheet(followed()).axes[0].get_lines()
    dashed = [line for line in drawn if line.get_linestyle() != "-" and len(line.get_ydata()) > 100]
    assert len(dashed) == 1
    # Signals are held between control instants, and the robot moves on: 5 mm in 0.05 s at 0.1 m/s.
    assert np.abs(dashed[0].get_ydata()).max() < 0.02


def test_a_title_comes_with_letters_and_a_note():
    bare = follow_sheet(followed())
    assert bare.get_suptitle() == "mamba-fin, lateral undulation, 30°, 90°/s, phase shift 40°"
    assert [ax.get_title(loc="left") for ax in bare.axes] == ["", "", ""]
    named = follow_sheet(followed(), title="One way", note="0.1 m/s")
    assert named.get_suptitle() == "One way\n0.1 m/s"
    assert [ax.get_title(loc="left") for ax in named.axes] == ["(a)", "(b)", "(c)"]


def test_a_time_is_put_on_the_other_side_of_a_body_that_turns_into_the_way():
    trial = followed(80.0, y=1.848, heading=np.deg2rad(7.7))
    figure = follow_sheet(trial)
    figure.canvas.draw()
    ax = figure.axes[0]
    way = ax.transData.transform(trial.center_of_mass)
    times = [text for text in ax.texts if text.get_text() not in ("0 s", "path")]
    assert len(times) == 4
    for text in times:
        box = text.get_window_extent()
        inside = (
            (box.x0 < way[:, 0])
            & (way[:, 0] < box.x1)
            & (box.y0 < way[:, 1])
            & (way[:, 1] < box.y1)
        )
        assert not np.any(inside), text.get_text()


@pytest.mark.parametrize("side", [-0.8, 0.0, 0.8])  # -0.8: a time is where the name usually is
def test_the_name_of_the_last_waypoint_does_not_lie_on_a_time(side):
    route = lc.Spline(waypoints=((0.0, 0.0), (0.5, 0.0), (1.0, side)))
    figure = follow_sheet(followed(path=route))
    figure.canvas.draw()
    texts = figure.axes[0].texts
    (name,) = [text for text in texts if text.get_text() == "end"]
    for text in texts:
        if text is not name:
            assert not name.get_window_extent().overlaps(text.get_window_extent()), text
