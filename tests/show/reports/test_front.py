from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.paper import load_efficiency_settings
from laticauda.show.reports.front import draw_front_sheet, write_front_figure
from laticauda.show.reports.front_axes import simulate_measured_gaits
from laticauda.studies import Front, Optimization, optimize

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
SOUGHT = Optimization(
    scenario=lc.build_scenario("mamba", GAIT, 2.0),
    bounds={"gait.amplitude": (0.2, 0.9), "gait.phase_shift": (0.2, 1.2), "robot.n_links": (8, 12)},
)


@pytest.fixture(scope="module")
def found() -> Front:
    return optimize(SOUGHT, budget=48, population=12, seed=1)


def test_the_folder_gets_the_figure(found: Front, tmp_path: Path):
    files = write_front_figure([found], tmp_path)
    assert [file.name for file in files] == ["front.png", "front.pdf"]
    assert sorted(tmp_path.iterdir()) == sorted(files)


def test_without_a_front_there_is_no_figure(tmp_path: Path):
    single = optimize(replace(SOUGHT, objectives="forward_velocity"), budget=12, population=12)
    assert write_front_figure([single], tmp_path) == []
    assert not list(tmp_path.iterdir())


def test_the_old_name_of_the_figure_leads_to_its_new_one():
    with pytest.deprecated_call(match="front_figure is now laticauda.show.reports.front.draw"):
        from laticauda.show.reports.front import front_figure
    assert front_figure is draw_front_sheet


def test_the_figure_says_the_numbers_of_the_drawn_gaits(found: Front):
    figure = draw_front_sheet([found])
    ax, column = figure.axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("mechanical power [W]", "forward velocity [m/s]")
    last = column.texts[-1].get_text()
    amplitude, shift, links = found.values[-1]
    words = f"$\\alpha$ = {np.degrees(amplitude):.0f}°, $\\delta$ = {np.degrees(shift):.0f}°"
    assert last == f"{words}, $n$ = {links:.0f}"


def test_the_papers_gaits_are_simulated_like_the_points_of_the_front(found: Front):
    points = simulate_measured_gaits(found)
    group = next(
        one
        for one in load_efficiency_settings().groups
        if (one.gait, one.robot) == ("lateral_undulation", "mamba")
    )
    assert len(points) == len(group.cases)
    trial = lc.swim(SOUGHT.scenario.robot, group.cases[2].gait, 2.0)
    assert points[2] == pytest.approx([trial.mechanical_power, trial.forward_velocity], rel=1e-10)


def test_another_robot_has_none_of_them(found: Front):
    eel = replace(SOUGHT.scenario, robot=replace(SOUGHT.scenario.robot, name="eel"))
    other = replace(found, optimization=replace(SOUGHT, scenario=eel))
    assert simulate_measured_gaits(other).shape == (0, 2)


def test_the_figure_says_in_which_water_each_gait_swims(found: Front):
    eel = lc.eel_like(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    other = optimize(
        replace(SOUGHT, scenario=lc.build_scenario("mamba", eel, 2.0)), budget=24, population=12
    )
    assert (
        draw_front_sheet([found]).get_suptitle().endswith("48 trials of 2 s, water paper-lateral")
    )
    both = draw_front_sheet([found, other]).get_suptitle()
    assert both.endswith(
        "72 trials of 2 s, each gait with its own water: paper-lateral and paper-eel"
    )
