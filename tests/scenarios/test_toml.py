"""A scenario is a file: names where names will do, all numbers when it is written."""

from dataclasses import replace

import pytest

import laticauda as lc
from laticauda.motion.joints.laws import Servo
from laticauda.scenarios import run_from_toml
from laticauda.values.errors import RobotFileError

GAIT = """[gait]
amplitude = 0.5
frequency = 2.0
phase_shift = 0.7
"""


@pytest.fixture
def said(tmp_path):
    def read(text, gait=GAIT):
        (tmp_path / "scenario.toml").write_text(f'kind = "scenario"\n{text}\n{gait}')
        return lc.load_scenario(tmp_path / "scenario.toml")

    return read


def test_names_become_values(said):
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    assert said("duration = 4.0") == lc.build_scenario("mamba", gait, 4.0)
    short = said('robot = "chain"\nn_links = 5\nground = "viscous"\nmodel = "spatial"')
    assert short == lc.build_scenario(
        lc.load_robot("chain", 5), gait, environment="viscous", model="spatial"
    )
    assert said("", f'{GAIT}[model]\njoints = "servo"\ndt = 0.001').model == lc.Planar(
        joints=Servo(), dt=0.001
    )


def test_a_water_may_change_a_few_numbers_of_another(said):
    water = said('water = { extends = "paper-eel", normal_drag = 1.25 }').environment
    assert water == replace(lc.load_water("paper-eel"), name=water.name, normal_drag=1.25)


def test_parameters_bring_their_water_and_joint_law(said, tmp_path):
    (tmp_path / "mine.toml").write_text(
        'kind = "parameters"\nname = "mine"\ntitle = "mine"\njoints = "servo"\n[water]\n'
        "tangential_friction = 0.3\nnormal_drag = 1.75\nadded_mass = 1.5\n"
    )
    chosen = said('parameters = "mine.toml"')
    assert (chosen.environment.name, chosen.model.joints) == ("mine", Servo())


def test_a_controller_and_every_number_come_back(tmp_path):
    gait = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    controller = lc.PathFollowing(
        gait=gait,
        path=lc.Polyline(waypoints=((0, 0), (1, 1))),
        guidance=lc.LineOfSight(look_ahead_distance=0.2),
        heading=lc.HeadingController(gain=0.4, max_offset=0.3),
    )
    for motion in (gait, controller):
        chosen = lc.build_scenario(
            "mamba-fin", motion, model="spatial", root="free", start=lc.Start(velocity=0.1)
        )
        lc.save_scenario(chosen, tmp_path / "saved.toml")
        assert lc.load_scenario(tmp_path / "saved.toml") == chosen


@pytest.mark.parametrize(
    ("text", "gait", "message"),
    [
        ('robot = "mambo"', GAIT, "there is no robot preset named `mambo`; did you mean `mamba`"),
        ("n_links = 0", GAIT, "key `n_links`: must be a whole number >= 1, got 0"),
        ("", f"{GAIT}speed = 3", "key `gait.speed`: is not known"),
        ("", "", "key `gait`: must be given, or `controller`, but not both"),
        (
            'water = "paper-eel"\nground = "viscous"',
            GAIT,
            "key `water`: must not be given with `ground`",
        ),
        (
            'model = "flat"',
            GAIT,
            "key `model.kind`: must be one of `planar`, `spatial`, got 'flat'",
        ),
        ("lenght = 3", GAIT, "key `lenght`: is not known"),
        ("", f"{GAIT}[model]\nroot = 'free'", "key `model.root`: is not known"),
    ],
)
def test_what_is_wrong_is_refused_with_its_key(said, text, gait, message):
    with pytest.raises(RobotFileError, match=message):
        said(text, gait)


def test_a_stored_text_that_is_nested_too_deeply_is_refused_in_a_sentence():
    with pytest.raises(RobotFileError, match="scenario: is not valid TOML: nested too deeply"):
        run_from_toml("x = " + 100_000 * "[")
