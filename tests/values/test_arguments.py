"""What fails with an argument of the wrong type says which one it is."""

import inspect
import pickle
import pydoc
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypedDict, TypeVar, Unpack

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import hydrodynamics
from laticauda.tank import lab
from laticauda.values import packaging
from laticauda.values.arguments import explained, misfit


@pytest.mark.parametrize(
    ("hint", "right", "wrong"),
    [
        (float, [1, 2.0, np.float32(3.0)], ["1", True, 1j]),
        (int | None, [1, None, np.int8(3)], [1.0, "x"]),
        (Literal["a", "b"], ["a"], ["c", 3, []]),
        (Sequence[str], [["a"], ("b",), []], ["a", [1], 3]),
        (Callable[[float], None], [print], [3]),
        (
            lc.Controller[Any],
            [
                lc.OpenLoop(
                    command=lc.Command(gait=lc.Gait(amplitude=0.5, frequency=2.0, phase_shift=0.7))
                )
            ],
            [lc.Start()],
        ),
        (dict[str, float], [{}], [[]]),
        (TypeVar("Either", int, str), [1, "x"], [1.5, None]),
        (Any, [None, 3], []),
    ],
)
def test_a_value_is_of_its_type_or_is_not(hint, right, wrong):
    assert [misfit("one", value, hint) for value in right] == [None] * len(right)
    assert all(misfit("one", value, hint) is not None for value in wrong)


def _doubled(numbers: Sequence[float], *, name: str = "", **further: int) -> list[float]:
    if name == "broken":
        raise KeyError("a fault of our own")
    return [2.0 * one.real for one in numbers]


def test_a_call_says_which_argument_is_of_the_wrong_type():
    doubled = explained(_doubled, __name__)
    assert doubled([1.0], further=3) == [2.0]
    with pytest.raises(
        ValueError, match=r"`numbers` must be of class Sequence\[float\], got int\."
    ):
        doubled(3)
    with pytest.raises(ValueError, match=r"`numbers\[1\]` must be of class float, got str\."):
        doubled([1.0, "x"])


def test_what_python_says_well_and_faults_of_our_own_stay_what_they_are():
    doubled = explained(_doubled, __name__)
    with pytest.raises(TypeError, match="missing 1 required positional argument"):
        doubled()
    with pytest.raises(KeyError, match="a fault of our own"):
        doubled([1.0], name="broken", further=3)


def test_public_functions_and_classes_are_explained_once_and_found_by_pickle():
    assert pickle.loads(pickle.dumps(lc.swim)) is lc.swim
    assert not hasattr(lc.swim.__wrapped__, "__wrapped__") or "explained" not in vars(
        lc.swim.__wrapped__
    )
    assert packaging.explained(lc.swim, "elsewhere") is lc.swim
    with pytest.raises(
        ValueError, match=r"`schedule` must be of class Iterable\[Fault\], got int\."
    ):
        lab.Faults(3)
    with pytest.raises(ValueError, match=r"`scenario` must be of class Scenario, got int\."):
        lc.save_scenario(3, "x.toml")


PLAIN = """
import numpy as np
from laticauda.robot import hydrodynamics, kinematics
for call in (
    lambda: hydrodynamics.wake_mass(1, 2),
    lambda: kinematics.module_poses("mamba", np.zeros(3), np.eye(3), np.zeros(8)),
    lambda: kinematics.Posture(None, np.zeros(2), np.zeros(9)),
):
    try:
        call()
    except ValueError as error:
        print(error)
"""


def test_so_are_those_of_modules_that_are_no_packages():
    # The tests' own checks of shapes would come first in this process.
    done = subprocess.run([sys.executable, "-c", PLAIN], capture_output=True, text=True, check=True)
    assert done.stdout.split("\n") == [
        f"`robot` must be of class Robot, got {kind}." for kind in ("int", "str", "NoneType")
    ] + [""]
    assert pickle.loads(pickle.dumps(hydrodynamics.wake_mass)) is hydrodynamics.wake_mass


def test_help_lists_the_keywords_that_a_function_hands_on():
    shown = inspect.signature(lc.swim)
    assert {
        "parameters",
        "environment",
        "joints",
        "model",
        "start",
        "dt",
    } <= shown.parameters.keys()
    kinds = {parameter.kind for parameter in shown.parameters.values()}
    assert inspect.Parameter.VAR_KEYWORD not in kinds
    assert repr(shown.parameters["joints"].default) == "..."
    assert "parameters: " in pydoc.render_doc(lc.swim)
    assert {"amplitude_deg", "offset"} <= inspect.signature(lc.lateral_undulation).parameters.keys()


def test_keywords_that_are_required_have_no_default_and_unnamed_ones_stay():
    def named(**changes: Unpack[Required]) -> None: ...

    def unnamed(**changes: float) -> None: ...

    parameters = inspect.signature(explained(named, "tests")).parameters
    assert list(parameters) == ["size"]
    assert parameters["size"].default is inspect.Parameter.empty
    kept = inspect.signature(explained(unnamed, "tests")).parameters["changes"]
    assert kept.kind is inspect.Parameter.VAR_KEYWORD


class Required(TypedDict):
    size: float


def test_a_class_that_only_type_checkers_import_is_named_too():
    from laticauda.show import figures

    with pytest.raises(ValueError, match=r"^`sweep` must be of class Dataset, got tuple\.$"):
        figures.sweep_sheet(sweep=(0, 1))


def test_a_wrong_keyword_that_a_function_hands_on_is_named():
    def sized(**changes: Unpack[Required]) -> float:
        return changes["size"] + 1.0

    module = vars(sys.modules[__name__])
    sized.__module__, module["sized"] = __name__, sized
    with pytest.raises(ValueError, match=r"^`size` must be of class float, got str\.$"):
        explained(sized, __name__)(size="large")


def test_a_function_that_keeps_its_results_names_what_cannot_be_kept():
    from laticauda.scenarios import preset_water

    with pytest.raises(ValueError, match=r"^`name_or_path` must be of class str or Path, got list"):
        preset_water(["paper-lateral"])


NAMED = {
    "claims": "`claims` must be of class Sequence[Claim], got int.",
    "web": "`folder` must be of class str or PathLike[str], got int.",
    "fmu": "`path` must be of class str or PathLike[str], got int.",
    "driver": "`address` must be of class str, got tuple.",
    "kind": "`kind` must be one of `bus`, `mocap`, `meter`, `stop`, `sensors`, got 'radio'.",
    "own": "`own` must be of class Mapping, got float.",
    "changes": "`changes` must be of class Mapping, got int.",
}


@pytest.mark.parametrize("subject", NAMED)
def test_packages_that_are_no_tables_of_names_name_the_argument_too(subject):
    from laticauda.connect.fmu import export_fmu
    from laticauda.connect.web import export_web
    from laticauda.paper.claims import count_verdicts
    from laticauda.tank.operate import drivers

    def parameters(**changes: Any) -> lc.Parameters:
        water = lc.load_water("paper-lateral")
        return lc.Parameters(name="a", title="b", every_gait=water, **changes)

    calls: dict[str, Callable[[], Any]] = {
        "claims": lambda: count_verdicts(3),
        "web": lambda: export_web(3),
        "fmu": lambda: export_fmu(3, "mamba"),
        "driver": lambda: drivers.Bus((1,), drivers.Clock()),
        "kind": lambda: drivers.driver_named("radio", "mamba", "x"),
        "own": lambda: parameters(own=3.0),
        "changes": lambda: parameters(changes=3),
    }
    with pytest.raises(ValueError, match=f"^{re.escape(NAMED[subject])}$"):
        calls[subject]()
