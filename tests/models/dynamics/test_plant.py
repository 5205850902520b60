import inspect
import re

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.simulate import build_plant

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
COMMAND = lc.Command(gait=GAIT)


@pytest.fixture(params=[lc.Planar(), lc.Spatial()], ids=["planar", "spatial"], scope="module")
def body(request):
    return build_plant(lc.build_scenario(lc.load_robot("mamba"), GAIT, model=request.param))


@pytest.mark.parametrize(
    ("start", "command", "message"),
    [
        (2**63, COMMAND, "`start` must be of class Start, got int."),
        ((0.0, 1.0), COMMAND, "`start` must be of class Start, got tuple."),
        (lc.Start(), GAIT, "`command` must be of class Command, got Gait."),
    ],
)
def test_a_plant_begins_with_a_start_and_a_command(body, start, command, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        inspect.unwrap(type(body).init)(body, start, command)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"state": np.ones(40)}, "`state` must be of class PlantState, got ndarray."),
        ({"command": None}, "`command` must be of class Command, got NoneType."),
        (
            {"duration": np.ones((2, 3))},
            "`duration` must be a number in s, got an array of shape (2, 3).",
        ),
        ({"duration": -1.0}, "`duration` must be > 0 s, got -1.0."),
        (
            {"duration": 1e308},
            "`duration` must be <= 100000 s at a `sample_interval` of 0.05 s, got 1e+308;",
        ),
        (
            {"sample_interval": 1e-9},
            "`duration` must be <= 0.002 s at a `sample_interval` of 1e-09 s, got 1;",
        ),
    ],
)
def test_a_march_refuses_what_it_cannot_do_by_name(body, wrong, message):
    given = {
        "state": body.init(lc.Start(), COMMAND),
        "command": COMMAND,
        "duration": 1.0,
        "sample_interval": 0.05,
    }
    with pytest.raises(ValueError, match=re.escape(message)):
        inspect.unwrap(type(body).march)(
            body, **{**given, **wrong}
        )  # as users call it, without the tests' type checks
