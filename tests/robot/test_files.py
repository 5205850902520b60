import pickle
import re
import tomllib
from dataclasses import replace

import pytest
from hypothesis import given
from robot.strategies import grounds, robots, waters

from laticauda.robot import (
    Joint,
    Robot,
    RobotNotFound,
    Water,
    current_names,
    from_toml,
    load_current,
    load_robot,
    load_water,
    robot_names,
    to_toml,
)
from laticauda.values.errors import LaticaudaError, RobotFileError
from laticauda.water.fluid.flow import Flow

ROBOT = """\
kind = "robot"
name = "test"

[[modules]]
count = 3
length = 0.18
mass = 0.8
section = { half_height = 0.055, half_width = 0.05 }

[[joints]]
count = 2
limit_deg = 90

[[thrusters]]
link = 0
thrust = 5.0
"""
WATER = """\
kind = "water"
tangential_friction = 0.3
normal_drag = 1.75
added_mass = 1.5
"""
FIN = "\n[caudal_fin]\nlength = 0.5\n"


@given(robots() | waters() | grounds)
def test_what_is_written_is_read_back_equal(thing):
    assert from_toml(to_toml(thing)) == thing
    assert from_toml(to_toml(thing), type(thing)) == thing


@given(robots())
def test_writing_is_settled_after_one_round(robot):
    assert to_toml(from_toml(to_toml(robot))) == to_toml(robot)


@given(robots())
def test_a_planar_reduction_can_be_written_too(robot):
    assert from_toml(to_toml(robot.planar())) == robot.planar()


@pytest.mark.parametrize("name", robot_names())
def test_equal_modules_and_joints_are_written_once(name):
    robot = load_robot(name)
    table = tomllib.loads(to_toml(robot))
    assert len(table["modules"]) == len(set(robot.modules))
    assert len(table["joints"]) == 1


def test_the_alternating_axes_are_written_as_they_are_by_hand():
    (joints,) = tomllib.loads(to_toml(load_robot("mamba-modules")))["joints"]
    assert (joints["count"], joints["axis"], joints["limit_deg"]) == (18, ["yaw", "pitch"], 90.0)


def test_defaults_other_than_zero_are_written_too():
    (joints,) = tomllib.loads(to_toml(load_robot("mamba")))["joints"]
    assert joints["actuator"]["stall_torque"] == 2.9
    assert "friction_torque" not in joints["actuator"]


def test_angles_may_be_given_in_degrees_or_radians():
    for line in ("limit_deg = 90", "limit = 1.5707963267948966"):
        assert from_toml(ROBOT.replace("limit_deg = 90", line), Robot).joints[0] == Joint()


def test_a_list_of_axes_repeats_and_needs_no_count():
    for lines in ('axis = ["yaw", "pitch"]', 'count = 2\naxis = ["yaw", "pitch"]'):
        robot = from_toml(ROBOT.replace("count = 2", lines), Robot)
        assert [joint.axis for joint in robot.joints] == ["yaw", "pitch"]


def test_a_file_that_begins_with_a_byte_order_mark_is_read(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_bytes(b"\xef\xbb\xbf" + ROBOT.encode())
    assert load_robot(path) == load_robot(str(path)) == from_toml(path) == from_toml(ROBOT)


def test_a_file_may_extend_a_preset():
    robot = from_toml('kind = "robot"\nextends = "mamba"\nname = "mine"\n' + FIN, Robot)
    assert (robot.name, robot.description) == ("mine", "")
    assert (robot.modules, robot.joints) == (
        load_robot("mamba").modules,
        load_robot("mamba").joints,
    )
    assert robot.caudal_fin.length == 0.5


def test_a_file_may_extend_another_beside_it(tmp_path):
    (tmp_path / "base.toml").write_text(WATER, encoding="utf-8")
    (tmp_path / "tidal.toml").write_text(
        'kind = "water"\nextends = "base.toml"\nname = "tidal"\ncurrent = [0, 1]\n',
        encoding="utf-8",
    )
    assert load_water(tmp_path / "tidal.toml") == Water(
        name="tidal", tangential_friction=0.3, normal_drag=1.75, added_mass=1.5, current=(0.0, 1.0)
    )


@pytest.mark.parametrize(
    "flow", [*map(load_current, current_names()), load_current("vortex") + load_current("street")]
)
def test_a_flow_goes_through_a_file(flow):
    assert from_toml(to_toml(flow)) == flow
    assert from_toml(to_toml(flow), Flow) == flow


def test_a_current_of_a_water_may_be_a_preset_or_a_file_beside_it_which_may_extend_another(
    tmp_path,
):
    (tmp_path / "mine.toml").write_text(
        'kind = "lamb-oseen"\nextends = "vortex"\nx = 4\n', encoding="utf-8"
    )
    (tmp_path / "water.toml").write_text(f'{WATER}\ncurrent = "mine.toml"\n', encoding="utf-8")
    vortex = load_current("vortex")
    assert load_water(tmp_path / "water.toml").current == replace(vortex, x=4.0)
    assert from_toml(WATER + '\ncurrent = "vortex"\n').current == vortex
    assert from_toml(WATER + '\ncurrent = "turbulence"\n').current == load_current("turbulence")
    assert (
        from_toml(WATER + '\ncurrent = "karman-street"\n').current == Flow.named("karman-street")()
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('kind = "water"', r'must be one of "lamb-oseen", .*, got \'water\''),
        ('kind = "vortx"', r"must be one of .*, got 'vortx'"),
        ("core = 1", "key `kind`: is missing; it must be one of .*"),
        (
            'kind = "lamb-oseen"\ncore = 1',
            "key `circulation`: is missing; every LambOseen needs it",
        ),
        (
            'kind = "lamb-oseen"\nextends = "vortx"',
            "there is no current preset named `vortx`; did you mean `vortex`",
        ),
        ('kind = "turbulence"\nextends = "vortex"', "key `circulation`: is not known"),
        ('kind = "lamb-oseen"\ncirculation = 1\ncore = -1', "key `core`: must be > 0 m, got -1"),
    ],
)
def test_a_current_that_is_none_is_refused_by_its_key(text, message, tmp_path):
    path = tmp_path / "current.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RobotFileError, match=message):
        load_current(path)


# Each changes ROBOT in one place; the message has the key and then the rule with the value.
BAD_EDITS = [
    ("mass = 0.8", "mass = -1.0", "modules[0].mass", r"must be > 0 kg, got -1\.0"),
    ("mass = 0.8", 'mass = "0.8"', "modules[0].mass", r"must be a number in kg, got '0\.8'"),
    ("mass = 0.8", "mass = nan", "modules[0].mass", "must be a finite number in kg, got nan"),
    ("mass = 0.8", "mass = 1e400", "modules[0].mass", "must be a finite number in kg, got inf"),
    ("mass = 0.8", "mass = true", "modules[0].mass", "must be a number in kg, got True"),
    ("mass = 0.8", "mass = [0.8]", "modules[0].mass", r"must be a number in kg, got \[0\.8\]"),
    (
        "mass = 0.8",
        "mass = 1979-05-27",
        "modules[0].mass",
        "must be a number in kg, got datetime.*",
    ),
    ("mass = 0.8", "mas = 0.8", "modules[0].mas", r"is not known; did you mean `mass`\?"),
    (
        "mass = 0.8",
        "mass = 0.8\ncolor = 3",
        "modules[0].color",
        "is not known; the keys here are length, mass, .*",
    ),
    ("mass = 0.8\n", "", "modules[0].mass", "is missing; every Module needs it"),
    ("count = 3", "count = 0", "modules[0].count", "must be a whole number from 1 to 1000, got 0"),
    (
        "count = 3",
        "count = 10000000000",
        "modules[0].count",
        "must be a whole number from 1 to 1000, got 10000000000",
    ),
    (
        "count = 3",
        "count = 2.5",
        "modules[0].count",
        r"must be a whole number from 1 to 1000, got 2\.5",
    ),
    (
        "count = 3",
        "count = true",
        "modules[0].count",
        "must be a whole number from 1 to 1000, got True",
    ),
    (
        "count = 2",
        "count = 4",
        "joints",
        "must hold one Joint fewer than there are modules, 2 for 3 modules, got 4",
    ),
    (
        "half_width = 0.05",
        "half_width = 0",
        "modules[0].section.half_width",
        "must be > 0 m, got 0",
    ),
    (
        "{ half_height = 0.055, half_width = 0.05 }",
        "3",
        "modules[0].section",
        "must be a table, got 3",
    ),
    (
        "limit_deg = 90",
        "limit_deg = 360",
        "joints[0].limit_deg",
        "must be between 0 and 180 deg, got 360",
    ),
    (
        "limit_deg = 90",
        'limit_deg = "90"',
        "joints[0].limit_deg",
        "must be a number in deg, got '90'",
    ),
    (
        "limit_deg = 90",
        "limit_deg = 90\nlimit = 1.5",
        "joints[0].limit_deg",
        "must not be given together with `lim.*",
    ),
    (
        "limit_deg = 90",
        "limit_degrees = 90",
        "joints[0].limit_degrees",
        "is not known; did you mean `limit_deg`.*",
    ),
    (
        "limit_deg = 90",
        'axis = "roll"',
        "joints[0].axis",
        "must be one of `yaw`, `pitch`, got 'roll'",
    ),
    (
        "limit_deg = 90",
        "axis = []",
        "joints[0].axis",
        "must be a text or a list of 1 to `count` = 2 texts, got 0",
    ),
    (
        "limit_deg = 90",
        'axis = ["yaw", "yaw", "yaw"]',
        "joints[0].axis",
        "must be a text or a list .*, got 3",
    ),
    ("limit_deg = 90", "axis = [1]", "joints[0].axis", "must be one of `yaw`, `pitch`, got 1"),
    (
        "limit_deg = 90",
        "actuator = { voltage = 0 }",
        "joints[0].actuator.voltage",
        "must be > 0 V, got 0",
    ),
    ("link = 0", "link = 3", "thrusters[0].link", r"must be 0 \(tail\) to 2 \(head\), got 3"),
    ("link = 0", "link = 0.0", "thrusters[0].link", r"must be a whole number >= 0, got 0\.0"),
    (
        "link = 0",
        "link = 0\nangle_deg = inf",
        "thrusters[0].angle_deg",
        "must be a finite number in deg, got inf",
    ),
    (
        "[[thrusters]]",
        "[thrusters]",
        "thrusters",
        r"must be a list of tables, got \{'link': 0, 'thrust': 5\.0\}",
    ),
    ("[[thrusters]]", "[[thruster]]", "thruster", r"is not known; did you mean `thrusters`\?"),
    ('name = "test"\n', "", "name", "is missing; every Robot needs it"),
    ('name = "test"', "name = 3", "name", "must be a text, got 3"),
    (
        'name = "test"',
        "name = ' '",
        "name",
        "must be a text on one line that is not blank, got ' '",
    ),
    (
        "[[thr",
        "[caudal_fin]\nlength = 0.1\n[[thr",
        "caudal_fin.opening_length",
        r"must be < 0\.1 m, the .* got 0\.12",
    ),
    (
        "[[thr",
        "[tether]\nforce = [1]\n[[thr",
        "tether.force",
        r"must be two numbers in N, got 1 of them",
    ),
    (
        "[[thr",
        "[tether]\nforce = [0, inf]\n[[thr",
        "tether.force[1]",
        "must be a finite number in N, got inf",
    ),
    ('kind = "robot"', 'kind = "water"', "kind", "must be \"robot\" here, got 'water'"),
    (
        'kind = "robot"',
        'kind = "robto"',
        "kind",
        r"must be one of .*, got 'robto'; did you mean `robot`\?",
    ),
    ('kind = "robot"', "kind = 3", "kind", "must be one of .*, got 3"),
    ('kind = "robot"', "", "kind", 'is missing; it must be one of "robot", "water", "ground"'),
    ("kind", "extends = 3\nkind", "extends", "must be the name of a preset or a path, got 3"),
    (
        "kind",
        'extends = "manba"\nkind',
        "extends",
        "there is no robot preset named `manba`; did you mean `mamba`.*",
    ),
    (
        "kind",
        'extends = "me.toml"\nkind',
        "extends",
        "must not lead back to a file that extends it, got 'me.toml'",
    ),
]
BAD_TEXTS = [
    ("kind = ", "is not valid TOML: Invalid value"),
    ("kind = robot", r"is not valid TOML: Invalid value \(at line 1, column 8\)"),
    (ROBOT + "\n[[joints]\n", r"is not valid TOML: .*\(at line 18, column \d+\)"),
    (
        ROBOT.replace("[[joints]]", "mass = 1\n[[joints]]"),
        "is not valid TOML: Cannot overwrite a value",
    ),
    ("x = " + "[" * 5000, "is not valid TOML"),
    ("x = " + "1" * 5000, "is not valid TOML"),
    ("", "key `kind`: is missing"),
    ('kind = "robot"\nname = "x"', r"key `modules`: is missing; every Robot needs it$"),
    (
        'kind = "robot"\nname = "x"\nmodules = []',
        r"key `modules`: must hold at least one Module, got none$",
    ),
    ('kind = "robot"\nname = "x"\nmodules = [3]', r"key `modules\[0\]`: must be a table, got 3$"),
]


def refused(text, message, folder):
    path = folder / "me.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RobotFileError, match=message) as caught:
        load_robot(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert isinstance(caught.value, LaticaudaError)
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize(("old", "new", "key", "rule"), BAD_EDITS)
def test_a_bad_file_is_refused_with_file_key_rule_and_value(old, new, key, rule, tmp_path):
    assert old in ROBOT
    refused(ROBOT.replace(old, new, 1), f"me.toml: key `{re.escape(key)}`: {rule}$", tmp_path)


@pytest.mark.parametrize(("text", "message"), BAD_TEXTS, ids=range(len(BAD_TEXTS)))
def test_a_file_that_is_hardly_one_is_refused(text, message, tmp_path):
    refused(text, message, tmp_path)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("currnet = [0, 0]", r"key `currnet`: is not known; did you mean `current`\?$"),
        (
            "linear_drag = 1",
            r"key `drag\.linear`: must be true or false, got 1$",
        ),  # as older files have it
        (
            'drag = "polynominal-drag"',
            r"key `drag\.kind`: must be one of .*; did you mean `polynomial-drag`\?$",
        ),
        (
            'drag = {kind = "polynomial-drag", linera = true}',
            r"key `drag\.linera`: is not known; did you mean `linear`\?$",
        ),
        ("drag = 3", r"key `drag`: must be a table, got 3$"),
        (
            'added_mass_form = "kirchoff"',
            r"key `added_mass_form`: must be one of .*; did you mean `kirchhoff`\?$",
        ),
        (
            'trailing_edge = "elongated"',
            r"key `trailing_edge`: must be `none` unless `added_mass_form` is `kirchhoff`",
        ),
        ("depth = -1", r"key `depth`: must be > 0 m, got -1$"),
        (
            "current = 0.1",
            r"key `current`: must be two or three numbers in m/s or a Flow, got 0\.1$",
        ),
    ],
)
def test_a_bad_water_is_refused_in_the_same_way(line, message):
    with pytest.raises(RobotFileError, match="<text>: " + message):
        from_toml(WATER + line)


def test_a_fault_of_the_extended_file_is_told_with_that_files_name(tmp_path):
    (tmp_path / "base.toml").write_text(WATER.replace("0.3", "-0.3"), encoding="utf-8")
    child = tmp_path / "child.toml"
    child.write_text('kind = "water"\nextends = "base.toml"\n', encoding="utf-8")
    with pytest.raises(
        RobotFileError, match=re.escape(f"{tmp_path / 'base.toml'}: key `tangential_friction`")
    ):
        load_water(child)


def test_an_extended_file_that_cannot_be_read_is_told_with_the_file_that_extends_it(tmp_path):
    (tmp_path / "base.toml").write_text("a = ", encoding="utf-8")
    child = tmp_path / "child.toml"
    for base, message in (("./", "is a folder, not a file"), ("base.toml", "is not valid TOML")):
        child.write_text(f'kind = "water"\nextends = "{base}"\n', encoding="utf-8")
        with pytest.raises(
            RobotFileError, match=f"{re.escape(str(child))}: key `extends`: .*{message}"
        ):
            load_water(child)


def test_two_files_that_extend_each_other_are_refused(tmp_path):
    for mine, other in (("a", "b"), ("b", "a")):
        (tmp_path / f"{mine}.toml").write_text(
            f'kind = "water"\nextends = "{other}.toml"\n', encoding="utf-8"
        )
    with pytest.raises(RobotFileError, match="key `extends`: must not lead back"):
        load_water(tmp_path / "a.toml")


def test_a_robot_cannot_extend_a_water(tmp_path):
    (tmp_path / "water.toml").write_text(WATER, encoding="utf-8")
    path = tmp_path / "robot.toml"
    path.write_text('kind = "robot"\nname = "x"\nextends = "water.toml"\n', encoding="utf-8")
    with pytest.raises(RobotFileError, match=r'water\.toml: key `kind`: must be "robot" here'):
        load_robot(path)


def test_a_folder_is_refused(tmp_path):
    with pytest.raises(RobotFileError, match="is a folder, not a file"):
        load_robot(tmp_path)


def test_a_file_in_another_encoding_is_refused(tmp_path):
    path = tmp_path / "latin.toml"
    path.write_bytes('kind = "robot" # café'.encode("latin-1"))
    with pytest.raises(RobotFileError, match=r"latin\.toml: is not UTF-8 text"):
        load_robot(path)


@pytest.mark.parametrize("name", ["x" * 5000 + ".toml", "nul\0.toml"])
def test_a_path_that_cannot_be_one_is_refused(name):
    with pytest.raises(RobotFileError, match=r"no such file|cannot be read"):
        load_robot(name)


def test_only_robots_waters_grounds_and_flows_are_written():
    with pytest.raises(
        ValueError, match="`thing` must be a Robot, Water, Ground or Flow, got Joint"
    ):
        to_toml(Joint())


def test_not_found_survives_the_way_between_processes():
    error = pickle.loads(pickle.dumps(RobotNotFound("x: no such file")))
    assert isinstance(error, RobotNotFound)
    assert str(error) == "x: no such file"
