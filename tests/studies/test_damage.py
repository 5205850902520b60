"""Damage to the folder of a sweep: it is named by whoever reads it, and made anew by whoever goes on."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from studies.sweeps import small

from laticauda.studies import Rows, best_points, count_failed, open_sweep, run_sweep, store
from laticauda.studies.checksums import CHECKSUMS
from laticauda.values import StoredResultsWarning


def bits(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file()
    }


def flip(file: Path, at: int = -7) -> None:
    content = bytearray(file.read_bytes())
    content[at] ^= 4
    file.write_bytes(content)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    run_sweep(small(), tmp_path / "a", region_size=4)
    return tmp_path / "a"


@pytest.fixture
def older_folder(folder: Path) -> Path:
    """As releases without checksums wrote it."""
    (folder / CHECKSUMS).unlink()
    (folder / store.DONE).write_bytes(b"\1\1\1")
    return folder


SPEED = "results.zarr/forward_velocity/c/1/0"
DAMAGED_REGION = (
    r"`folder` must hold intact results, got .* with damage to 1 of 3 regions \(points 1:2x0:4\); "
    "run the same sweep again, which makes anew what is damaged"
)
COMPUTED_ANEW = r"damage was noticed in 1 of 3 regions \(points 1:2x0:4\), which are computed anew"


@pytest.mark.parametrize(
    "damage",
    [
        lambda folder: flip(folder / SPEED),
        lambda folder: (folder / SPEED).write_bytes(b""),
        lambda folder: (folder / SPEED).unlink(),
        lambda folder: flip(folder / store.DONE, 1),
    ],
    ids=["a bit", "all of its bytes", "a file", "its mark"],
)
def test_a_damaged_region_is_named_and_computed_anew(folder: Path, damage: Callable[[Path], None]):
    whole = bits(folder)
    damage(folder)
    with pytest.raises(ValueError, match=DAMAGED_REGION):
        open_sweep(folder)
    with pytest.warns(StoredResultsWarning, match=COMPUTED_ANEW):
        run_sweep(small(), folder)
    assert bits(folder) == whole
    assert open_sweep(folder).n_finished == 12


def test_the_best_points_are_not_taken_from_a_damaged_region(folder: Path):
    flip(folder / SPEED)
    with pytest.raises(ValueError, match=r"`folder` must hold a readable `results\.zarr`"):
        best_points(folder)
    (folder / "results.zarr/succeeded/c/2/0").unlink()
    with pytest.raises(ValueError, match=r"damage to 1 of 3 regions \(points 2:3x0:4\)"):
        count_failed(folder)


@pytest.mark.parametrize(
    "name",
    [
        store.DEFINITION,
        CHECKSUMS,
        "results.zarr/zarr.json",
        "results.zarr/net_power/zarr.json",
        "results.zarr/gait.amplitude/c/0",
    ],
)
def test_a_damaged_file_is_named_and_made_anew(folder: Path, name: str):
    whole = bits(folder)
    flip(folder / name, at=20)
    with pytest.raises(ValueError, match=r"must hold intact files, got .* with a damaged `.*`"):
        open_sweep(folder)
    with pytest.warns(StoredResultsWarning, match=r"had been damaged, and was made anew"):
        run_sweep(small(), folder)
    assert bits(folder) == whole


def test_a_list_of_checksums_that_was_cut_short_is_noticed(folder: Path):
    file = folder / CHECKSUMS
    file.write_text(file.read_text().splitlines()[0] + "\n")
    with pytest.raises(ValueError, match=r"with a damaged `checksums\.sha256`"):
        open_sweep(folder)


def test_the_damaged_definition_of_another_sweep_stays(folder: Path):
    flip(folder / store.DEFINITION, at=20)
    damaged = bits(folder)
    with pytest.raises(ValueError, match=r"with a damaged `sweep\.json` that is not of this one"):
        run_sweep(small(duration=2.0), folder)
    assert bits(folder) == damaged


def test_points_of_a_list_are_guarded_like_results(tmp_path: Path):
    sweep = small(points=Rows(values={"gait.amplitude": [0.3, 0.5, 0.7]}))
    run_sweep(sweep, tmp_path, region_size=1)
    whole = bits(tmp_path)
    flip(tmp_path / "results.zarr/gait.amplitude/c/2")
    with pytest.raises(ValueError, match=r"damage to 1 of 3 regions \(points 2:3\)"):
        open_sweep(tmp_path)
    with pytest.warns(StoredResultsWarning, match=r"1 of 3 regions \(points 2:3\)"):
        run_sweep(sweep, tmp_path)
    assert bits(tmp_path) == whole


def test_results_without_checksums_are_opened_and_said_to_have_none(older_folder: Path):
    says = "its results are of an older release and have no checksums, so damage to them would"
    with pytest.warns(StoredResultsWarning, match=says) as told:
        assert open_sweep(older_folder).n_finished == 12
    assert len(told) == 1
    with pytest.warns(StoredResultsWarning, match=says) as told:
        assert run_sweep(small(), older_folder).n_finished == 12
    assert len(told) == 1


def test_the_checksums_are_those_of_sha256sum(folder: Path):
    lines = (folder / CHECKSUMS).read_text().splitlines()
    assert all(len(line.split("  ")[0]) == 64 for line in lines)
    names = {line.split("  ")[1] for line in lines}
    assert names >= {store.DEFINITION, "results.zarr/zarr.json", "results.zarr/succeeded/zarr.json"}
    codecs = json.loads((folder / "results.zarr/succeeded/zarr.json").read_text())["codecs"]
    assert codecs[-1]["configuration"]["checksum"] is True
