from dataclasses import asdict
from pathlib import Path

import pytest

from laticauda.errors import RobotFileError
from laticauda.robot import Parameters, RobotNotFound, load_parameters, load_water

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
    assert coefficients(found.water("lateral_undulation")) == coefficients(load_water("paper-lateral"))
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


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD.replace('"parameters"', '"water"') + WATER, "key `kind`: must be \"parameters\" here, got 'water'"),
        (HEAD.removeprefix('kind = "parameters"\n') + WATER, 'key `kind`: is missing; it must be "parameters" here'),
        (HEAD, "key `water`: is missing; every parameter file needs it"),
        (HEAD.replace('name = "mine"\n', "") + WATER, "key `name`: is missing"),
        (HEAD.replace('"my fit"', '" "') + WATER, "key `title`: must be a text on one line that is not blank"),
        (HEAD + WATER + "[eel-like.water]\n", "key `eel-like`: is not known; did you mean `eel_like`?"),
        (HEAD + WATER + "[robot]\n", "key `robot`: is not known; the keys here are name, title, water, lateral_und"),
        (HEAD + WATER + "[eel_like.watre]\n", "key `eel_like.watre`: is not known; did you mean `water`?"),
        (HEAD + WATER + "normal_darg = 1\n", "key `water.normal_darg`: is not known; did you mean `normal_drag`?"),
        (HEAD + WATER.replace("1.75", "-1"), "key `water.normal_drag`: must be >= 0, got -1"),
        (HEAD + WATER.replace("1.75", '"big"'), "key `water.normal_drag`: must be a number, got 'big'"),
        (HEAD + WATER.replace("added_mass = 1.5\n", ""), "key `water.added_mass`: is missing; every Water needs it"),
        (HEAD + WATER + 'name = "other"\n', "key `water.name`: must not be given: the water takes the name"),
        (HEAD + WATER + "[eel_like.water]\ndepth = 0\n", "key `eel_like.water.depth`: must be > 0 m, got 0"),
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
    with pytest.raises(ValueError, match="`path` must be the path of a parameter file, got 3"):
        load_parameters(3)  # type: ignore[arg-type]
