"""The checks: what they let through, what they refuse, and in which words."""

import math
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.values import checks, errors
from laticauda.values.installation import advise_extra

CHECKS = [
    checks.check_finite,
    checks.check_positive,
    checks.check_not_negative,
    lambda name, value, unit: checks.check_within(name, value, 0.0, 10.0, unit),
]


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize("value", [2, 2.0, np.float64(2), np.float32(2), np.int64(2)])
def test_every_kind_of_number_becomes_a_python_float(check, value):
    cleaned = check("length", value, "m")
    assert cleaned == 2.0
    assert type(cleaned) is float


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize(
    ("value", "shown"),
    [
        ("2", "'2'"),
        (None, "None"),
        (True, "True"),
        (np.True_, "np.True_"),
        (2j, "2j"),
        ([2.0], r"\[2.0\]"),
        (np.ones(3), r"an array of shape \(3,\)"),
        (list(range(100)), r"\[0, 1, .*\.\.\."),
    ],
)
def test_what_is_no_number_is_refused(check, value, shown):
    with pytest.raises(ValueError, match=rf"^`length` must be a number in m, got {shown}\.$"):
        check("length", value, "m")


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, np.float64("nan"), 10**400])
def test_what_is_not_finite_is_refused(check, value):
    with pytest.raises(
        ValueError, match=r"^`length` must be a finite number in m, got (nan|-?inf)\.$"
    ):
        check("length", value, "m")


@pytest.mark.parametrize("value", [-1.0, np.float64(-1.0), 0.0])
def test_positive_says_rule_unit_and_value(value):
    with pytest.raises(ValueError, match=rf"^`length` must be > 0 m, got {value}\.$"):
        checks.check_positive("length", value, "m")


def test_a_pure_number_has_no_unit_in_its_message():
    with pytest.raises(ValueError, match=r"^`normal_drag` must be > 0, got -1\.0\.$"):
        checks.check_positive("normal_drag", -1.0)
    with pytest.raises(ValueError, match=r"^`normal_drag` must be a number, got 'x'\.$"):
        checks.check_positive("normal_drag", "x")


def test_not_negative_lets_zero_through_and_nothing_below():
    assert checks.check_not_negative("stiffness", 0.0, "N m/rad") == 0.0
    with pytest.raises(ValueError, match=r"^`stiffness` must be >= 0 N m/rad, got -0\.5\.$"):
        checks.check_not_negative("stiffness", -0.5, "N m/rad")


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_within_lets_through_exactly_the_closed_range(value: float):
    if -1.5 <= value <= 2.0:
        assert checks.check_within("angle", value, -1.5, 2.0, "rad") == value
    else:
        with pytest.raises(ValueError, match=r"^`angle` must be between -1\.5 and 2 rad, got "):
            checks.check_within("angle", value, -1.5, 2.0, "rad")


@pytest.mark.parametrize("value", [3, np.int64(3), np.uint8(3)])
def test_whole_numbers_become_python_ints(value):
    cleaned = checks.check_whole_number("n_links", value, 2)
    assert cleaned == 3
    assert type(cleaned) is int


@pytest.mark.parametrize("value", [1, 2.0, True, "3", None, math.nan, np.float64(3.0)])
def test_whole_refuses_fractions_texts_and_too_few(value):
    with pytest.raises(ValueError, match=r"^`n_links` must be a whole number >= 2, got "):
        checks.check_whole_number("n_links", value, 2)


FORMS = ["relative", "kirchhoff", "classic"]


def test_one_of_returns_the_choice():
    assert checks.check_choice("added_mass_form", "classic", FORMS) == "classic"


@pytest.mark.parametrize(
    ("value", "end"),
    [
        ("kirchof", r"got 'kirchof'; did you mean `kirchhoff`\?"),
        ("Classic", r"got 'Classic'; did you mean `classic`\?"),
        ("xyz", r"got 'xyz'\."),
        (None, r"got None\."),
        (np.array(["classic", "relative"]), r"got an array of shape \(2,\)\."),
    ],
)
def test_one_of_lists_the_choices_and_suggests_the_nearest(value, end):
    match = rf"^`added_mass_form` must be one of `relative`, `kirchhoff`, `classic`, {end}$"
    with pytest.raises(ValueError, match=match):
        checks.check_choice("added_mass_form", value, FORMS)


def test_nearest_looks_past_capitals_and_hyphens():
    assert checks.suggest_nearest("LATERAL-UNDULATION", ["eel_like", "lateral_undulation"]) == (
        "; did you mean `lateral_undulation`?"
    )


def test_nearest_is_silent_when_nothing_comes_near():
    assert checks.suggest_nearest("sidewinding", ["eel_like"]) == ""
    assert checks.suggest_nearest("sidewinding", []) == ""


@pytest.mark.parametrize(
    ("error", "builtin"),
    [
        (errors.SimulationFailed, RuntimeError),
        (errors.MissingExtra, ImportError),
        (errors.MissingProgram, RuntimeError),
        (errors.TrialFileError, ValueError),
        (errors.RobotFileError, ValueError),
    ],
)
def test_an_error_is_ours_and_the_builtin(error, builtin):
    assert issubclass(error, errors.LaticaudaError)
    assert issubclass(error, builtin)


def test_a_missing_extra_says_what_to_install_also_after_crossing_processes():
    error = pickle.loads(pickle.dumps(errors.MissingExtra("The 3D model", "MuJoCo", "spatial")))
    assert str(error) == f"The 3D model needs MuJoCo; {advise_extra('spatial')}."


def test_a_missing_program_says_what_to_install_also_after_crossing_processes():
    error = pickle.loads(
        pickle.dumps(errors.MissingProgram("A video", "the program ffmpeg", "ffmpeg"))
    )
    assert (
        str(error)
        == "A video needs the program ffmpeg; on Debian and Ubuntu run `apt-get install ffmpeg`."
    )


DEAF = """
import signal, sys
from laticauda.values.optional import load_mujoco

def look(event, args):
    if event == "subprocess.Popen":
        print(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []))

sys.addaudithook(look)
load_mujoco()
print(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []))
"""


@pytest.mark.skipif(os.name != "posix", reason="no such masks")
def test_processes_that_are_started_while_mujoco_is_imported_never_get_to_know_of_ctrl_c():
    done = subprocess.run([sys.executable, "-c", DEAF], capture_output=True, text=True, check=True)
    *started, afterwards = done.stdout.split()
    assert (set(started) <= {"True"}, afterwards) == (True, "False")
