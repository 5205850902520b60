import math
import re

import pytest

from laticauda.trials.logs import load_column_map
from laticauda.values.errors import TrialFileError

PLACE = '[center_of_mass]\nposition = ["x", "y"]\n'
BODY = '[body]\nposition = ["x", "y"]\nyaw = "h"\n[joint_angle]\ncolumns = "phi {}"\n'


def refused(tmp_path, text: str) -> str:
    path = tmp_path / "map.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(TrialFileError) as caught:
        load_column_map(path)
    return str(caught.value)


def test_a_map_says_what_swam_and_how(tmp_path):
    gait = '[gait]\nkind = "eel-like"\namplitude_deg = 50\nfrequency_deg_s = 110\nphase_shift_deg = 40\n'
    path = tmp_path / "map.toml"
    path.write_text('kind = "columns"\nrobot = "mamba-fin"\n' + gait + PLACE, encoding="utf-8")
    found = load_column_map(path)
    assert found.robot.name == "mamba-fin"
    assert found.gait.kind == "eel_like"
    assert found.gait.amplitude == pytest.approx(math.radians(50.0))
    assert found.environment.name == "paper-eel"  # as a simulation of that gait would have it


def test_files_are_found_beside_the_map(tmp_path):
    (tmp_path / "own.toml").write_text(
        'kind = "robot"\nextends = "mamba"\nname = "own"\n', encoding="utf-8"
    )
    path = tmp_path / "map.toml"
    path.write_text(
        'kind = "columns"\nrobot = "own.toml"\nground = "viscous"\n' + PLACE, encoding="utf-8"
    )
    found = load_column_map(path)
    assert (found.robot.name, found.environment.name) == ("own", "viscous")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('kind = "robot"\n', 'key `kind`: must be "columns" here'),
        (
            'kind = "columns"\nformat = 9\n',
            "key `format`: must be 1 to 2, which this version of laticauda reads, got 9",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\nenvironment = 3\n',
            "key `environment`: is not known; the keys here are",
        ),
        ('kind = "columns"\n', "key `robot`: is missing; every column map needs it"),
        ('kind = "columns"\nrobot = 3\n', "key `robot`: must be a text, got 3"),
        (
            'kind = "columns"\nrobot = "mamba"\nwater = "still"\nground = "viscous"\n',
            "key `water`: must not be given with `ground`",
        ),
        ('kind = "columns"\nrobot = "mambo"\n', "did you mean `mamba`?"),
        (
            'kind = "columns"\nrobot = "mamba"\nspeed = 1\n',
            "key `speed`: is not known; the keys here are",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\nstart = 3\nstop = 2\n',
            "key `stop`: must be > `start` = 3 s, got 2",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\nsmoothing = 0\n',
            "key `smoothing`: must be > 0 s, got 0",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\ndecimal = ";"\n',
            "key `decimal`: must be one of `.`, `,`, got ';'",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n[gait]\nkind = "eel"\n',
            "key `gait.amplitude`: is missing",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + PLACE + BODY,
            "key `body`: must not be given beside `center_of_mass`",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + BODY.split("[joint")[0],
            "key `joint_angle`: must be given with `body`: one link does not say where the others are",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + BODY.replace('yaw = "h"', ""),
            "key `body.yaw`: must be given, or `quaternion` or `rotation`, exactly one",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + PLACE + 'length_unit = "inch"\n',
            "key `center_of_mass.length_unit`: must be one of `m`, `cm`, `mm`, got 'inch'",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + PLACE.replace('["x", "y"]', '"x"'),
            "key `center_of_mass.position`: must be a list of 2 or 3 texts, got 'x'",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + BODY.replace("phi {}", "phi"),
            "key `joint_angle.columns`: must be a list of names, or hold {} for the number, got 'phi'",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + BODY + 'unit = "turns"\n',
            "key `joint_angle.unit`: must be one of `rad`, `deg`, got 'turns'",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + PLACE + '[frame]\nx = "x"\ny = "-x"\n',
            "key `frame.y`: must be a different axis from `x` = 'x', got '-x'",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + PLACE + '[power]\ncurrent = "I"\n',
            "key `power.column`: must be given, or `current` and `voltage`, but not both",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\n' + PLACE + '[time]\ncolumn = "t"\nrate = 10\n',
            "key `time.rate`: must not be given beside `column`, got 10",
        ),
        (
            'kind = "columns"\nrobot = "mamba"\nsignals = 3\n',
            "key `signals`: must be a table of names of columns, got 3",
        ),
        ("kind = columns", "map.toml: is not valid TOML: Invalid value"),
    ],
)
def test_a_map_with_a_mistake_is_refused_with_its_key(tmp_path, text, message):
    assert re.search(re.escape(message), refused(tmp_path, text)), refused(tmp_path, text)


def test_a_map_that_is_not_there_is_said(tmp_path):
    with pytest.raises(TrialFileError, match=r"none.toml: no such file"):
        load_column_map(tmp_path / "none.toml")
