import pytest
from studies.sweeps import small

from laticauda.studies import Grid


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"gait.amplitud": [0.1]}, "got 'gait.amplitud'; the nearest are `gait.amplitude`"),
        (
            {"gait.amplitude": [-0.1, 0.1]},
            "got gait.amplitude = -0.1: amplitude must be between 0 and 3.14159 rad",
        ),
        ({"robot.n_links": [5, 5.5, 7]}, "`robot.n_links` must be a whole number, got 5.5"),
        ({"robot.n_links": [0]}, "got robot.n_links = 0: n_links must be a whole number >= 1"),
        ({"water.depth": [0.01, 1.0]}, "got water.depth = 0.01: depth must be > 0.055 m"),
        (
            {"water.normal_drag": [1.0, 1e8]},
            "got water.normal_drag = 1e.08: environment must let a link glide",
        ),
        ({"robot.caudal_fin.length": [0.5]}, "got 'robot.caudal_fin.length'"),
    ],
)
def test_what_cannot_be_swept_is_refused_before_any_work(values, message: str):
    with pytest.raises(ValueError, match=message):
        small(points=Grid(values=values))


def test_a_setup_out_of_its_range_is_refused():
    with pytest.raises(ValueError, match="`duration` must be > 0 s, got 0"):
        small(duration=0.0)
    with pytest.raises(ValueError, match="`region_size` must be a whole number >= 1, got 0"):
        small().regions(0)
    with pytest.raises(
        ValueError,
        match="`joints` must be one of `prescribed`, `pd`, `servo`, `ekeberg`, `hill`, `speed-servo`, got 'pdd'",
    ):
        small(joints="pdd")
    with pytest.raises(
        ValueError, match="`points` must be of class Grid or Rows or Samples, got dict"
    ):
        small(points={"gait.amplitude": [0.1]})
