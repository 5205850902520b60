"""Files of the first layout, written before the state was an attribute: they load as they were."""

from pathlib import Path

import numpy as np
import pytest

from laticauda.logs import load_trial
from laticauda.trial import Trial

OLDER = Path(__file__).parent.parent / "data" / "trials-0.1.0"
LIBRARIES = {"mcap": "mcap", "parquet": "pyarrow", "mat": "scipy"}


@pytest.fixture(scope="module")
def kept() -> Trial:
    return load_trial(OLDER / "trial.nc")


def test_an_older_trial_has_everything_that_was_in_it(kept):
    assert kept.robot.name == "odd one"
    assert kept.robot.caudal_fin is not None
    assert kept.gait.envelope.values == (0.1, 1 / 3, 1e-300)
    assert kept.environment.name == "paper-eel"
    assert (kept.settings["dt"], kept.settings["bandwidth"], kept.settings.get("seed")) == (0.02, np.inf, None)
    assert kept.status == "The joints jumped at 0.5 s. Try a smaller gain: ½ of it."
    assert not kept.succeeded
    assert list(kept.link_force) == ["drag", "effector"]
    assert np.signbit(kept.signals["of_ones_own"]).all()
    assert kept.state["time"] == 0.1 + 0.2
    assert kept.state["locked"].tolist() == [True, False]
    assert kept.state["count"].dtype == np.int32
    assert kept.state["nothing"].shape == (0, 3)
    assert np.isnan(kept.state["lost"][0])


@pytest.mark.parametrize("ending", LIBRARIES)
def test_an_older_trial_is_the_same_in_every_format(kept, ending):
    pytest.importorskip(LIBRARIES[ending])
    assert load_trial(OLDER / f"trial.{ending}").equals(kept)


def test_older_simulations_load_with_the_state_from_which_they_go_on(tmp_path):
    trial = load_trial(OLDER / "planar.nc")
    assert trial.state
    trial.save(tmp_path / "run.nc")
    assert load_trial(tmp_path / "run.nc").equals(trial)
    pytest.importorskip("mcap")
    assert load_trial(OLDER / "spatial.mcap").center_of_mass.shape[1] == 3
