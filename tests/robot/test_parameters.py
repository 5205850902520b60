from dataclasses import asdict, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, strategies as st
from robot.strategies import names, waters

from laticauda.robot import (
    Parameters,
    RobotNotFound,
    Water,
    load_parameters,
    load_robot,
    load_water,
    parameter_names,
)
from laticauda.robot.parameters import GAITS
from laticauda.values.errors import RobotFileError, StorageFailed
from laticauda.water.fluid.laws import PolynomialDrag, TotalSpeedDrag

numbers = st.floats(0.01, 3.0)
tables = st.fixed_dictionaries(
    {},
    optional={
        "joint": st.fixed_dictionaries({}, optional={"limit": numbers, "stiffness": numbers}),
        "actuator": st.fixed_dictionaries(
            {}, optional={"tracking": st.floats(0.1, 1.5), "servo_gain": numbers}
        ),
        "caudal_fin": st.fixed_dictionaries(
            {}, optional={"normal_drag": numbers, "opening": st.just("closed")}
        ),
        "tether": st.fixed_dictionaries(
            {}, optional={"drag": numbers, "force": st.tuples(numbers, numbers)}
        ),
        "robot": st.fixed_dictionaries(
            {}, optional={"active_power": numbers, "electronics_power": numbers}
        ),
    },
)


@st.composite
def parameter_sets(draw: st.DrawFn) -> Parameters:
    usual = draw(waters())
    own = {
        gait: replace(draw(waters()), depth=usual.depth)
        for gait in draw(st.sets(st.sampled_from(GAITS)))
    }
    return Parameters(
        name=draw(names),
        title=draw(names),
        joints=draw(st.sampled_from([None, "prescribed", "pd", "servo"])),
        every_gait=usual,
        own=own,
        changes=draw(tables),
        own_changes={gait: draw(tables) for gait in draw(st.sets(st.sampled_from(GAITS)))},
    )


ROOT = Path(__file__).parent.parent.parent
HEAD = 'kind = "parameters"\nname = "mine"\ntitle = "my fit"\n'
WATER = "[water]\ntangential_friction = 0.3\nnormal_drag = 1.75\nadded_mass = 1.5\n"


@pytest.fixture
def load(tmp_path: Path):
    def load(text: str) -> Parameters:
        path = tmp_path / "mine.toml"
        path.write_text(text, encoding="utf-8")
        return load_parameters(path)

    return load


def coefficients(water) -> dict:
    return {name: value for name, value in asdict(water).items() if name != "name"}


def test_the_example_holds_the_papers_coefficients():
    found = load_parameters(ROOT / "examples" / "parameters.toml")
    assert coefficients(found.water("lateral_undulation")) == coefficients(
        load_water("paper-lateral")
    )
    assert coefficients(found.water("eel_like")) == coefficients(load_water("paper-eel"))


def test_a_gait_without_a_water_of_its_own_has_that_of_every_gait(load):
    found = load(HEAD + WATER + "[eel_like.water]\nnormal_drag = 2\n")
    assert (found.name, found.title) == ("mine", "my fit")
    assert found.water("custom") is found.water("lateral_undulation") is found.every_gait
    assert found.every_gait.name == "mine"


def test_what_a_gait_does_not_replace_stays_as_for_every_gait(load):
    found = load(HEAD + WATER + "depth = 0.2\n[eel_like.water]\nnormal_drag = 2\n")
    own = found.water("eel_like")
    assert coefficients(own) == {**coefficients(found.every_gait), "normal_drag": 2.0}
    assert own.name == "mine, eel_like"
    assert own.depth == 0.2


def test_numbers_of_a_gait_s_law_are_put_over_the_usual_one_and_another_law_takes_its_whole_place(
    load,
):
    usual = "[water.drag]\nreference_speed = 0.5\nlinear = false\n"
    same = '[eel_like.water.drag]\nkind = "polynomial-drag"\nsway_friction = 0.5\n'
    other = '[lateral_undulation.water.drag]\nkind = "total-speed-drag"\nbeta = 0.25\n'
    found = load(HEAD + WATER + usual + same + other)
    law = found.every_gait.drag
    assert law == PolynomialDrag(reference_speed=0.5, linear=False)
    assert found.water("eel_like").drag == replace(law, sway_friction=0.5)
    assert found.water("lateral_undulation").drag == TotalSpeedDrag(beta=0.25)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            HEAD.replace('"parameters"', '"water"') + WATER,
            "key `kind`: must be \"parameters\" here, got 'water'",
        ),
        (
            HEAD.removeprefix('kind = "parameters"\n') + WATER,
            'key `kind`: is missing; it must be "parameters" here',
        ),
        (HEAD, "key `water`: is missing; every parameter file needs it"),
        (HEAD.replace('name = "mine"\n', "") + WATER, "key `name`: is missing"),
        (
            HEAD.replace('"my fit"', '" "') + WATER,
            "key `title`: must be a text on one line that is not blank",
        ),
        (
            HEAD + WATER + "[eel-like.water]\n",
            "key `eel-like`: is not known; did you mean `eel_like`?",
        ),
        (HEAD + WATER + "[robto]\n", "key `robto`: is not known; did you mean `robot`?"),
        (
            HEAD + WATER + "[robot]\nmass = 3\n",
            "key `robot.mass`: is not known; the keys here are active_power, elec",
        ),
        (
            HEAD + WATER + "[robot]\nactive_power = -3\n",
            "key `robot.active_power`: must be >= 0 W, got -3",
        ),
        (
            HEAD + WATER + "[robot]\nactive_pwr = 3\n",
            "key `robot.active_pwr`: is not known; did you mean `active_power`?",
        ),
        (
            HEAD + 'joints = "loose"\n' + WATER,
            "key `joints`: must be one of `prescribed`, `pd`, `servo`, `ekeberg`, `hill`, `speed-servo`, got 'loose'",
        ),
        (
            HEAD + WATER + "[actuator]\ntracking = 2\n",
            "key `actuator.tracking`: must be between 0 and 1.5, got 2",
        ),
        (
            HEAD + WATER + "[actuator]\ntraking = 1\n",
            "key `actuator.traking`: is not known; did you mean `tracking`?",
        ),
        (
            HEAD + WATER + '[joint]\naxis = "pitch"\n',
            "key `joint.axis`: must not be given: a parameter file cannot",
        ),
        (
            HEAD + WATER + "[joint.actuator]\n",
            "key `joint.actuator`: must not be given: use the separate table",
        ),
        (
            HEAD + WATER + "[joint]\nlimit_deg = 200\n",
            "key `joint.limit_deg`: must be between 0 and 180 deg, got 200",
        ),
        (
            HEAD + WATER + "[caudal_fin]\nheight = 0\n",
            "key `caudal_fin.height`: must be > 0 m, got 0",
        ),
        (HEAD + WATER + "[tether]\nforce = 3\n", "key `tether.force`: must be two numbers"),
        (
            HEAD + WATER + "[eel_like.actuator]\nvoltage = 0\n",
            "key `eel_like.actuator.voltage`: must be > 0 V, got 0",
        ),
        (HEAD + "actuator = 3\n" + WATER, "key `actuator`: must be a table, got 3"),
        (
            HEAD + WATER + "[eel_like.watre]\n",
            "key `eel_like.watre`: is not known; did you mean `water`?",
        ),
        (
            HEAD + WATER + "normal_darg = 1\n",
            "key `water.normal_darg`: is not known; did you mean `normal_drag`?",
        ),
        (HEAD + WATER.replace("1.75", "-1"), "key `water.normal_drag`: must be >= 0, got -1"),
        (
            HEAD + WATER.replace("1.75", '"big"'),
            "key `water.normal_drag`: must be a number, got 'big'",
        ),
        (
            HEAD + WATER.replace("added_mass = 1.5\n", ""),
            "key `water.added_mass`: is missing; every Water needs it",
        ),
        (
            HEAD + WATER + 'name = "other"\n',
            "key `water.name`: must not be given: the water takes the name",
        ),
        (
            HEAD + WATER + "[eel_like.water]\ndepth = 0\n",
            "key `eel_like.water.depth`: must be > 0 m, got 0",
        ),
        (HEAD + "water = 3\n", "key `water`: must be a table, got 3"),
        (HEAD + WATER + "[", "is not valid TOML"),
    ],
)
def test_what_is_wrong_is_refused_with_the_file_and_the_key(load, text, message):
    with pytest.raises(RobotFileError) as refused:
        load(text)
    assert "mine.toml: " in str(refused.value)
    assert message in str(refused.value)


def test_a_file_that_is_not_there_is_said_to_be_missing(tmp_path: Path):
    with pytest.raises(RobotNotFound, match=r"none\.toml: no such file"):
        load_parameters(tmp_path / "none.toml")
    with pytest.raises(
        RobotNotFound, match=r"there is no parameter preset named `papre`; did you mean `paper`\?"
    ):
        load_parameters("papre")
    with pytest.raises(ValueError, match="`name_or_path` must be a preset's name or a path, got 3"):
        load_parameters(3)  # type: ignore[arg-type]


def test_every_preset_loads_under_its_name():
    assert "paper" in parameter_names()
    for name in parameter_names():
        assert load_parameters(name).name == name


@given(parameter_sets())
def test_what_is_written_is_read_back_as_it_was(parameters: Parameters):
    with TemporaryDirectory() as folder:
        parameters.save(Path(folder) / "mine.toml")
        assert load_parameters(Path(folder) / "mine.toml") == parameters


DRIVEN = """
[joint]
limit_deg = 60
[actuator]
tracking = 0.9
[caudal_fin]
normal_drag = 1.4
[tether]
drag = 0.5
[robot]
active_power = 60
[eel_like.actuator]
tracking = 0.8
"""


def test_a_robot_gets_the_numbers_of_every_gait_and_then_those_of_its_own(load):
    found, robot = load(HEAD + WATER + DRIVEN), load_robot("mamba-fin")
    lateral, eel = (found.robot(robot, gait) for gait in ("lateral_undulation", "eel_like"))
    assert {joint.actuator.tracking for joint in lateral.joints} == {0.9}
    assert {joint.actuator.tracking for joint in eel.joints} == {0.8}
    assert lateral.joints[3].limit == pytest.approx(1.0471975512)
    assert (lateral.caudal_fin.normal_drag, lateral.tether.drag, lateral.active_power) == (
        1.4,
        0.5,
        60.0,
    )
    assert replace(eel, joints=lateral.joints) == lateral
    assert (lateral.modules, lateral.electronics_power) == (robot.modules, robot.electronics_power)
    bare = found.robot(load_robot("mamba"), "eel_like")
    assert bare.caudal_fin is None


def test_parameters_without_a_robot_leave_it_as_it_is():
    robot = load_robot("mamba-fin")
    assert load_parameters("paper").robot(robot, "eel_like") is robot


def test_a_number_that_does_not_go_with_the_robot_is_refused_when_it_meets_it(load):
    found = load(HEAD + WATER + "[caudal_fin]\nopening_length = 0.3\n")
    robot = load_robot("mamba-fin")
    short = replace(robot, caudal_fin=replace(robot.caudal_fin, length=0.2))
    with pytest.raises(ValueError, match=r"`opening_length` must be < 0\.2 m"):
        found.robot(short, "eel_like")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"joints": "loose"}, "`joints` must be one of `prescribed`, `pd`, `servo`"),
        (
            {"own": {"custom": load_water("paper-eel")}},
            "`own` must be one of `lateral_undulation`, `eel_like`",
        ),
        ({"changes": {"motor": {}}}, "`changes` must be one of `joint`, `actuator`"),
        (
            {"changes": {"actuator": {"tracking": -1.0}}},
            r"`changes.actuator.tracking` must be > 0, got -1\.0",
        ),
        (
            {"changes": {"caudal_fin": {"added_mass": None}}},
            "`changes.caudal_fin.added_mass` must be left out to keep",
        ),
    ],
)
def test_parameters_made_in_python_are_checked_as_strictly(changes, message):
    with pytest.raises(ValueError, match=message):
        Parameters(
            **{"name": "mine", "title": "my fit", "every_gait": load_water("paper-eel"), **changes}
        )


def test_what_cannot_be_written_is_said(tmp_path: Path):
    water = load_water("paper-eel")
    with pytest.raises(StorageFailed, match="cannot be written"):
        load_parameters("paper").save(tmp_path)
    deep = Parameters(
        name="a", title="b", every_gait=replace(water, depth=0.3), own={"eel_like": water}
    )
    with pytest.raises(ValueError, match="`depth` must be a number, as it is for every gait"):
        deep.to_toml()
    assert isinstance(deep.every_gait, Water)


def test_numbers_of_a_motor_are_the_robots_own_unless_the_file_says_that_they_are_assumed(tmp_path):
    path = tmp_path / "assumed.toml"
    path.write_text(HEAD + WATER + "[actuator]\nstated = false\nstall_torque = 20.0\n")
    robot = load_parameters(path).robot(load_robot("mamba"), "eel_like")
    assert not robot.joints[0].actuator.stated
    assert robot.joints[0].actuator.stall_torque == 20.0
    path.write_text(HEAD + WATER + "[actuator]\nstall_torque = 20.0\n")
    assert load_parameters(path).robot(load_robot("chain"), "eel_like").joints[0].actuator.stated
