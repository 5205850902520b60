import json
from pathlib import Path

import pytest

from laticauda.cli.command import Command, Outcome, until_stopped
from laticauda.cli.flags import NetCdf, Picture
from laticauda.errors import BadArgument
from laticauda.quantities import option, value


@value
class Part:
    """A part of it."""

    plot: Picture = option("Draw it", default=None)


@value
class Count(Command):
    """Count."""

    part: Part = option("A part", default=Part())
    save: NetCdf = option("Keep it", default=None)
    fails: bool = option("Whether it fails", default=False)

    def run(self) -> Outcome:
        """Count."""
        Path("ran").touch()
        problem = "too much" if self.fails else ""
        return Outcome(facts={"n": 3}, text="three", problem=problem, succeeded=not self.fails)


@value
class Weigh(Command):
    """Weigh."""

    robot: str = option("A preset or a TOML file", default="mamba")
    name: str = option("What to call it", default="it")


def test_every_field_of_a_command_from_elsewhere_is_a_flag():
    found = Weigh.read(["--robot", "chain", "--name", "x"], "weigh")
    assert (found.robot, found.name) == ("chain", "x")


def test_an_outcome_is_text_or_one_json_object_and_a_status(folder: Path, capsys: pytest.CaptureFixture[str]):
    assert Count()() == 0
    assert capsys.readouterr() == ("three\n", "")
    assert Count(json=True, fails=True)() == 1
    out, err = capsys.readouterr()
    assert json.loads(out) == {"n": 3}
    assert err == "too much\n"


@pytest.mark.parametrize(
    ("command", "name"), [(Count(save="a.txt"), "save"), (Count(part=Part(plot="no/a.png")), "plot")]
)
def test_files_that_cannot_be_written_are_refused_before_the_work(folder: Path, command: Count, name: str):
    with pytest.raises(BadArgument) as refused:
        command()
    assert refused.value.name == name
    assert not (folder / "ran").exists()


def test_a_server_ends_well_by_ctrl_c_and_is_closed(capsys: pytest.CaptureFixture[str]):
    closed: list[bool] = []
    with until_stopped(lambda: closed.append(True)):
        raise KeyboardInterrupt
    assert closed == [True]
    assert capsys.readouterr().err == "stopped.\n"
