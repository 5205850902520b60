"""Models that others wrote: what they need is done by `attach`, and what it cannot do leaves them as they were."""

import gc
import warnings
import weakref
from pathlib import Path

import mujoco
import numpy as np
import pytest

from laticauda.water import mujoco as water
from laticauda.water.mujoco import Element
from laticauda.water.mujoco.lamb import lamb

FLOATING = """<mujoco><compiler {compiler}/><option {option}/><worldbody><body name="b" {body}><freejoint/>
<geom name="g" type="{kind}" size="{size}" density="{density}"/></body></worldbody></mujoco>"""


def floating(
    kind: str = "ellipsoid",
    size: str = ".3 .2 .1",
    *,
    option: str = "",
    compiler: str = "",
    body: str = "",
    density: float = 1000.0,
) -> str:
    return FLOATING.format(
        kind=kind, size=size, option=option, compiler=compiler, body=body, density=density
    )


def accelerate(model, force: int = 0) -> float:
    data = mujoco.MjData(model)
    data.qfrc_applied[force] = 1.0
    mujoco.mj_forward(model, data)
    return float(data.qacc[force])


# ---- what `attach` compiles itself ---------------------------------------------------------------


@pytest.mark.parametrize("inertia_from", ["true", "auto", "false"])
def test_a_plain_body_gets_water_from_its_spec_whatever_its_inertia_comes_from(inertia_from):
    text = floating(compiler=f'inertiafromgeom="{inertia_from}"')
    if inertia_from == "false":
        text = text.replace(
            "<freejoint/>",
            '<freejoint/><inertial pos="0 0 0" mass="25.13" diaginertia=".25 .5 .65"/>',
        )
    handle = water.attach(mujoco.MjSpec.from_string(text))
    model = handle.model()
    element = handle.elements[0]
    gc.collect()
    assert handle.model() is model
    assert accelerate(model) == pytest.approx(1.0 / (model.body_mass[1] + element.added_mass[0]))


def test_a_file_gets_water_and_the_handle_keeps_its_model(tmp_path: Path):
    file = tmp_path / "model.xml"
    file.write_text(floating("sphere", ".1", compiler='inertiafromgeom="true"'))
    for path in (file, str(file)):
        handle = water.attach(path)
        gc.collect()
        assert accelerate(handle.model()) == pytest.approx(
            1.0 / (1.5 * handle.model().body_mass[1])
        )
    del handle
    gc.collect()


def test_a_model_that_attach_compiled_goes_with_its_handle():
    handle = water.attach(mujoco.MjSpec.from_string(floating()))
    reference = weakref.ref(handle.model())
    del handle
    gc.collect()
    assert reference() is None


def test_a_model_that_attach_compiled_can_be_kept_without_the_handle():
    model = water.attach(mujoco.MjSpec.from_string(floating())).model()
    gc.collect()
    handle = water.attached(model)
    assert handle is not None and handle.model() is model
    added_mass = handle.elements[0].added_mass[0]
    assert accelerate(model) == pytest.approx(1.0 / (model.body_mass[1] + added_mass))


def test_a_file_that_mujoco_cannot_read_is_refused_in_its_words(tmp_path: Path):
    file = tmp_path / "model.xml"
    file.write_text("<mujoco><worldbody><bod/></worldbody></mujoco>")
    with pytest.raises(ValueError, match=r"must be a file that MuJoCo compiles: .*bod"):
        water.attach(file)
    with pytest.raises(ValueError, match=r"must be a file that MuJoCo compiles: .*missing.xml"):
        water.attach(tmp_path / "missing.xml")


def test_inertias_that_a_compiler_would_take_from_geoms_stay_those_of_the_geoms():
    text = """<mujoco><compiler inertiafromgeom="true"/><worldbody>
    <body name="a"><freejoint/><inertial pos=".1 0 0" mass="9" diaginertia="1 1 1"/><geom size=".1"/></body>
    <body name="c"><joint/><inertial pos=".1 0 0" mass="9" diaginertia="1 1 1"/><geom size=".1" pos=".2 0 0"/></body>
    </worldbody></mujoco>"""
    spec = mujoco.MjSpec.from_string(text)
    plain = spec.compile()
    full = water.compile_spec(spec)
    for name in ("body_mass", "body_inertia", "body_ipos", "body_iquat"):
        np.testing.assert_allclose(getattr(full, name), getattr(plain, name), atol=1e-15)
    mass = plain.body_mass[1]
    water.attach(full)
    assert accelerate(full) == pytest.approx(1.0 / (1.5 * mass))


@pytest.mark.parametrize(
    ("joints", "kind"),
    [
        ("<freejoint/>", "sphere"),
        ('<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>', "ellipsoid"),
    ],
)
def test_a_compiled_model_gets_water_where_the_diagonal_holds_all_added_mass(joints, kind):
    text = floating(kind, ".3 .2 .1").replace("<freejoint/>", joints)
    model = mujoco.MjModel.from_xml_string(text)
    full = water.compile_spec(mujoco.MjSpec.from_string(text))
    assert np.all(model.M_rownnz == 1) and not np.all(full.M_rownnz == 1)
    assert np.any(model.opt.gravity)
    for one in (model, full):
        water.attach(one)
    for k in range(2):
        assert accelerate(model, k) == pytest.approx(accelerate(full, k), rel=1e-12)


def test_a_compiled_ellipsoid_is_refused_with_a_way_out_that_works():
    model = mujoco.MjModel.from_xml_string(floating())
    with pytest.raises(ValueError, match="attach the water to its file or `MjSpec` instead"):
        water.attach(model)
    water.attach(mujoco.MjSpec.from_string(floating()))


def test_a_diagonal_has_no_room_for_the_slope_of_drag():
    model = mujoco.MjModel.from_xml_string(floating("sphere", ".1"))
    with pytest.raises(ValueError, match="but stores only its diagonal"):
        water.attach(model, implicit_drag=True)


# ---- what is refused leaves the model as it was --------------------------------------------------


def refuse_by_added_mass(model) -> None:
    water.attach(model, [Element(body="b", added_mass=(1, 2, 3))])


def refuse_by_body(model) -> None:
    water.attach(model, [Element(body="nobody")])


def refuse_by_form(model) -> None:
    water.attach(model, [Element(body="b", volume=1.0)], form="none")


def refuse_by_current(model) -> None:
    water.attach(model, [Element(body="b", volume=1.0)], current=(0.0, 0.0))


def refuse_by_warning(model) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        water.attach(model, [Element(body="b", volume=1.0)])


@pytest.mark.parametrize(
    "refuse",
    [refuse_by_added_mass, refuse_by_body, refuse_by_form, refuse_by_current, refuse_by_warning],
)
def test_a_refused_attach_leaves_the_model_as_it_was(refuse):
    text = floating(option='density="1000" viscosity=".001"', body='gravcomp=".5"')
    text = text.replace("</worldbody>", "</worldbody><sensor><force site='s'/></sensor>")
    text = text.replace("<geom", '<site name="s"/><geom')
    model = mujoco.MjModel.from_xml_string(text)
    before = model.__getstate__()
    with pytest.raises((ValueError, UserWarning)):
        refuse(model)
    assert model.__getstate__() == before
    assert water.attached(model) is None


# ---- gravity compensation ------------------------------------------------------------------------


def test_buoyancy_replaces_gravcomp_with_a_warning():
    spec = mujoco.MjSpec.from_string(floating("sphere", ".1", body='gravcomp="1"', density=2000.0))
    with pytest.warns(UserWarning, match="buoyancy replaces `gravcomp` of `b`; where that stands"):
        handle = water.attach(spec)
    model = handle.model()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.qacc[2] == pytest.approx(-9.81 * (2.0 - 1.0) / (2.0 + 0.5))


def test_gravcomp_stays_where_nothing_displaces_water():
    model = mujoco.MjModel.from_xml_string(floating("sphere", ".1", body='gravcomp="1"'))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        water.attach(model, [Element(body="b", drag=(1.0, 1.0, 1.0))])
    assert model.body_gravcomp[1] == 1.0


# ---- a callback that others replace --------------------------------------------------------------


def test_a_callback_that_replaces_the_water_is_noticed_at_once_and_by_the_forces():
    handle = water.attach(mujoco.MjSpec.from_string(floating("sphere", ".1")))
    data = mujoco.MjData(handle.model())
    assert abs(handle.forces(data)["buoyancy"][0, 2]) > 0.0
    ours = mujoco.get_mjcb_passive()
    try:
        with pytest.warns(UserWarning, match="models with water have lost it: another callback"):
            mujoco.set_mjcb_passive(lambda model, data: None)
        with pytest.raises(ValueError, match="but another callback has replaced it; unset that"):
            handle.forces(data)
        mujoco.set_mjcb_passive(None)
        handle = water.attach(mujoco.MjSpec.from_string(floating("sphere", ".1")))
        assert abs(handle.forces(mujoco.MjData(handle.model()))["buoyancy"][0, 2]) > 0.0
    finally:
        mujoco.set_mjcb_passive(ours)


# ---- what turns over -----------------------------------------------------------------------------


def final_tilt(model) -> float:
    data = mujoco.MjData(model)
    start = data.qpos[3:7].copy()
    mujoco.mj_forward(model, data)
    axis = data.xmat[1].reshape(3, 3).T[:, 2].copy()  # what is up, in its axes
    assert np.linalg.norm(start) > 0.0
    for _ in range(8000):
        mujoco.mj_step(model, data)
        data.qvel[:] *= 0.995
    return float(np.degrees(np.arccos((data.xmat[1].reshape(3, 3) @ axis)[2])))


@pytest.mark.parametrize(
    ("kind", "size", "euler", "turns"),
    [
        ("ellipsoid", ".3 .1 .1", "0 5 30", False),
        ("ellipsoid", ".3 .1 .1", "0 20 30", False),
        ("ellipsoid", ".3 .1 .1", "0 -40 0", False),
        ("ellipsoid", ".3 .2 .1", "15 20 70", False),
        ("box", ".3 .2 .05", "10 -15 0", False),
        ("ellipsoid", ".3 .1 .1", "0 90 0", True),
        ("ellipsoid", ".3 .1 .1", "0 85 0", True),
        ("box", ".1 .1 .3", "0 0 0", True),
        ("box", ".1 .1 .3", "3 1 0", True),
        ("cylinder", ".1 .3", "2 1 0", True),
    ],
)
@pytest.mark.parametrize("density", [300.0, 500.0, 800.0])
def test_only_what_turns_over_is_said_to_turn_over(kind, size, euler, turns, density):
    option = 'integrator="implicitfast" timestep="0.002"'
    spec = mujoco.MjSpec.from_string(
        floating(kind, size, option=option, body=f'euler="{euler}"', density=density)
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        handle = water.attach(spec, surface=0.0)
    assert any("turns over" in str(one.message) for one in caught) == turns
    if turns == ("90" not in euler and euler != "0 0 0"):
        assert (final_tilt(handle.model()) > 60.0) == turns


def test_a_model_in_centimeters_is_warned_of_as_the_water_s_density_is_not():
    spec = mujoco.MjSpec.from_string(floating("sphere", ".1", option='gravity="0 0 -981"'))
    with pytest.warns(UserWarning, match="gravity is 981: if the model is not in meters and kilo"):
        water.attach(spec)


# ---- nets and ropes ------------------------------------------------------------------------------

NET = """<mujoco><option gravity="0 0 {g}"/><worldbody>
<body name="frame" pos="0 0 -2"><freejoint/><geom size=".05" mass="1"/></body>
<flexcomp name="net" type="{kind}" count="{count}" spacing=".1 .1 .1" radius=".005" pos="0 0 -1" euler="20 30 40"
 dim="{dim}" mass=".2"><edge equality="true"/><contact selfcollide="none"/></flexcomp></worldbody></mujoco>"""


@pytest.mark.parametrize(("count", "edges"), [("5 5 1", 40), ("4 6 1", 38), ("2 2 1", 4)])
def test_a_net_in_a_current_feels_the_drag_of_its_twine_as_cylinders(count, edges):
    text = NET.format(kind="grid", count=count, dim=2, g=0)
    handle = water.attach(mujoco.MjSpec.from_string(text))
    model = handle.model()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    corners = data.flexvert_xpos
    normal = np.cross(corners[1] - corners[0], corners[-1] - corners[0])
    normal /= np.linalg.norm(normal)
    handle.set_current(tuple(0.3 * normal))
    force = handle.forces(data)["drag"][1:].sum(axis=0)
    twine = 0.5 * 1000.0 * 1.2 * 0.01 * 0.1 * edges * 0.3**2
    np.testing.assert_allclose(force, twine * normal, rtol=1e-6, atol=1e-9)
    volume = np.pi * 0.005**2 * 0.1 * edges
    assert sum(element.volume for element in handle.elements[1:]) == pytest.approx(volume)


def test_a_rope_along_the_current_feels_next_to_nothing():
    text = NET.format(kind="grid", count="8 1 1", dim=1, g=0).replace('euler="20 30 40"', "")
    handle = water.attach(mujoco.MjSpec.from_string(text), current=(0.3, 0.0, 0.0))
    along = handle.forces(mujoco.MjData(handle.model()))["drag"][1:].sum(axis=0)
    handle.set_current((0.0, 0.3, 0.0))
    across = handle.forces(mujoco.MjData(handle.model()))["drag"][1:].sum(axis=0)
    assert across[1] == pytest.approx(0.5 * 1000.0 * 1.2 * 0.01 * 0.7 * 0.3**2)
    assert along[0] == pytest.approx(across[1] * 0.05 / 1.2)


def test_a_model_of_a_net_alone_gets_water():
    text = NET.format(kind="grid", count="5 5 1", dim=2, g=-9.81)
    begin, end = text.index("<body"), text.index("<flexcomp")
    handle = water.attach(mujoco.MjSpec.from_string(text[:begin] + text[end:]))
    assert len(handle.elements) == 25


def test_a_soft_body_gets_no_water_and_one_warning_says_so():
    text = NET.format(kind="grid", count="3 3 3", dim=3, g=-9.81)
    with pytest.warns(UserWarning, match="no water acts on flexes that are neither nets .*`net`"):
        handle = water.attach(mujoco.MjSpec.from_string(text))
    assert len(handle.elements) == 1


@pytest.mark.skipif(mujoco.__version__ != "4.0.0", reason="the fault of that version alone")
def test_a_large_net_is_solved_without_the_wrong_matrices_and_without_dense_ones():
    text = NET.format(kind="grid", count="12 12 1", dim=2, g=-9.81)
    with pytest.warns(UserWarning, match="438 degrees of freedom, the solver CG replaces Newton"):
        handle = water.attach(mujoco.MjSpec.from_string(text))
    model = handle.model()
    data = mujoco.MjData(model)
    for _ in range(3):
        mujoco.mj_step(model, data)
    assert np.all(np.isfinite(data.qpos)) and mujoco.mj_isSparse(model)


# ---- speed ---------------------------------------------------------------------------------------


def test_the_nodes_of_lamb_s_integrals_are_computed_once(monkeypatch):
    lamb((1.0, 2.0, 3.0))

    def refuse(n_nodes: int):
        raise AssertionError(n_nodes)

    monkeypatch.setattr(np.polynomial.legendre, "leggauss", refuse)
    np.testing.assert_allclose(lamb((1.0, 1.0, 1.0)).mass, 0.5, rtol=1e-12)
