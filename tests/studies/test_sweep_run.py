import errno
import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray
from studies.sweeps import AMPLITUDE, DRAG, GAIT, small

import laticauda as lc
from laticauda.studies import (
    Grid,
    Rows,
    Samples,
    best_points,
    count_failed,
    count_infeasible,
    open_sweep,
    run_sweep,
    store,
    stored_sweep,
)
from laticauda.studies.checksums import read_checksums, write_checksums
from laticauda.values.errors import StorageFailed


def bits(folder: Path) -> dict[str, bytes]:
    return {
        str(name): array.to_numpy().tobytes()
        for name, array in open_sweep(folder).variables.items()
    }


def test_every_point_is_the_trial_of_its_parameters(tmp_path: Path):
    sweep = small()
    found = run_sweep(sweep, tmp_path / "a", region_size=5)
    assert found.forward_velocity.dims == ("gait.amplitude", "water.normal_drag")
    for i, amplitude in enumerate(AMPLITUDE):
        for j, drag in enumerate(DRAG):
            water = replace(lc.load_water("paper-lateral"), normal_drag=drag)
            trial = lc.swim(
                sweep.scenario.robot, replace(GAIT, amplitude=amplitude), 1.0, environment=water
            )
            point = found.isel({"gait.amplitude": i, "water.normal_drag": j})
            for name in ("forward_velocity", "mechanical_power", "net_power", "cost_of_transport"):
                assert float(point[name]) == pytest.approx(getattr(trial, name), rel=1e-9)
            assert bool(point.succeeded)


def test_every_number_has_a_unit_and_a_title(tmp_path: Path):
    found = run_sweep(small(), tmp_path / "a")
    assert all("long_name" in variable.attrs for variable in found.variables.values())
    assert {
        name for name, variable in found.variables.items() if "units" not in variable.attrs
    } == {"succeeded"}
    assert found["gait.amplitude"].attrs == {"long_name": "amplitude", "units": "rad"}
    assert found["water.normal_drag"].attrs == {"long_name": "normal drag", "units": "1"}
    assert (found.n_trials, found.n_finished) == (12, 12)


@pytest.mark.parametrize(
    "points",
    [
        Grid(values={"gait.amplitude": AMPLITUDE, "robot.n_links": [7, 8, 9]}),
        Rows(values={"gait.amplitude": [0.5, 0.3, 0.5], "robot.n_links": [9, 7, 9]}),
        Samples(ranges={"gait.amplitude": (0.2, 0.7), "robot.n_links": (7, 9)}, n_points=10),
    ],
    ids=["grid", "rows", "samples"],
)
def test_the_result_does_not_depend_on_the_regions(tmp_path: Path, points):
    for size in (1, 4, 1000):
        run_sweep(small(points=points), tmp_path / str(size), region_size=size)
    whole = open_sweep(tmp_path / "1000").load()
    for size in ("1", "4"):
        xarray.testing.assert_allclose(open_sweep(tmp_path / size), whole, rtol=1e-10)


def test_samples_have_their_parameters_beside_them(tmp_path: Path):
    points = Samples(ranges={"gait.amplitude": (0.2, 0.7), "robot.n_links": (7, 9)}, n_points=10)
    found = run_sweep(small(points=points), tmp_path / "a", region_size=4)
    assert found["robot.n_links"].dims == ("trial",) and "robot.n_links" in found.coords
    one = found.isel(trial=7)
    robot = lc.load_robot("mamba", n_links=int(one["robot.n_links"]))
    trial = lc.swim(robot, replace(GAIT, amplitude=float(one["gait.amplitude"])), 1.0)
    assert float(one.forward_velocity) == pytest.approx(trial.forward_velocity, rel=1e-9)


class Stop(Exception):
    """In place of the user's Ctrl-C."""


def stopped(sweep, folder: Path, at: int, **how) -> None:
    """Run a part of a sweep."""

    def stop(done: int, total: int) -> None:
        if done >= at:
            raise Stop

    with pytest.raises(Stop):
        run_sweep(sweep, folder, progress=stop, **how)


def test_a_sweep_goes_on_where_it_was_stopped(tmp_path: Path):
    run_sweep(small(), tmp_path / "whole", region_size=2)
    stopped(small(), tmp_path / "parts", 5, region_size=2)
    begun = open_sweep(tmp_path / "parts")
    assert (
        begun.n_finished
        == int(begun.succeeded.sum())
        == int(begun.forward_velocity.notnull().sum())
        == 6
    )
    told: list[tuple[int, int]] = []
    run_sweep(small(), tmp_path / "parts", progress=lambda *reached: told.append(reached))
    assert told == [(6, 12), (8, 12), (10, 12), (12, 12)]
    assert bits(tmp_path / "parts") == bits(tmp_path / "whole")


def test_a_finished_sweep_is_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    run_sweep(small(), tmp_path / "a")
    monkeypatch.setattr(
        "laticauda.studies.point_trials.run_columns", lambda *_, **__: pytest.fail("it ran")
    )
    assert run_sweep(small(), tmp_path / "a").n_finished == 12


def test_a_region_counts_only_when_all_of_it_is_stored(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    run_sweep(small(), tmp_path / "whole", region_size=2)
    # The mark is all that is missing, then that and an array.
    stopped(small(), tmp_path / "parts", 5, region_size=2)
    with (tmp_path / "parts" / store.DONE).open("r+b") as marks:
        marks.write(b"\0")
    (tmp_path / "parts" / store.RESULTS / "net_power" / "c" / "0" / "0").unlink()
    run_sweep(small(), tmp_path / "parts")
    assert bits(tmp_path / "parts") == bits(tmp_path / "whole")


def test_halves_of_files_that_a_killed_run_left_are_cleared_away(tmp_path: Path):
    stopped(small(), tmp_path / "a", 5, region_size=2)
    left = tmp_path / "a" / store.RESULTS / "net_power" / "c" / "0" / "0.1234.partial"
    left.write_bytes(b"half")
    assert run_sweep(small(), tmp_path / "a").n_finished == 12
    assert not left.exists()


def test_a_folder_whose_making_was_cut_short_is_made_anew(tmp_path: Path):
    run_sweep(small(), tmp_path / "a")
    (tmp_path / "a" / store.DONE).unlink()
    shutil.rmtree(tmp_path / "a" / store.RESULTS / "net_power")
    with pytest.raises(ValueError, match="`folder` must hold the results of a sweep"):
        open_sweep(tmp_path / "a")
    assert run_sweep(small(), tmp_path / "a").n_finished == 12


@pytest.mark.usefixtures("limit_case")
def test_a_run_that_blows_up_is_counted_and_has_no_numbers(tmp_path: Path):
    points = Grid(values={"water.normal_drag": [1.75, 1e3]})
    found = run_sweep(small(points=points, dt=0.1), tmp_path / "a")
    assert found.succeeded.to_numpy().tolist() == [True, False]
    for name in ("forward_velocity", "mechanical_power", "net_power", "cost_of_transport"):
        assert found[name].isnull().to_numpy().tolist() == [False, True]
    assert count_failed(tmp_path / "a") == 1
    assert len(best_points(tmp_path / "a")) == 1


# ---- what is refused -----------------------------------------------------------------------------


def test_the_folder_of_another_sweep_is_refused_with_the_difference(tmp_path: Path):
    run_sweep(small(), tmp_path / "a")
    before = bits(tmp_path / "a")
    for other, difference in (
        (small(duration=2.0), "duration is 1.0 there and 2.0 here"),
        (small(motion=replace(GAIT, offset=0.1)), "motion.offset is nothing there and 0.1 here"),
        (
            small(robot=lc.load_robot("mamba-fin")),
            "robot.name is mamba there and mamba-fin here; robot.caudal_fin is",
        ),
        (
            small(
                points=Grid(values={"gait.amplitude": [0.3, 0.5, 0.8], "water.normal_drag": DRAG})
            ),
            r"points.values.gait.amplitude\[2\] is 0.7 there and 0.8 here",
        ),
        (
            small(points=Rows(values={"gait.amplitude": [0.3]})),
            "points.kind is grid there and rows here",
        ),
    ):
        with pytest.raises(
            ValueError,
            match=rf"`folder` must be empty, or hold this sweep, got .* another.*{difference}",
        ):
            run_sweep(other, tmp_path / "a")
    assert bits(tmp_path / "a") == before


def test_a_folder_with_something_else_is_left_alone(tmp_path: Path):
    (tmp_path / "results.zarr").mkdir()
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(
        ValueError,
        match=r"`folder` must be empty, or hold this sweep, got .* with results.zarr, thesis.tex",
    ):
        run_sweep(small(), tmp_path)
    assert (tmp_path / "thesis.tex").read_text() == "years of work"
    with pytest.raises(ValueError, match="`folder` must be a folder, got the file"):
        run_sweep(small(), tmp_path / "thesis.tex")
    with pytest.raises(ValueError, match="`folder` must hold the results of a sweep"):
        open_sweep(tmp_path)


@pytest.mark.parametrize(
    ("points", "file", "word"),
    [
        (Grid(values={"gait.amplitude": [0.3, 0.5]}), "gait.amplitude/zarr.json", "gait.amplitude"),
        (Rows(values={"gait.amplitude": [0.3, 0.5]}), "zarr.json", "coordinates"),
    ],
)
def test_results_that_do_not_say_any_more_what_was_varied_are_refused(
    tmp_path: Path, points, file: str, word: str
):
    run_sweep(small(points=points), tmp_path)
    damaged = tmp_path / "results.zarr" / file
    damaged.write_text(damaged.read_text().replace(f'"{word}"', f'"{word[:-1]}?"'))
    with pytest.raises(ValueError, match=r"intact files, got .* with a damaged `results\.zarr/"):
        open_sweep(tmp_path)
    write_checksums(tmp_path, [*read_checksums(tmp_path)])  # as if it had been written so
    for read in (open_sweep, best_points):
        with pytest.raises(
            ValueError, match=r"readable `results\.zarr`, got .*`gait\.amplitude` is missing"
        ):
            read(tmp_path)


def test_results_are_refused_where_the_caller_wants_none(tmp_path: Path):
    run_sweep(small(), tmp_path / "a", resume=False)
    with pytest.raises(
        ValueError, match="`folder` must have no results yet unless `resume` is set"
    ):
        run_sweep(small(), tmp_path / "a", resume=False)


def test_two_processes_do_not_work_in_one_folder(tmp_path: Path):
    def again(done: int, total: int) -> None:
        with pytest.raises(
            ValueError, match="`folder` must be one that no other process is writing to"
        ):
            run_sweep(small(), tmp_path / "a")
        raise Stop

    with pytest.raises(Stop):
        run_sweep(small(), tmp_path / "a", progress=again)


def test_a_number_of_threads_that_cannot_be_is_refused():
    with pytest.raises(ValueError, match="`threads` must be a whole number >= 1, got 0"):
        run_sweep(small(), "nowhere", threads=0)


# ---- a full disk ---------------------------------------------------------------------------------


@pytest.fixture
def little_disk(tmp_path: Path):
    """A disk of 600 kB, where this may be mounted; skips otherwise."""
    place = tmp_path / "disk"
    place.mkdir()
    words = ["mount", "-t", "tmpfs", "-o", "size=600k", "tmpfs", str(place)]
    if shutil.which("mount") is None or subprocess.run(words, capture_output=True).returncode:
        pytest.skip("a disk cannot be mounted here")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def test_a_full_disk_costs_nothing_that_was_stored(little_disk: Path, tmp_path: Path):
    run_sweep(small(), tmp_path / "whole", region_size=2)
    folder, ballast = little_disk / "a", little_disk / "ballast"
    stopped(small(), folder, 5, region_size=2)
    with ballast.open("wb") as file, pytest.raises(OSError):
        while True:
            os.write(file.fileno(), b"0" * 4096)
    message = "the disk is full. Nothing that was stored is lost: 6 of 12 trials are stored; free some space and run"
    with pytest.raises(StorageFailed, match=message):
        run_sweep(small(), folder)
    assert open_sweep(folder).n_finished == 6
    ballast.unlink()
    run_sweep(small(), folder)
    assert bits(folder) == bits(tmp_path / "whole")


def test_a_disk_that_is_full_from_the_start_is_said_so(little_disk: Path):
    with (little_disk / "ballast").open("wb") as file, pytest.raises(OSError):
        while True:
            os.write(file.fileno(), b"0" * 4096)
    with pytest.raises(
        StorageFailed, match=r"the disk is full.*0 trials are stored; free some space"
    ):
        run_sweep(small(), little_disk / "a")
    (little_disk / "ballast").unlink()
    assert run_sweep(small(), little_disk / "a").n_finished == 12


@pytest.mark.parametrize("at", range(0, 30, 3))
def test_a_disk_may_be_full_at_any_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, at: int):
    # Not a real disk: the renaming of the file with this number fails, as it does on a full one.
    run_sweep(small(), tmp_path / "whole", region_size=4)
    count = 0
    real = os.replace

    def full(*files) -> None:
        nonlocal count
        count += 1
        if count > at:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        real(*files)

    with monkeypatch.context() as context:
        context.setattr(os, "replace", full)
        with pytest.raises(StorageFailed, match="the disk is full"):
            run_sweep(small(), tmp_path / "a", region_size=4)
    run_sweep(small(), tmp_path / "a", region_size=4)
    assert bits(tmp_path / "a") == bits(tmp_path / "whole")


# ---- the best ------------------------------------------------------------------------------------


def test_the_best_are_the_fastest_or_the_cheapest(tmp_path: Path):
    found = run_sweep(small(), tmp_path / "a", region_size=5)
    speeds = np.sort(found.forward_velocity.to_numpy(), axis=None)[::-1]
    fastest = best_points(tmp_path / "a", count=4)
    assert [point["forward_velocity"] for point in fastest] == speeds[:4].tolist()
    where = {name: fastest[0][name] for name in ("gait.amplitude", "water.normal_drag")}
    assert float(found.forward_velocity.sel(where)) == speeds[0]
    (cheapest,) = best_points(tmp_path / "a", "cost_of_transport", 1)
    assert cheapest["cost_of_transport"] == float(found.cost_of_transport.min())
    assert len(best_points(tmp_path / "a", count=100)) == 12
    assert count_failed(tmp_path / "a") == 0


def test_a_figure_that_an_older_sweep_does_not_store_is_refused_with_those_it_has(
    tmp_path: Path, monkeypatch
):
    run_sweep(small(), tmp_path / "a")
    unread = stored_sweep.open_unread(tmp_path / "a").drop_vars("speed_through_water")
    monkeypatch.setattr(stored_sweep, "open_unread", lambda folder: unread)
    with pytest.raises(
        ValueError,
        match=r"`quantity` must be stored in .*/a, got `speed_through_water`; "
        "this older sweep has `forward_velocity`",
    ):
        best_points(tmp_path / "a", "speed_through_water")


def test_what_the_robot_cannot_do_comes_last_if_that_is_asked_for(tmp_path: Path):
    amplitudes = Grid(values={"gait.amplitude": [1.9, 0.05, 1.7, 0.1, 1.5]})
    found = run_sweep(small(points=amplitudes, duration=4.0), tmp_path / "a", region_size=2)
    share = np.sort(found.utilization.to_numpy(), axis=None)
    n_beyond = int(np.sum(share > 1.0))
    assert 0 < n_beyond < share.size
    assert count_infeasible(tmp_path / "a") == n_beyond
    points = best_points(tmp_path / "a", count=100, feasible_first=True)
    is_beyond = [point["utilization"] > 1.0 for point in points]
    assert is_beyond == [False] * (share.size - n_beyond) + [True] * n_beyond
    for group in (points[:-n_beyond], points[-n_beyond:]):
        speeds = [point["forward_velocity"] for point in group]
        assert speeds == sorted(speeds, reverse=True)


def test_the_best_so_far_can_be_had_while_it_runs(tmp_path: Path):
    stopped(small(), tmp_path / "a", 5, region_size=2)
    assert len(best_points(tmp_path / "a", count=100)) == 6
    assert best_points(tmp_path / "a", "steady_velocity") == []  # these runs are too short for one


def test_what_the_best_are_best_in_must_exist(tmp_path: Path):
    run_sweep(small(), tmp_path / "a")
    with pytest.raises(ValueError, match=r"`quantity` must be one of .*did you mean `net_power`"):
        best_points(tmp_path / "a", "net_powr")
