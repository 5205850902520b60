import re
from dataclasses import fields, replace

import pytest

import laticauda as lc
from laticauda.control import PhaseOscillators
from laticauda.models.simulate import list_parameters
from laticauda.models.simulate.numbers import change_parameters, look_up, value_of
from laticauda.robot import Water

FIN = replace(lc.load_robot("mamba-fin").caudal_fin, flexural_rigidity=2.0)
ROBOT = replace(lc.load_robot("mamba-fin"), caudal_fin=FIN)
WATER = lc.load_water("paper-lateral")
GAIT = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
SCENARIO = lc.Scenario(robot=ROBOT, motion=GAIT, environment=WATER)
KNOWN = list_parameters(SCENARIO)


def test_every_number_of_the_water_can_be_swept():
    numbers = {
        field.name
        for field in fields(Water)
        if field.type in ("float", float, "float | None", float | None)
    }
    numbers |= {"depth", "drag.reference_speed", "drag.sway_friction"}
    assert {f"water.{name}" for name in numbers} | {"water.current_x", "water.current_y"} == {
        name for name in KNOWN if name.startswith("water.")
    }


def test_a_parameter_has_the_unit_and_the_words_of_its_field():
    assert KNOWN["gait.frequency"].unit == "rad/s"
    assert KNOWN["robot.module.section.half_width"].unit == "m"
    assert KNOWN["water.normal_drag"].unit == ""
    assert "world axes" in KNOWN["water.current_y"].title
    assert KNOWN["water.current_y"].title.endswith(": y")
    assert KNOWN["robot.n_links"].is_whole and KNOWN["robot.caudal_fin.n_strips"].is_whole
    assert not KNOWN["robot.caudal_fin.length"].is_whole


def test_a_parameter_is_called_in_words_that_an_axis_can_have():
    known = list_parameters(SCENARIO, each=True)
    phrases = {
        "gait.amplitude": "amplitude",
        "gait.frequency": "angular frequency",
        "water.current_y": "current, y",
        "water.drag.reference_speed": "reference speed of the drag",
        "robot.n_links": "number of links",
        "robot.caudal_fin.height": "height of the caudal fin",
        "robot.caudal_fin.n_hinges": "number of hinges of the caudal fin",
        "robot.module.mass": "mass of the modules",
        "robot.module[3].section.half_width": "half width of the section of module 3",
    }
    assert {name: known[name].phrase for name in phrases} == phrases
    # Texts of fields explain symbols, and are no labels.
    assert not any(set(one.phrase) & set(";_|()") for one in known.values())


def test_every_parameter_can_be_set_and_comes_out_where_it_belongs():
    # Each is moved by a little from what it is; where it is None, from 1.
    for name, parameter in KNOWN.items():
        if name in ("robot.n_links", "water.edge_clip"):  # the water of the paper has no edge
            continue
        before = _value(SCENARIO, name)
        wanted = (1.0 if before is None else before) + (1 if parameter.is_whole else 1e-3)
        after = change_parameters(SCENARIO, {name: wanted})
        assert _value(after, name) == wanted
        assert (
            _value(change_parameters(after, {name: before}), name) == before
            if before is not None
            else True
        )


def _value(scenario, name):
    root, *way = name.split(".")
    thing = {"robot": scenario.robot, "gait": scenario.gait, "water": scenario.environment}[root]
    for step in way:
        if step in ("module", "joint"):
            several = getattr(thing, step + "s")
            assert len(set(several)) == 1
            thing = several[0]
        elif step.endswith(("_x", "_y")):
            thing = getattr(thing, step[:-2])["xy".index(step[-1])]
        else:
            thing = getattr(thing, step)
    return thing


def test_values_that_bound_each_other_are_set_at_once():
    values = {"robot.caudal_fin.length": 0.1, "robot.caudal_fin.opening_length": 0.05}
    robot = change_parameters(SCENARIO, values).robot
    assert (robot.caudal_fin.length, robot.caudal_fin.opening_length) == (0.1, 0.05)


def test_both_ends_of_a_pair_can_be_set():
    other = change_parameters(SCENARIO, {"water.current_x": 0.1, "water.current_y": -0.2})
    assert other.environment == replace(WATER, current=(0.1, -0.2))


def test_the_numbers_of_a_flow_can_be_swept_and_those_of_each_in_a_sum():
    flow = replace(lc.load_current("turbulence"), seed=3)
    one = replace(SCENARIO, environment=replace(WATER, current=flow))
    known = {name for name in list_parameters(one) if name.startswith("water.current")}
    assert known >= {
        "water.current.intensity",
        "water.current.seed",
        "water.current.mean_x",
        "water.current.mean_z",
    }
    assert list_parameters(one)["water.current.seed"].is_whole
    assert "water.current_x" not in known
    values = {
        "water.current.intensity": 0.1,
        "water.current.seed": 5.0,
        "water.current.mean_y": 0.2,
    }
    found = change_parameters(one, values).environment.current
    assert found == replace(flow, intensity=0.1, seed=5, mean=(0.1, 0.2, 0.0))
    assert type(found.seed) is int
    assert value_of("water.current.seed", one) == 3.0
    several = replace(one, environment=replace(WATER, current=flow + lc.load_current("vortex")))
    assert {"water.current.flow[0].intensity", "water.current.flow[1].core"} < list_parameters(
        several
    ).keys()
    other = change_parameters(several, {"water.current.flow[1].core": 0.7}).environment.current
    assert other.flows == (flow, replace(lc.load_current("vortex"), core=0.7))


def test_the_number_of_links_and_what_they_are_like_can_be_set_together():
    other = change_parameters(SCENARIO, {"robot.n_links": 5.0, "robot.module.mass": 2.0})
    assert [module.mass for module in other.robot.modules] == [2.0] * 5
    assert other.motion is GAIT and other.environment is WATER


def test_a_parameter_that_does_not_exist_is_refused_with_the_nearest():
    with pytest.raises(
        ValueError, match=r"got 'gait.amplitud'; the nearest are `gait.amplitude`\."
    ):
        look_up("gait.amplitud", KNOWN)
    expected = r"the nearest are `water.normal_drag`, `robot.module.normal_drag`, `robot.caudal_fin.normal_drag`\."
    with pytest.raises(ValueError, match=expected):
        look_up("normal-drag", KNOWN)
    with pytest.raises(ValueError, match=r"got 'xyzzy'\.$"):
        look_up("xyzzy", KNOWN)
    with pytest.raises(ValueError, match="`points` must name numbers of gait, water or robot"):
        look_up("robot.name", KNOWN)


def test_a_fin_can_be_swept_only_by_a_robot_that_has_one():
    bare = list_parameters(replace(SCENARIO, robot=lc.load_robot("mamba")))
    assert {name for name in KNOWN if name not in bare} == {
        name for name in KNOWN if "caudal_fin" in name
    }


def test_on_the_ground_its_friction_can_be_swept():
    known = list_parameters(replace(SCENARIO, environment=lc.load_ground("viscous")))
    assert known["ground.normal"].title.startswith("Coefficient across a link")
    with pytest.raises(ValueError, match="numbers of gait, ground or robot"):
        look_up("water.normal_drag", known)


def test_one_of_several_modules_goes_by_its_number_from_the_tail():
    scenario, name = replace(SCENARIO, robot=lc.load_robot("mamba")), "robot.module[3].normal_drag"
    assert name in list_parameters(scenario, each=True) and name not in set(
        list_parameters(scenario)
    )
    after = change_parameters(
        scenario, {name: 2.5, "robot.module.mass": 0.7, "robot.joint[0].stiffness": 0.1}
    )
    other = after.robot
    assert [module.normal_drag for module in other.modules] == [
        2.5 if i == 3 else None for i in range(9)
    ]
    assert {module.mass for module in other.modules} == {0.7}
    assert [joint.stiffness for joint in other.joints] == [0.1] + [0.0] * 7
    assert value_of(name, after) == 2.5
    assert value_of(name, scenario) == WATER.normal_drag


NETWORK = lc.build_scenario("mamba", PhaseOscillators(gait=GAIT), 2.0, joints="servo")


@pytest.mark.parametrize(
    ("scenario", "name", "hint"),
    [
        (NETWORK, "controller.couplng", "; the nearest are `controller.coupling`"),
        (
            NETWORK,
            "controller.feedback.presure",
            "; the nearest are `controller.feedback.pressure`",
        ),
        (NETWORK, "joints.gan", ""),
        (SCENARIO, "controller.coupling", ""),
        (SCENARIO, "water.normal_drg", "; the nearest are `water.normal_drag`"),
        (SCENARIO, "ground.friction", ""),
        (SCENARIO, "foo.bar", ""),
        (SCENARIO, "robot", ""),
    ],
)
def test_a_name_that_leads_nowhere_is_refused_and_never_ignored(scenario, name, hint):
    for argument, use in (
        ("values", lambda: change_parameters(scenario, {name: 1.0})),
        ("names", lambda: value_of(name, scenario)),
    ):
        with pytest.raises(ValueError, match=re.escape(f"got '{name}'{hint}")) as caught:
            use()
        assert str(caught.value).startswith(f"`{argument}` must name numbers of")
