"""What joints carry in sweeps and optimizations: stored, ranked, bounded, minimized."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.studies import (
    Grid,
    Optimization,
    Rows,
    Share,
    Sweep,
    best_points,
    judge_design,
    merge_shares,
    open_sweep,
    optimize,
    run_sweep,
)
from laticauda.studies.optimization import evaluate
from laticauda.studies.point_trials import QUANTITIES
from laticauda.trials import LOAD_FIGURES

GAIT = lc.lateral_undulation(amplitude=0.3, frequency=3.0, phase_shift=0.7)
SCENARIO = lc.build_scenario("mamba", GAIT, 1.0)
AMPLITUDES = [0.1, 0.3, 0.5]
GRID = Grid(values={"gait.amplitude": AMPLITUDES})
SWEEP = Sweep(scenario=SCENARIO, points=GRID, loads=True)
SOUGHT = Optimization(
    scenario=SCENARIO,
    bounds={"gait.amplitude": (0.1, 0.6), "gait.frequency": (1.0, 4.0)},
    objectives="forward_velocity",
    beyond_actuators=True,
)


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    folder = tmp_path_factory.mktemp("swept") / "sweep"
    return folder, run_sweep(SWEEP, folder)


def test_a_sweep_stores_the_figures_of_its_trials_with_their_units(swept):
    folder, dataset = swept
    for i, amplitude in enumerate(AMPLITUDES):
        motion = replace(GAIT, amplitude=amplitude)
        trial = lc.swim(replace(SCENARIO, motion=motion), link_forces=True)
        for name in LOAD_FIGURES:
            assert float(dataset[name][i]) == pytest.approx(getattr(trial, name), rel=1e-9)
    assert dataset["peak_shear_force"].attrs == {
        "long_name": "largest shear force in a joint",
        "units": "N",
    }
    np.testing.assert_array_equal(open_sweep(folder)["rms_axial_force"], dataset["rms_axial_force"])


def test_the_best_points_of_a_sweep_carry_least(swept):
    folder, dataset = swept
    points = best_points(folder, "peak_bending_moment", 2)
    assert [point["gait.amplitude"] for point in points] == [0.1, 0.3]
    assert points[0]["peak_bending_moment"] == float(dataset["peak_bending_moment"].min())


def test_a_sweep_that_was_begun_without_loads_has_none_and_goes_on_without(tmp_path):
    without = replace(SWEEP, loads=False)
    dataset = run_sweep(without, tmp_path / "sweep")
    assert set(dataset.data_vars) == set(QUANTITIES)
    assert "loads" not in without.definition()
    with pytest.raises(ValueError, match="`peak_shear_force`; only a sweep with `loads` stores it"):
        best_points(tmp_path / "sweep", "peak_shear_force")
    with pytest.raises(ValueError, match="with another one: loads"):
        run_sweep(SWEEP, tmp_path / "sweep")


def test_shares_of_a_sweep_bring_their_loads(tmp_path, swept):
    sweep = replace(SWEEP, points=Rows(values=GRID.values))
    for number in (1, 2):
        share = Share(number=number, count=2)
        run_sweep(sweep, tmp_path / "sweep", share=share)
    assert merge_shares(sweep, tmp_path / "sweep").n_done == 3
    merged = open_sweep(tmp_path / "sweep")
    _, dataset = swept
    np.testing.assert_allclose(merged["rms_shear_force"], dataset["rms_shear_force"], rtol=1e-12)


def test_points_beyond_a_limit_of_loads_are_not_feasible_by_their_excess():
    table = np.array([[0.2, 2.0], [0.5, 3.5]])
    free = evaluate(replace(SOUGHT, objectives=("forward_velocity", "peak_bending_moment")), table)
    assert free["violation"].tolist() == [0.0, 0.0]
    moment = free["peak_bending_moment"]
    assert moment[1] > 1.5 * moment[0]
    limit = float(moment[0]) * 1.2
    bound = replace(SOUGHT, peak_bending_moment_limit=limit)
    found = evaluate(bound, table)
    assert found["violation"] == pytest.approx([0.0, moment[1] / limit - 1.0], rel=1e-9)
    assert found["rms_axial_force"].tolist() == free["rms_axial_force"].tolist()
    assert "peak_bending_moment" not in evaluate(SOUGHT, table)


def test_the_best_gait_within_a_bending_moment_reaches_it_and_the_limit_is_named(tmp_path):
    bound = replace(SOUGHT, peak_bending_moment_limit=1.0)
    front = optimize(bound, tmp_path / "a", budget=120, seed=1)
    (moment,) = front.figures["peak_bending_moment"]
    assert 0.8 < moment <= 1.0
    assert front.point(0)["peak_bending_moment"] == moment
    assert front.to_dataset()["peak_bending_moment"].attrs["units"] == "N m"
    assert front.refusals["peak bending moment"] > 10
    judgment = judge_design(bound, front.scenario(0))
    use = next(use for use in judgment.uses if use.limit == "peak bending moment")
    assert use.share == pytest.approx(moment, rel=1e-9)
    assert use.description == f"{moment:.3g} N m of at most 1"
    refused = judge_design(replace(bound, peak_bending_moment_limit=0.01), front.scenario(0))
    assert refused.refusals[0].startswith("peak bending moment: ")
    # The same goes on in its folder, another limit does not.
    assert optimize(bound, tmp_path / "a", budget=120, seed=1).n_trials == 120
    with pytest.raises(ValueError, match="peak_bending_moment_limit"):
        optimize(SOUGHT, tmp_path / "a", budget=120, seed=1, method="cma-es")


def test_speed_against_shear_force_is_a_front():
    objectives = ("forward_velocity", "peak_shear_force")
    front = optimize(replace(SOUGHT, objectives=objectives), budget=80, population=20, seed=2)
    assert len(front) > 3
    force = front.figures["peak_shear_force"]
    assert np.all(np.diff(force) > 0.0)
    assert np.all(np.diff(front.figures["forward_velocity"]) > 0.0)


def test_without_limits_of_loads_a_folder_of_an_older_release_goes_on():
    assert not any("bending" in name for name in SOUGHT.definition())
    bound = replace(SOUGHT, rms_axial_force_limit=2.0)
    assert bound.definition()["rms_axial_force_limit"] == 2.0
    assert "peak_axial_force_limit" not in bound.definition()


@pytest.mark.parametrize(
    "changes", [{"objectives": "peak_bending_moment"}, {"peak_shear_force_limit": 3.0}]
)
def test_what_joints_carry_has_no_slopes(changes):
    many = {f"gait.amplitude[{i}]": (0.1, 0.6) for i in range(8)}
    sought = replace(SOUGHT, bounds=many, **changes)
    with pytest.raises(ValueError, match="`method` must be auto, evolution or cma-es for what"):
        optimize(sought, budget=50, method="slopes")


def test_a_single_number_within_a_limit_is_found_without_cma_es_which_needs_two():
    bounds = {"gait.amplitude": (0.1, 0.6)}
    sought = replace(SOUGHT, bounds=bounds, objectives=("forward_velocity", "peak_bending_moment"))
    (limit,) = evaluate(sought, np.array([[0.4]]))["peak_bending_moment"]
    bound = replace(SOUGHT, bounds=bounds, peak_bending_moment_limit=limit)
    front = optimize(bound, budget=60, population=12)
    assert front.values[0, 0] == pytest.approx(0.4, abs=0.01)
    assert front.figures["peak_bending_moment"][0] <= limit
    with pytest.raises(ValueError, match="`method` must be auto or evolution for a single number"):
        optimize(bound, budget=60, method="cma-es")


def test_loads_in_space_are_refused_as_sweeps_in_space_are():
    with pytest.raises(ValueError, match=r"`scenario.model` must be of class Planar, got Spatial"):
        Sweep(scenario=lc.build_scenario("mamba", GAIT, model="spatial"), points=GRID, loads=True)
