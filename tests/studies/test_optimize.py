import errno
import os
import re
from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
import pytest
from campaign_scripts import campaign
from pymoo.indicators.hv import HV

import laticauda as lc
from laticauda.models.simulate import gradients
from laticauda.studies import Front, Optimization, optimize
from laticauda.studies.optimization import compute_losses, evaluate
from laticauda.studies.search import Search
from laticauda.studies.slope_search import SlopeSearch
from laticauda.values.errors import StorageFailed

kills = campaign("optimize_kills")
BOUNDS = {"gait.amplitude": (0.2, 0.9), "gait.phase_shift": (0.2, 1.2)}
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
SCENARIO = lc.build_scenario("mamba", GAIT, 2.0)
SOUGHT = Optimization(scenario=SCENARIO, bounds=BOUNDS)


def small(sought: Optimization = SOUGHT, folder: Path | None = None, **how) -> Front:
    return optimize(sought, folder, **{"budget": 60, "population": 12, "seed": 2, **how})


def same(a: Front, b: Front) -> bool:
    return kills.contents(a) == kills.contents(b)


def test_no_point_of_the_front_beats_another_one_and_all_are_within_the_bounds():
    front = small()
    found = compute_losses(front.optimization.objectives, front.figures)
    assert len(front) > 3
    assert np.all(np.diff(found[:, 1]) > 0.0) and np.all(np.diff(found[:, 0]) < 0.0)
    for column, (low, high) in zip(front.values.T, BOUNDS.values(), strict=True):
        assert np.all((low <= column) & (column <= high))


def test_the_figures_of_a_point_are_those_of_its_trial():
    front = small()
    trial = lc.swim(SCENARIO.robot, front.gait(-1 % len(front)), 2.0)
    assert front.figures["forward_velocity"][-1] == pytest.approx(trial.forward_velocity, rel=1e-10)
    assert front.figures["mechanical_power"][-1] == pytest.approx(trial.mechanical_power, rel=1e-10)


def test_the_search_is_worth_more_than_as_many_random_points():
    front = small(budget=240, population=24)
    low, high = SOUGHT.box()
    by_chance = compute_losses(
        SOUGHT.objectives,
        evaluate(SOUGHT, np.random.default_rng(0).uniform(low, high, (240, low.size))),
    )
    found = compute_losses(SOUGHT.objectives, front.figures)
    reference = (0.0, float(found[:, 1].max()))
    area = HV(ref_point=np.array(reference))  # of what a front beats
    assert area(found) > area(by_chance)


def test_for_one_objective_it_finds_the_maximum_of_a_grid_or_better():
    sought = replace(SOUGHT, objectives="forward_velocity", beyond_actuators=True)
    front = small(sought, budget=320, population=16)
    axes = np.meshgrid(*(np.linspace(*ends, 12) for ends in BOUNDS.values()))
    table = np.stack([axis.ravel() for axis in axes], axis=1)
    assert len(front) == 1
    assert front.figures["forward_velocity"][0] >= evaluate(sought, table)["forward_velocity"].max()


def test_it_keeps_within_what_the_actuators_have_unless_told_otherwise():
    scenario = lc.build_scenario("mamba-fin", SCENARIO.gait, 6.0)
    sought = replace(SOUGHT, scenario=scenario, objectives="forward_velocity")
    within = small(sought, budget=96, population=16)
    beyond = small(replace(sought, beyond_actuators=True), budget=96, population=16)
    assert within.figures["utilization"][0] <= 1.0 < beyond.figures["utilization"][0]
    assert within.n_infeasible > 0 == beyond.n_infeasible
    assert within.figures["forward_velocity"][0] < beyond.figures["forward_velocity"][0]
    assert lc.swim(within.scenario(0)).feasibility.problems == ()


MODULE = lc.load_robot("mamba-fin").modules[0]
HALF_HEIGHT = MODULE.section.half_height
MANY_BOUNDS = {
    "gait.amplitude": (0.2, 0.9),
    "gait.frequency": (1.0, 3.0),
    "gait.phase_shift": (0.2, 1.2),
    "gait.offset": (-0.1, 0.1),
    "robot.caudal_fin.length": (0.13, 0.4),
    "robot.caudal_fin.height": (0.05, 0.4),
    **{
        f"robot.module.{name}": (0.85 * getattr(MODULE, name), 1.1 * getattr(MODULE, name))
        for name in ("length", "mass")
    },
    "robot.module.section.half_height": (0.9 * HALF_HEIGHT, 1.1 * HALF_HEIGHT),
    "robot.module.center": (-0.01, 0.01),
    "robot.joint.damping": (0.0, 0.1),
}
MANY = Optimization(
    scenario=lc.build_scenario("mamba-fin", GAIT, 4.0),
    bounds=MANY_BOUNDS,
    objectives="forward_velocity",
    beyond_actuators=True,
)


def test_slopes_of_many_numbers_are_worth_more_than_three_times_the_points(monkeypatch):
    with_slopes = small(MANY, budget=120, population=24)
    monkeypatch.setattr(gradients, "MOST_FORWARD", 1000)
    by_evolution = small(MANY, budget=360, population=24)
    ends = with_slopes.figures["forward_velocity"], by_evolution.figures["forward_velocity"]
    assert ends[0][0] > ends[1][0]


def test_a_search_along_slopes_goes_on_to_the_same_bits(tmp_path: Path):
    whole = small(MANY, budget=90, population=24)
    small(MANY, tmp_path, budget=60, population=24)
    assert same(whole, small(MANY, tmp_path, budget=90, population=24))


def test_a_search_along_slopes_ends_at_the_optimum_on_the_bounds():
    low, high = np.full(3, -1.0), np.array([2.0, 2.0, 0.5])
    middle, stretch = np.array([0.3, -0.4, 1.0]), np.array([1.0, 30.0, 5.0])

    def loss(points):
        return np.sum(stretch * (points - middle) ** 2, axis=-1)

    evolution = Search(low, high, n_objectives=1, population=8, seed=0)
    search = SlopeSearch(evolution, lambda point: 2.0 * stretch * (point - middle), low, high)
    losses: list[float] = []
    for _ in range(25):
        points = search.ask()
        assert np.all((low <= points) & (points <= high))
        losses += loss(points).tolist()
        search.tell(loss(points)[:, np.newaxis], np.zeros(len(points)))
    assert min(losses) == pytest.approx(loss(np.array([0.3, -0.4, 0.5])), rel=1e-6)


@pytest.mark.parametrize("n_objectives", [1, 2])
def test_a_search_finds_what_is_known_and_keeps_off_what_is_not_feasible(n_objectives: int):
    search = Search(
        np.array([-2.0, -2.0]),
        np.array([2.0, 3.0]),
        n_objectives=n_objectives,
        population=20,
        seed=1,
    )
    points = np.empty((0, 2))
    for _ in range(40):
        asked = search.ask()
        points = np.concatenate((points, asked))
        found = np.stack([np.sum((asked - at) ** 2, axis=1) for at in (0.0, 1.0)], axis=1)
        search.tell(found[:, :n_objectives], np.maximum(0.5 - asked[:, 0], 0.0))
    feasible = points[points[:, 0] >= 0.5]
    # Of the allowed points this is the nearest to the origin.
    assert np.min(np.linalg.norm(feasible - (0.5, 0.0), axis=1)) < 0.02


def test_the_same_seed_gives_the_same_bits_and_another_one_does_not():
    first = small()
    np.random.seed(1)  # noqa: NPY002 - a global state must not matter
    assert same(small(threads=1), first)
    assert not same(small(seed=3), first)


@pytest.mark.parametrize(
    "objectives", [("forward_velocity", "mechanical_power"), ("cost_of_transport",)]
)
def test_one_that_stops_anywhere_goes_on_to_the_same_bits(
    tmp_path: Path, objectives: tuple[str, ...]
):
    sought = replace(SOUGHT, objectives=objectives)
    whole = small(sought)

    def stop(done: int, total: int) -> None:
        if done >= 24:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        small(sought, tmp_path / "a", progress=stop)
    seen: list[int] = []
    assert same(
        small(sought, tmp_path / "a", progress=lambda done, total: seen.append(done)), whole
    )
    assert seen == [24, 36, 48, 60]
    # Once more there is nothing to do.
    seen.clear()
    assert same(
        small(sought, tmp_path / "a", progress=lambda done, total: seen.append(done)), whole
    )
    assert seen == [60]


def test_a_greater_budget_goes_on_and_a_smaller_one_looks_back(tmp_path: Path):
    small(folder=tmp_path / "a", budget=31)  # ends within a generation
    assert same(small(folder=tmp_path / "a"), small())
    assert same(small(folder=tmp_path / "a", budget=31), small(budget=31))


def test_one_that_is_killed_comes_out_the_same_bit_for_bit(tmp_path: Path):
    expected = kills.contents(kills.run(None, 960))
    assert kills.kill_at_moments(tmp_path / "a", 960, kills=1, seed=1) == 1
    assert 0 < len(list((tmp_path / "a").iterdir())) <= 2
    assert kills.contents(kills.run(tmp_path / "a", 960)) == expected


def test_whole_numbers_stay_whole():
    sought = replace(SOUGHT, bounds={**BOUNDS, "robot.n_links": (4, 6)})
    front = small(sought)
    assert set(front.values[:, 2]) <= {4.0, 5.0, 6.0}
    low, high = sought.box()
    assert sought.points(np.array([low, high]))[:, 2].tolist() == [4.0, 6.0]


def test_where_nothing_is_feasible_the_front_is_empty():
    robot = lc.load_robot("mamba")
    stiff = replace(robot, joints=tuple(replace(joint, limit=radians(1)) for joint in robot.joints))
    front = small(replace(SOUGHT, scenario=replace(SCENARIO, robot=stiff)))
    assert (len(front), front.n_trials, front.n_infeasible) == (0, 60, 60)
    # Two seconds are too short for a steady velocity.
    assert len(small(replace(SOUGHT, objectives="steady_velocity"))) == 0


def test_a_folder_of_another_optimization_is_refused_with_the_difference(tmp_path: Path):
    small(folder=tmp_path / "a")
    before = (tmp_path / "a" / "checkpoint.npz").read_bytes()
    longer = replace(SOUGHT, scenario=replace(SCENARIO, duration=3.0))
    other = replace(SOUGHT, bounds={**BOUNDS, "gait.amplitude": (0.2, 0.8)})
    for sought, how, message in (
        (other, {}, "bounds.gait.amplitude[1] is 0.9 there and 0.8 here"),
        (SOUGHT, {"seed": 7}, "seed is 2 there and 7 here"),
        (longer, {"population": 20}, "duration is 2.0 there and 3.0 here; population is 12"),
    ):
        with pytest.raises(
            ValueError, match="`folder` must be empty, or hold this opt.*" + re.escape(message)
        ):
            small(sought, tmp_path / "a", **how)
    assert (tmp_path / "a" / "checkpoint.npz").read_bytes() == before


def test_a_folder_with_files_of_somebody_else_is_refused(tmp_path: Path):
    (tmp_path / "thesis.tex").write_text("")
    with pytest.raises(
        ValueError,
        match=r"`folder` must be empty, or hold this optimization, got .* with thesis\.tex",
    ):
        small(folder=tmp_path)
    with pytest.raises(ValueError, match="`folder` must be a folder, got the file"):
        small(folder=tmp_path / "thesis.tex")
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


@pytest.mark.parametrize("damage", ["cut", "bit", "empty"])
def test_a_damaged_checkpoint_is_refused(tmp_path: Path, damage: str):
    small(folder=tmp_path / "a", budget=12)
    file = tmp_path / "a" / "checkpoint.npz"
    content = bytearray(file.read_bytes())
    if damage == "bit":
        content[len(content) // 2] ^= 1
    file.write_bytes({"cut": content[:-100], "bit": content, "empty": b""}[damage])
    with pytest.raises(ValueError, match=r"`folder` must hold a readable `checkpoint\.npz`, got"):
        small(folder=tmp_path / "a")


def test_a_checkpoint_that_the_search_does_not_repeat_is_refused(tmp_path: Path):
    small(folder=tmp_path / "a", budget=24)
    file = tmp_path / "a" / "checkpoint.npz"
    with np.load(file) as stored:
        arrays = dict(stored)
    arrays["points"][13] += 1e-9
    np.savez(file, **arrays)
    with pytest.raises(ValueError, match="the search differs after 12 trials"):
        small(folder=tmp_path / "a")


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"budget": 11}, "`budget` must be a whole number >= 12, got 11"),
        ({"population": 3}, "`population` must be a whole number >= 4, got 3"),
        ({"seed": -1}, "`seed` must be a whole number >= 0, got -1"),
        ({"threads": 0}, "`threads` must be a whole number >= 1, got 0"),
    ],
)
def test_bad_input_is_refused(how: dict[str, int], message: str):
    with pytest.raises(ValueError, match=message):
        small(**how)


@pytest.mark.parametrize("call", ["np.savez", "os.fsync", "os.replace"])
def test_a_full_disk_costs_nothing_that_was_stored(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str
):
    small(folder=tmp_path / "a", budget=24)

    def full(*_, **__) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as context:
        context.setattr({"np": np, "os": os}[call[:2]], call[3:], full)
        message = "the disk is full. Nothing that was stored is lost: 24 trials are stored; free some space and run"
        with pytest.raises(StorageFailed, match=message):
            small(folder=tmp_path / "a")
    seen: list[int] = []
    assert same(
        small(folder=tmp_path / "a", progress=lambda done, total: seen.append(done)), small()
    )
    assert seen[0] == 24


def test_no_second_process_works_in_the_same_folder(tmp_path: Path):
    def again(done: int, total: int) -> None:
        small(folder=tmp_path / "a")

    with pytest.raises(
        ValueError, match="`folder` must be one that no other process is writing to"
    ):
        small(folder=tmp_path / "a", progress=again)
