"""The stored answer of campaigns/platforms.py: what the docs say of it, and one of its runs anew."""

import itertools
import math

import pytest
from campaign_scripts import campaign

from laticauda.connect import export_fmu
from laticauda.connect.native.platforms import PLATFORMS, current_platform

platforms = campaign("platforms")


def test_every_platform_that_could_be_run_swims_as_python_does():
    names = [name for name, platform in PLATFORMS.items() if platform.fmi2_folder]
    expected = {("aarch64", platforms.IN_C), *itertools.product(names, platforms.cases())}
    answers = platforms.stored()
    assert {(answer.platform, answer.case) for answer in answers} == expected
    for answer in answers:
        if answer.platform.startswith("darwin"):
            assert math.isnan(answer.error)
        else:
            assert answer.error < 1e-12


def test_a_program_in_c_swims_here_as_the_stored_answer_says(tmp_path):
    own = current_platform()
    if own is None or own.name not in platforms.RUNNERS or platforms.missing(own.name):
        pytest.skip("its library cannot be run here")
    fmu, scenario = tmp_path / "snake.fmu", platforms.cases()["prescribed joints"]
    export_fmu(fmu, scenario)
    assert platforms.error(scenario, own.name, fmu, platforms.driver(own.name, tmp_path)) < 1e-12
