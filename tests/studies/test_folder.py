import json
from pathlib import Path

import pytest
from studies.sweeps import small

from laticauda.studies import open_sweep, run_sweep, store
from laticauda.studies.checksums import CHECKSUMS
from laticauda.studies.folder import as_stored
from laticauda.values import StoredResultsWarning


def test_a_sweep_that_an_older_release_began_can_be_read_and_is_not_gone_on_with(tmp_path: Path):
    run_sweep(small(), tmp_path)
    file = tmp_path / store.DEFINITION
    definition = json.loads(file.read_text())
    del definition["format"]  # as they were when no definition held a scenario
    file.write_text(json.dumps(definition))
    (tmp_path / CHECKSUMS).unlink()
    with pytest.warns(StoredResultsWarning, match="have no checksums"):
        assert open_sweep(tmp_path).n_finished == 12
    with pytest.raises(
        ValueError, match=r"another release of laticauda: use another folder, .* still be read"
    ):
        run_sweep(small(), tmp_path)


def test_a_job_that_no_file_can_hold_is_refused():
    with pytest.raises(
        ValueError, match=r"`scenario` must be one that a file can hold: .* function"
    ):
        as_stored({"law": lambda: None})
