"""What a mission must have before it runs: defined kinds, the sensors of its table, phases that end."""

import re
from dataclasses import replace

import pytest

from laticauda.missions import Phase, Rest, load_mission, run_missions
from laticauda.missions.files import PRESETS
from laticauda.sensing import Dock
from laticauda.values import ImplausibleWarning

SONAR_SILENT = 'sensor = "sonar", longer_than'


def load_changed(folder, old, new):
    """Load net-inspection with a change of its text."""
    text = (PRESETS / "net-inspection.toml").read_text()
    assert old in text
    path = folder / "changed.toml"
    path.write_text(text.replace(old, new, 1))
    return load_mission(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            '"swim-straight"',
            '"swim-strait"',
            "`controller.phases[0].behaviour.kind`: must be one of `follow-wall`, ",
        ),
        ('"battery-low"', '"battery-lo"', "got 'battery-lo'; did you mean `battery-low`?"),
        ('"compass"', '"compas"', "`model.sensors[1].kind`: must be one of `acoustic-position`, "),
        ('kind = "net"', 'kind = "nett"', "`model.places[0].kind`: must be one of `buoy`, `dock`"),
        (
            SONAR_SILENT,
            SONAR_SILENT.replace("sonar", "sonnar"),
            "`controller.phases[1].transitions[0].when`: needs the sensor `sonnar`, which is not among those "
            "of `model.sensors`: `sonar`, ",
        ),
        (
            'kind = "battery-gauge"',
            'kind = "battery-gauge"\nname = "cell"',
            "`controller.always[0].when`: needs the sensor `battery`",
        ),
        (
            'kind = "sonar"',
            'kind = "sonar"\nname = "echo"',
            "`controller.phases[1].behaviour`: needs the sensor `sonar`",
        ),
        (
            "mouth = 2.4",
            "mouth = 0.5",
            "`model.places[1].throat`: must be at most the mouth, 0.5 m",
        ),
        (
            "navigation]\nbeams_deg = [-120",
            "navigation]\nbeams_deg = [-119",
            "`controller.navigation.beams_deg`: must be those of the sensor `sonar` in the same order, "
            "got -119 where it has -120",
        ),
        (
            "navigation]\nbeams_deg = [-120, ",
            "navigation]\nbeams_deg = [",
            "`controller.navigation.beams_deg`: must be those of the sensor `sonar` in the same order, "
            "21 of them, got 20",
        ),
        (
            "avoids = false",
            "avoids = false\ndepth = 0.8",
            "`controller.phases[0].depth`: must be left out for a robot without pitch joints, got 0.8 m for "
            "`mamba-fin`",
        ),
    ],
)
def test_a_mission_that_could_not_do_what_its_table_says_is_refused(tmp_path, old, new, message):
    with pytest.raises(ValueError, match=re.escape(message)) as caught:
        load_changed(tmp_path, old, new)
    assert str(caught.value).startswith(str(tmp_path / "changed.toml"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'robot = "mamba-fin"\nparameters = "mamba-identified"',
            'robot = "amphibot"',
            "`controller.navigation.body_length` is 1.62 m, but `amphibot` is 0.6755 m long",
        ),
        (
            'kind = "acoustic-position"',
            'kind = "acoustic-position"\nbeacon = [1.0, 2.0, 0.0]',
            "`controller.navigation.beacon` is (0, 0) m, but the beacon of the sensor `beacon` is at (1, 2) m",
        ),
        (
            "frequency_deg_s = 210",
            "frequency = 210",
            "`frequency` of 210 rad/s is 33.4 cycles per second; did you mean frequency_deg_s=210?",
        ),
    ],
)
def test_what_a_mission_believes_wrongly_is_said_once_before_it_runs(tmp_path, old, new, message):
    scenario = replace(load_changed(tmp_path, old, new), duration=0.5)
    with pytest.warns(ImplausibleWarning) as warnings:
        run_missions([scenario, scenario])
    assert [message in str(warning.message) for warning in warnings] == [True]


def test_a_controller_that_is_no_mission_is_named(tmp_path):
    with pytest.raises(ValueError, match="got one of the kind `misson`, which is not known"):
        load_changed(tmp_path, 'kind = "mission"', 'kind = "misson"')


def test_a_time_limit_and_the_phase_after_it_belong_together():
    with pytest.raises(ValueError, match=r"`time_limit` must be left out, or `late` must name"):
        Phase(name="wait", behaviour=Rest(), time_limit=3.0)
    with pytest.raises(ValueError, match=r"`late` must be given together with `time_limit`"):
        Phase(name="wait", behaviour=Rest(), late="rest")


def test_a_funnel_may_be_straight_but_not_widen_inward():
    assert Dock(name="dock", throat=1.0, mouth=1.0).throat == 1.0
    with pytest.raises(ValueError, match=r"`throat` must be at most the mouth, 1 m, got 2 m"):
        Dock(name="dock", throat=2.0, mouth=1.0)
