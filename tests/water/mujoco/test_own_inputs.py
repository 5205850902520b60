"""Kinds of models that failed in the field, with inputs beyond the cases.

The cases themselves are in test_public_cases.py.
"""

import math
import warnings

import mujoco
import numpy as np
import pytest

import laticauda as lc
from laticauda.water import mujoco as water
from laticauda.water.mujoco import Element, lamb

RHO = 1000.0


def spec_of(body: str, *, compiler: str = "", option: str = "") -> mujoco.MjSpec:
    text = f"<mujoco><compiler {compiler}/><option {option}/><worldbody>{body}</worldbody></mujoco>"
    return mujoco.MjSpec.from_string(text)


def element_of(geom: str) -> Element:
    spec = spec_of(f"<body><freejoint/><geom {geom}/></body>")
    return water.geom_element(spec.compile(), 0)


# ---- f12: what attach compiles itself ------------------------------------------------------------

SLIDES = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
PLANAR = f'{SLIDES}<joint axis="0 0 1"/>'
BALL = '<joint type="ball"/>'
COMPILERS = ('inertiafromgeom="true"', 'inertiafromgeom="true" balanceinertia="true"')


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize(
    ("joints", "geom"),
    [
        ("<freejoint/>", 'type="ellipsoid" size=".3 .2 .1"'),
        ("<freejoint/>", 'type="box" size=".3 .2 .1" pos=".1 0 0"'),
        ("<freejoint/>", 'type="capsule" size=".1" fromto="0 0 0 .4 .1 0"'),
        ("<freejoint/>", 'type="cylinder" size=".1 .2" euler="20 30 40"'),
        (SLIDES, 'type="ellipsoid" size=".3 .2 .1" euler="0 0 30"'),
        (PLANAR, 'type="box" size=".3 .2 .1"'),
        (BALL, 'type="ellipsoid" size=".3 .2 .1" pos=".2 0 0"'),
        ("<joint/>", 'type="capsule" size=".05 .2"'),
        ('<joint type="slide" axis="1 1 0"/>', 'type="box" size=".3 .2 .1"'),
        ("<freejoint/>", 'size=".1" mass="3"'),
    ],
)
def test_a_model_whose_inertia_comes_from_its_geoms_gets_water_and_its_added_mass(
    compiler, joints, geom
):
    body = f'<body name="b">{joints}<geom {geom}/></body>'
    spec = spec_of(body, compiler=compiler, option='gravity="0 0 0"')
    dry = spec.compile()
    handle = water.attach(spec)
    model = handle.model()
    np.testing.assert_allclose(model.body_mass, dry.body_mass, rtol=1e-12)
    data, plain = mujoco.MjData(model), mujoco.MjData(dry)
    mujoco.mj_forward(model, data)
    mujoco.mj_forward(dry, plain)
    wet_matrix, matrix = np.zeros((2, model.nv, model.nv))
    mujoco.mj_fullM(model, data, wet_matrix)
    mujoco.mj_fullM(dry, plain, matrix)
    # The added mass is that of its element, seen through the joints.
    (element,) = handle.elements
    number = model.body("b").id
    axes = data.xmat[number].reshape(3, 3) @ element.rotation
    place = data.xpos[number] + data.xmat[number].reshape(3, 3) @ element.position
    linear, turning = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, linear, turning, place, number)
    along, about = axes.T @ linear, axes.T @ turning
    added = along.T @ np.diag(element.added_mass) @ along
    added += about.T @ np.diag(element.added_inertia) @ about
    np.testing.assert_allclose(wet_matrix, matrix + added, rtol=1e-9, atol=1e-9)


# ---- f13: flexes in a scene ----------------------------------------------------------------------

FLEXES = {
    "net": 'type="grid" count="6 6 1" dim="2"',
    "narrow net": 'type="grid" count="12 2 1" dim="2"',
    "rope": 'type="grid" count="10 1 1" dim="1"',
    "soft block": 'type="grid" count="3 3 3" dim="3"',
    "soft bar": 'type="grid" count="5 2 2" dim="3"',
    "disc": 'type="disc" count="6 6 1" dim="2"',
    "circle": 'type="circle" count="8 1 1" dim="1"',
    "ball": 'type="ellipsoid" count="4 4 4" dim="3"',
    "sheet": 'type="square" count="5 5 1" dim="2"',
    "cylinder": 'type="cylinder" count="4 4 4" dim="3"',
}


@pytest.mark.filterwarnings("ignore:no water acts on flexes that are neither nets nor ropes")
@pytest.mark.parametrize("kind", FLEXES)
def test_a_scene_with_any_flex_runs_and_what_is_far_away_blames_nobody(kind, tmp_path):
    file = tmp_path / "flex.xml"
    file.write_text(
        f"""<mujoco><worldbody><flexcomp name="f" {FLEXES[kind]} spacing=".1 .1 .1" radius=".005"
        pos="3 0 -.5" mass=".2"><edge equality="true"/><contact selfcollide="none"/></flexcomp>
        </worldbody></mujoco>"""
    )
    gait = lc.lateral_undulation(amplitude=0.3, frequency=3.0, phase_shift=0.7)
    trial = lc.swim("mamba", gait, 0.05, model="spatial", scene=str(file))
    assert np.all(trial.link_force["contact"] == 0.0)


# ---- f15, g01, g02: added mass of shapes ---------------------------------------------------------


@pytest.mark.parametrize("radius", [0.01, 0.05, 0.25, 0.7, 2.0])
@pytest.mark.parametrize("kind", ["cylinder", "ellipsoid"])
def test_thin_discs_of_any_size_carry_eight_thirds_of_the_cube_of_their_radius(radius, kind):
    sizes = {"cylinder": (radius, 0.002 * radius), "ellipsoid": (radius, radius, 0.002 * radius)}
    size = " ".join(f"{number:g}" for number in sizes[kind])
    element = element_of(f'type="{kind}" size="{size}"')
    right = 8.0 / 3.0 * RHO * radius**3
    assert max(element.added_mass) == pytest.approx(right, rel=0.03)


@pytest.mark.parametrize("slenderness", [5.0, 8.0, 12.0, 20.0, 40.0])
@pytest.mark.parametrize("kind", ["cylinder", "capsule"])
def test_slender_rods_turn_with_the_added_inertia_of_strips_less_their_ends(slenderness, kind):
    radius, half = 0.05, 0.05 * slenderness
    of_cylinder = half - radius if kind == "capsule" else half
    element = element_of(f'type="{kind}" size="{radius} {of_cylinder}"')
    strips = math.pi * RHO * radius**2 * (2.0 * half) ** 3 / 12.0
    share = element.added_inertia[1] / strips
    ellipsoid = element_of(f'type="ellipsoid" size="{half} {radius} {radius}"')
    assert ellipsoid.added_inertia[1] < element.added_inertia[1] < strips
    assert share > 1.0 - 3.0 / slenderness


@pytest.mark.parametrize(
    "half",
    [
        (0.1, 0.1, 0.1),
        (0.2, 0.2, 0.2),
        (0.3, 0.2, 0.1),
        (0.5, 0.1, 0.1),
        (0.2285, 0.169, 0.127),
        (0.25, 0.25, 0.0025),
        (0.5, 0.05, 0.001),
        (1.0, 0.3, 0.3),
        (0.05, 0.3, 0.2),
        (0.15, 0.02, 0.02),
    ],
)
def test_a_box_carries_more_than_the_ellipsoid_in_it_and_less_than_the_one_around_it(half):
    size = " ".join(f"{number:g}" for number in half)
    box = element_of(f'type="box" size="{size}"')
    inside, around = (lamb.lamb(half) for _ in range(2))
    volume = 4.0 / 3.0 * math.pi * math.prod(half)
    for axis in range(3):
        if half[axis] <= min(half) * 1.001:  # ends and edges of plates apart
            smaller = RHO * volume * inside.mass[axis]
            larger = RHO * volume * 3.0**1.5 * around.mass[axis]
            assert smaller < box.added_mass[axis] < larger
    assert all(number > 0.0 for number in (*box.added_mass, *box.added_inertia))


@pytest.mark.parametrize("half", [(0.2285, 0.169, 0.127), (0.1, 0.1, 0.1), (0.25, 0.05, 0.05)])
def test_a_box_as_a_mesh_is_the_box(half):
    x, y, z = half
    corners = " ".join(
        f"{a * x} {b * y} {c * z}" for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)
    )
    text = f"""<mujoco><asset><mesh name="m" vertex="{corners}"/></asset><worldbody><body><freejoint/>
    <geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""
    mesh = water.geom_element(mujoco.MjModel.from_xml_string(text), 0)
    box = element_of(f'type="box" size="{x} {y} {z}"')
    assert sorted(mesh.added_mass) == pytest.approx(sorted(box.added_mass), rel=1e-4)
    assert sorted(mesh.added_inertia) == pytest.approx(sorted(box.added_inertia), rel=1e-4)


# ---- f17: another callback -----------------------------------------------------------------------


def python_function(model, data):
    """Another package's, which does not call the one before it."""


class Callback:
    def __call__(self, model, data):
        """Like a function."""


OTHERS = {
    "a function": python_function,
    "a lambda": lambda model, data: None,
    "an object": Callback(),
    "a method": Callback().__call__,
    "nothing": None,
}


@pytest.mark.parametrize("n_waters", [1, 2])
@pytest.mark.parametrize("other", OTHERS)
def test_whatever_replaces_the_callback_is_said_and_attaching_again_brings_the_water_back(
    other, n_waters
):
    ball = '<body name="b"><freejoint/><geom size=".1"/></body>'
    handles = [water.attach(spec_of(ball)) for _ in range(n_waters)]
    ours = mujoco.get_mjcb_passive()
    try:
        with pytest.warns(UserWarning, match="models with water have lost it: another callback"):
            mujoco.set_mjcb_passive(OTHERS[other])
        assert not any(handle.active for handle in handles)
        for handle in handles:
            with pytest.raises(ValueError, match="attach the water again"):
                handle.forces(mujoco.MjData(handle.model()))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            mujoco.set_mjcb_passive(None)
        again = water.attach(spec_of(ball))
        assert again.active and handles[0].active
        lift = again.forces(mujoco.MjData(again.model()))["buoyancy"]
        assert lift[0, 2] == pytest.approx(9.81 * again.model().body_mass[1])
    finally:
        mujoco.set_mjcb_passive(ours)


# ---- f19: what turns over (ten shapes and attitudes are in test_any_model.py) -------------------


@pytest.mark.parametrize("yaw", [0, 45, 200])
@pytest.mark.parametrize("pitch", [-35, -10, 2, 25])
def test_a_spheroid_that_floats_pitched_levels_out_whatever_its_heading(pitch, yaw):
    geom = '<geom type="ellipsoid" size=".3 .1 .1" density="500"/>'
    body = f'<body name="b" euler="0 {pitch} {yaw}"><freejoint/>{geom}</body>'
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        water.attach(spec_of(body), surface=0.0)


# ---- f21: what is refused ------------------------------------------------------------------------

ELLIPSOID = '<body name="b" {}><freejoint/><geom type="ellipsoid" size=".3 .2 .1"/></body>'


@pytest.mark.parametrize(
    ("body", "option", "arguments"),
    [
        (ELLIPSOID, 'density="1000" viscosity=".001"', {}),
        (ELLIPSOID.replace("{}", 'gravcomp="1"'), "", {}),
        (ELLIPSOID, 'density="1.2" solver="PGS"', {}),
        (ELLIPSOID, 'density="1000" jacobian="sparse"', {"implicit_drag": True}),
        (ELLIPSOID, 'density="1000"', {"density": -1.0}),
        (ELLIPSOID, 'density="1000"', {"surface": math.nan}),
        (ELLIPSOID, 'viscosity="1"', {"form": "fossen"}),
        (ELLIPSOID, 'density="1000"', {"usual_speed": 0.0}),
        (ELLIPSOID, 'density="1000"', {"elements": []}),
        (ELLIPSOID, 'density="1000"', {"elements": [Element(body="c", volume=1.0)]}),
        (ELLIPSOID, 'density="1000"', {"current": (1.0,)}),
    ],
)
def test_whatever_is_refused_leaves_a_compiled_model_as_it_was(body, option, arguments):
    model = spec_of(body.replace("{}", ""), option=option).compile()
    before = model.__getstate__()
    with pytest.raises((ValueError, TypeError)) as refusal:
        water.attach(model, **arguments)
    # What is wrong is said by its name; nothing is said of a model that is right.
    assert any(f"`{name}`" in str(refusal.value) for name in (*arguments, "model", "body"))
    if "density" in arguments:
        assert "`density` must be > 0" in str(refusal.value)
    assert model.__getstate__() == before
    assert water.attached(model) is None
