import json
from pathlib import Path

import pytest

from laticauda.robot import (
    Robot,
    current_names,
    from_toml,
    ground_names,
    load_current,
    load_ground,
    load_parameters,
    load_robot,
    load_water,
    parameter_names,
    robot_names,
    to_toml,
    water_names,
)
from laticauda.values.extensions import name_of

ALL = {
    **{name: load_robot(name) for name in robot_names()},
    **{name: load_water(name) for name in water_names()},
    **{name: load_ground(name) for name in ground_names()},
}


def test_all_presets_are_listed(run):
    done = run("robots")
    assert done.status == 0
    assert all(name in done.out for name in ALL)
    lines = done.out.split("\n\n")[0].splitlines()
    assert lines[0].split()[:3] == ["name", "links", "joints"]
    assert [line.split()[0] for line in lines[1:]] == list(robot_names())
    assert any("mamba-fin" in line and "  yes  " in line for line in lines)
    assert "length [m]" in done.out


def test_the_list_can_be_read_by_a_program(run):
    found = json.loads(run("robots --json").out)
    assert [robot["name"] for robot in found["robots"]] == list(robot_names())
    assert found["waters"] == list(water_names())
    assert found["grounds"] == list(ground_names())
    assert found["parameters"] == list(parameter_names())


@pytest.mark.parametrize("name", ALL)
def test_a_preset_can_be_shown(run, name):
    assert name in run(f"robots {name}").out


@pytest.mark.parametrize("name", ALL)
def test_the_printed_toml_is_the_preset(run, name):
    assert from_toml(run(f"robots {name} --toml").out) == ALL[name]


@pytest.mark.parametrize("name", ALL)
def test_a_preset_can_be_read_by_a_program(run, name):
    found = json.loads(run(f"robots {name} --json").out)
    assert found["name"] == name
    if isinstance(ALL[name], Robot):
        assert found["mass"] == ALL[name].mass


@pytest.mark.parametrize("name", current_names())
def test_currents_are_listed_and_shown_and_can_be_saved(run, folder: Path, name):
    assert f"\n{name} " in run("robots").out
    assert name in json.loads(run("robots --json").out)["currents"]
    flow = load_current(name)
    assert flow.words in run(f"robots {name}").out
    (folder / "mine.toml").write_text(run(f"robots {name} --toml").out)
    assert load_current("mine.toml") == flow
    assert json.loads(run("robots mine.toml --json").out)["kind"] == name_of(type(flow))


@pytest.mark.parametrize("name", parameter_names())
def test_presets_of_parameters_are_listed_and_shown_and_can_be_saved(run, folder: Path, name):
    assert name in run("robots").out
    (folder / "mine.toml").write_text(run(f"robots {name} --toml").out)
    assert load_parameters("mine.toml") == load_parameters(name)
    assert json.loads(run("robots mine.toml --json").out)["name"] == name


def test_a_file_can_be_shown(run, folder: Path):
    (folder / "my.toml").write_text(to_toml(load_robot("mamba", n_links=5)))
    assert json.loads(run("robots my.toml --json").out)["n_links"] == 5
