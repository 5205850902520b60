import numpy as np
import pytest

from laticauda.film import TrackedPoints

VALID = {
    "time": np.arange(3) / 30.0,
    "names": ("nose", "tail"),
    "position": np.zeros((3, 2, 2)),
    "likelihood": np.full((3, 2), np.nan),
    "unit": "px",
}


def with_nan_in_x_alone():
    position = np.zeros((3, 2, 2))
    position[1, 0, 0] = np.nan
    return position


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"time": np.array([0.0, 0.2, 0.1])},
            "`time` must increase from frame to frame, got 0.1 s after 0.2 s in frame 2.",
        ),
        ({"time": np.array([0.0, np.nan, 0.1])}, "`time` must hold finite numbers in s"),
        ({"names": ("nose", "nose")}, "`names` must name every point once, got `nose` twice."),
        ({"names": ("nose", " ")}, "must be a text on one line that is not blank"),
        ({"position": with_nan_in_x_alone()}, "`position` must lack both x and y"),
        ({"position": np.full((3, 2, 2), np.inf)}, "`position` must be finite"),
        ({"likelihood": np.full((3, 2), 1.5)}, "`likelihood` must lie between 0 and 1"),
        ({"unit": "mm"}, "`unit` must be one of `px`, `m`, got 'mm'"),
    ],
)
def test_fields_that_do_not_fit_together_are_refused_by_name(change, message):
    with pytest.raises(ValueError) as error:
        TrackedPoints(**(VALID | change))
    assert message in str(error.value)


def test_a_lost_point_is_nan_and_everything_else_is_seen():
    position = np.zeros((3, 2, 2))
    position[1, 0] = np.nan
    points = TrackedPoints(**(VALID | {"position": position}))
    assert points.is_seen.tolist() == [[True, True], [False, True], [True, True]]
    assert points.frame_rate == pytest.approx(30.0)
    assert repr(points) == "<TrackedPoints: 2 points in 3 frames at 30 1/s, px>"
    assert points.with_notes("Lost twice.").notes == ("Lost twice.",)


def test_a_point_that_is_not_there_is_refused_with_those_that_are():
    with pytest.raises(ValueError, match="must be one of `nose`, `tail`, got 'tial'"):
        TrackedPoints(**VALID).index_of("tial")
