from pathlib import Path

import numpy as np
import pytest
from matplotlib.animation import FuncAnimation
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image
from show.figures.runs import lateral

import laticauda as lc
from laticauda.show.figures import save_figure


@pytest.fixture(scope="module")
def trial() -> lc.Trial:
    return lc.swim("mamba-fin", lateral(), 3.0)


@pytest.fixture(scope="module")
def followed() -> lc.Trial:
    from laticauda.control import Following

    course = Following(waypoints=((0.0, 0.0), (0.5, 0.0), (0.8, 0.2)))
    return lc.swim("mamba-fin", course.controller(lateral()), 20.0)


def test_a_trial_draws_itself_and_a_notebook_shows_it(trial: lc.Trial):
    figure = trial.plot()
    assert isinstance(figure, Figure)
    assert figure.get_suptitle().startswith("mamba-fin, lateral undulation")
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_the_path_is_drawn_where_it_is_asked_for(trial: lc.Trial):
    ax = trial.plot_path()
    assert isinstance(ax, Axes)
    assert trial.plot_path(ax) is ax
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")


@pytest.mark.parametrize("ending", ["gif", "webp"])
def test_a_film_has_a_picture_for_every_moment_and_the_body_moves_in_it(
    ending: str, trial: lc.Trial, tmp_path: Path
):
    film = trial.animate(speed=2.0, frames_per_second=10.0)
    assert isinstance(film, FuncAnimation)
    file = tmp_path / f"film.{ending}"
    film.save(file)
    with Image.open(file) as shown:
        assert shown.n_frames == 16
        first = np.asarray(shown.convert("RGB"), dtype=float)
        assert shown.info["duration"] == 100.0
        shown.seek(15)
        last = np.asarray(shown.convert("RGB"), dtype=float)
    differ = np.abs(first - last).max(axis=2) > 60.0
    assert 0.005 < differ.mean() < 0.2
    assert not differ[60:, :40].any()  # the axis stands still
    assert film._repr_html_().startswith('<img src="data:image/webp;base64,')


def test_a_film_can_be_written_as_matplotlib_does_it(trial: lc.Trial, tmp_path: Path):
    trial.animate(frames_per_second=2.0).save(tmp_path / "film.png", writer="pillow", dpi=40)
    assert (tmp_path / "film.png").stat().st_size > 1000


def test_a_film_needs_a_pace(trial: lc.Trial):
    with pytest.raises(ValueError, match="`speed` must be > 0, got 0"):
        trial.animate(speed=0.0)


def test_a_followed_path_is_drawn_with_its_corners_and_its_end(followed: lc.Trial, tmp_path: Path):
    figure = followed.plot()
    assert [ax.get_ylabel() for ax in figure.axes] == [
        "y [m]",
        "cross-track error [m]",
        "heading [deg]",
    ]
    assert figure.get_suptitle().startswith("mamba-fin, lateral undulation")
    corners = [
        line
        for line in figure.axes[0].get_lines()
        if line.get_marker() == "o" and len(line.get_xdata()) == 3
    ]
    np.testing.assert_array_equal(corners[0].get_xdata(), [0.0, 0.5, 0.8])
    assert "end" in [text.get_text() for text in figure.axes[0].texts]
    save_figure(figure, tmp_path / "follow.svg")
    assert "<svg" in (tmp_path / "follow.svg").read_text(encoding="utf-8")[:500]
    followed.animate(frames_per_second=1.0).save(tmp_path / "follow.gif")
