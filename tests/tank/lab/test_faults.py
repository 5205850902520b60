import re

import pytest
from hypothesis import given, strategies as st

from laticauda.tank.lab import KINDS, Fault, FaultFileError, Faults, fault_from_words, load_faults


def test_a_schedule_is_read(tmp_path):
    file = tmp_path / "faults.toml"
    file.write_text(
        '[[faults]]\nkind = "leak"\ntime = 3.0\nnode = 5\n[[faults]]\nkind = "body_lost"\nduration = 1\n'
    )
    assert load_faults(file) == (
        Fault(kind="leak", time=3.0, node=5),
        Fault(kind="body_lost", duration=1.0),
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("fault = 1", "key `fault`: is not known; did you mean `faults`?"),
        ("faults = 1", "key `faults`: must be a list of tables, got 1"),
        ("[[faults]]\ntime = 1", "key `faults[0].kind`: is missing; every Fault needs it"),
        ('[[faults]]\nkind = "leek"', "did you mean `leak`?"),
        (
            '[[faults]]\nkind = "leak"\nnodes = 1',
            "key `faults[0].nodes`: is not known; did you mean `node`?",
        ),
        (
            '[[faults]]\nkind = "leak"\nnode = 20',
            "key `faults[0].node`: must be between 0 and 19, got 20",
        ),
        (
            '[[faults]]\nkind = "body_lost"\nnode = 1',
            "`faults[0].node`: must be left out for `body_lost`, got 1",
        ),
        ('[[faults]]\nkind = "leak"\ntime = -1', "`faults[0].time`: must be >= 0 s, got -1"),
        (
            '[[faults]]\nkind = "frame_loss"\nshare = 2',
            "`faults[0].share`: must be between 0 and 1, got 2",
        ),
        ("[[faults", "is not valid TOML"),
    ],
)
def test_a_wrong_schedule_says_where(tmp_path, text, message):
    file = tmp_path / "faults.toml"
    file.write_text(text)
    with pytest.raises(FaultFileError, match=re.escape(message)) as error:
        load_faults(file)
    assert str(error.value).startswith(str(file))


def test_a_file_that_is_not_there_is_said():
    with pytest.raises(FaultFileError, match=r"nowhere\.toml: no such file"):
        load_faults("nowhere.toml")


@given(text=st.text())
def test_any_line_is_a_fault_or_a_value_error(text):
    try:
        assert fault_from_words(text, 1.0).kind in KINDS
    except ValueError:
        pass


def test_a_fault_is_on_from_its_time_for_its_duration_at_its_node():
    faults = Faults(
        [Fault(kind="leak", time=1.0, duration=2.0, node=3), Fault(kind="bus_off", time=2.0)]
    )
    found = []
    for time in (0.0, 1.0, 2.5, 3.0):
        faults.look(time)
        found.append(
            (
                faults.on("leak", 3) is not None,
                faults.on("leak", 4) is not None,
                bool(faults.present),
            )
        )
    assert found == [
        (False, False, False),
        (True, False, True),
        (True, False, True),
        (False, False, True),
    ]
    assert faults.on("bus_off", 17) is not None
