"""Places in pictures of runs."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import PolyCollection

import laticauda as lc
from laticauda.sensing import Buoy, Net, Seabed
from laticauda.show.figures import outlines_of, places_of

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
PLACES = (Net(name="pen", center=(4.0, 2.0), radius=1.0), Buoy(name="mark"), Seabed(depth=3.0))


@pytest.fixture(scope="module")
def trial():
    scenario = lc.build_scenario("mamba", GAIT, 1.0)
    return lc.swim(replace(scenario, model=replace(scenario.model, places=PLACES)))


def test_a_path_is_drawn_with_the_places_around_it_and_their_names(trial):
    ax = trial.plot_path()
    left, right = ax.get_xlim()
    low, high = ax.get_ylim()
    assert left < -0.2
    assert right > 5.0
    assert low < -0.2
    assert high > 3.0
    assert {"pen", "mark"} <= {text.get_text() for text in ax.texts}
    shapes = [each for each in ax.collections if isinstance(each, PolyCollection)]
    n_outlines = [len(shape.get_paths()) for shape in shapes]
    assert 24 in n_outlines  # the panels of the net


def test_a_film_from_above_has_room_for_the_places(trial):
    film = trial.animate(frames_per_second=2.0)
    (ax,) = film._fig.axes
    assert ax.get_xlim()[1] > 5.0
    assert {"pen", "mark"} <= {text.get_text() for text in ax.texts}


def test_the_outlines_of_a_run_are_those_of_its_places(trial):
    assert places_of(trial) == PLACES
    assert np.concatenate(outlines_of(PLACES)).max() == pytest.approx(5.0, abs=0.05)


def test_a_picture_in_space_has_the_places(trial):
    pytest.importorskip("mujoco")
    from laticauda.show.pictures import Studio

    model = Studio.of_trial(trial).model
    names = {model.geom(number).name for number in range(model.ngeom)}
    assert {"pen_0", "pen_23", "mark_0"} <= names
    *_, opacity = model.geom("pen_0").rgba
    assert opacity < 1.0  # one sees through a net
