"""What a mission must have before it runs: defined kinds, the sensors of its table, phases that end."""

import re

import pytest

from laticauda.missions import Phase, Rest, load_mission
from laticauda.missions.files import PRESETS
from laticauda.sensing import Dock

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
    ],
)
def test_a_mission_that_could_not_do_what_its_table_says_is_refused(tmp_path, old, new, message):
    with pytest.raises(ValueError, match=re.escape(message)) as caught:
        load_changed(tmp_path, old, new)
    assert str(caught.value).startswith(str(tmp_path / "changed.toml"))


def test_a_time_limit_and_the_phase_after_it_belong_together():
    with pytest.raises(ValueError, match=r"`time_limit` must be left out, or `late` must name"):
        Phase(name="wait", behaviour=Rest(), time_limit=3.0)
    with pytest.raises(ValueError, match=r"`late` must be given together with `time_limit`"):
        Phase(name="wait", behaviour=Rest(), late="rest")


def test_a_funnel_may_be_straight_but_not_widen_inward():
    assert Dock(name="dock", throat=1.0, mouth=1.0).throat == 1.0
    with pytest.raises(ValueError, match=r"`throat` must be at most the mouth, 1 m, got 2 m"):
        Dock(name="dock", throat=2.0, mouth=1.0)
