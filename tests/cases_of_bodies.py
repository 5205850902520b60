"""Cases from the field about bodies in water: what `attach` makes of a model; each has its source in tests/cases."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import laticauda as lc
from laticauda.cli import main
from laticauda.water import mujoco as water
from laticauda.water.fluid.laws import PolynomialDrag
from laticauda.water.mujoco import Element, GeomCoefficients
from laticauda.water.mujoco.hydrostatics import CYLINDER, wetted
from laticauda.water.mujoco.lamb import lamb

CASES = Path(__file__).parent / "cases"
RHO = 1000.0
GRAVITY = 9.81
FAST = 'integrator="implicitfast" timestep="0.002"'
EXACT = 'integrator="RK4" timestep="0.002"'
SPHERE_DRAG = 1.17 / 2.5


def spec_of(body: str, option: str = FAST) -> Any:
    """A model with a body in its world."""
    text = f"<mujoco><option {option}/><worldbody>{body}</worldbody></mujoco>"
    return mujoco.MjSpec.from_string(text)


def ball(radius: float, density: float, *, inside: str = "", pos: str = "0 0 0") -> str:
    return (
        f'<body name="b" pos="{pos}"><freejoint/>'
        f'<geom name="g" size="{radius}" density="{density}"/>{inside}</body>'
    )


def wet_model(body: str, elements: Any = None, option: str = FAST, **settings: Any) -> Any:
    """A model in water, of which nothing is warned."""
    return water.attach(spec_of(body, option), elements, **settings)


def run(model: Any, duration: float, data: Any = None) -> Any:
    if data is None:
        data = mujoco.MjData(model)
    for _ in range(round(duration / model.opt.timestep)):
        mujoco.mj_step(model, data)
    assert np.all(np.isfinite(data.qvel))
    return data


def accelerate(model: Any) -> np.ndarray:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data.qacc.copy()


def element_of(geom: str, density: float = RHO) -> Element:
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><worldbody><body><freejoint/><geom {geom}/></body></worldbody></mujoco>"
    )
    return water.geom_element(model, 0, density=density)


def up_of(data: Any) -> np.ndarray:
    """What of the body's axes points upward."""
    return data.xmat[1].reshape(3, 3)[2]


# ---- failing on 80cdc20a -------------------------------------------------------------------------


def case_f12_compiled_inertiafromgeom(_):
    file = CASES / "f12_compiled_inertiafromgeom" / "model.xml"
    compiled = water.compile_spec(mujoco.MjSpec.from_file(str(file)))
    handles = (water.attach(compiled), water.attach(file), water.attach(str(file)))
    for handle in handles:
        model = handle.model()
        data = mujoco.MjData(model)
        data.xfrc_applied[1, 0] = 1.0
        mujoco.mj_forward(model, data)
        mass = RHO * 4.0 / 3.0 * math.pi * 0.1**3
        assert data.qacc[:3] == pytest.approx([1.0 / (1.5 * mass), 0.0, 0.0], abs=1e-9)


def case_f13_flex_scene(folder):
    """It runs, and its net is far away: at the same time step, as without it."""
    file = CASES / "f13_flex_scene" / "flex.xml"
    words = "swim --robot mamba --model spatial --duration 0.2 --dt 0.004".split()
    ways: list[Any] = []
    for name, scene in (("net.nc", ["--scene", str(file)]), ("open.nc", [])):
        assert main([*words, *scene, "--save", str(folder / name)]) == 0
        ways.append(lc.load_trial(folder / name))
    np.testing.assert_allclose(ways[0].center_of_mass, ways[1].center_of_mass, atol=1e-12)
    assert np.all(ways[0].link_force["contact"] == 0.0)


def case_f15_disc_added_mass(_):
    model = mujoco.MjModel.from_xml_path(str(CASES / "f15_disc_added_mass" / "model.xml"))
    disc = water.geom_element(model, 0)
    assert disc.added_mass[0] == pytest.approx(8.0 / 3.0 * RHO * 0.25**3, rel=0.03)
    plate = element_of('type="box" size=".25 .25 .0025"')
    assert plate.added_mass[2] == pytest.approx(0.579 * RHO * math.pi / 4.0 * 0.5**3, rel=0.03)


def case_f17_callback_replaced(_):
    handle = wet_model(ball(0.1, RHO))
    data = mujoco.MjData(handle.model())
    mujoco.mj_forward(handle.model(), data)
    assert data.qacc[2] == pytest.approx(0.0, abs=1e-12)
    ours = mujoco.get_mjcb_passive()
    try:
        with pytest.warns(UserWarning, match="models with water have lost it: another callback"):
            mujoco.set_mjcb_passive(lambda model, data: None)
        assert not handle.active
        with pytest.raises(ValueError, match="but another callback has replaced it; unset that"):
            handle.forces(data)
    finally:
        mujoco.set_mjcb_passive(ours)


def case_f19_turns_over_tilted(_):
    file = CASES / "f19_turns_over_tilted" / "model.xml"
    for pitch in ("20", "5"):
        text = file.read_text().replace("0 20 30", f"0 {pitch} 30")
        # A warning that it turns over would be an error here.
        model = water.attach(mujoco.MjSpec.from_string(text), surface=0.0).model()
        data = mujoco.MjData(model)
        for _ in range(4000):
            mujoco.mj_step(model, data)
            data.qvel[:] *= 0.99
        axis = data.xmat[1].reshape(3, 3)[:, 0]
        assert abs(axis[2]) < math.sin(math.radians(1.0))


def case_f21_refused_attach_changes_model(_):
    text = (CASES / "f21_refused_attach_changes_model" / "model.xml").read_text()
    ellipsoid = text.replace('size=".1"', 'type="ellipsoid" size=".3 .2 .1"')
    model = mujoco.MjModel.from_xml_string(ellipsoid)
    before = model.__getstate__()
    with pytest.raises(ValueError, match="attach the water to its file or `MjSpec` instead"):
        water.attach(model)
    assert (model.opt.density, model.opt.viscosity) == (1000.0, 0.001)
    assert model.__getstate__() == before


def case_g01_slender_yaw_added_inertia(_):
    right = {
        'type="cylinder" size=".05 .25"': 0.0579,
        'type="cylinder" size=".05 .1"': 0.00241,
        'type="capsule" size=".05 .2"': 0.0455,
        'type="capsule" size=".0955 .5695"': 3.74,
    }
    for geom, inertia in right.items():
        about_axis, *across = element_of(geom).added_inertia
        assert about_axis == 0.0
        assert across == pytest.approx([inertia, inertia], rel=0.04)


def case_g02_box_hull_added_inertia(_):
    right = {
        ".2285 .169 .127": (0.171, 0.340, 0.266),
        ".1 .1 .1": (0.0127, 0.0127, 0.0127),
        ".25 .05 .05": (0.00233, 0.0833, 0.0833),
    }
    for size, inertia in right.items():
        found = element_of(f'type="box" size="{size}"').added_inertia
        assert found == pytest.approx(inertia, rel=0.06)
    # 0.5 N m for 0.5 s on 11.5 kg turn the hull at 28 deg/s; its drag takes little of it.
    hull = """<body name="b"><freejoint/><inertial pos="0 0 0" mass="11.5" diaginertia=".16 .2 .245"/>
    <geom type="box" size=".2285 .169 .127"/></body>"""
    model = wet_model(hull, option=f'{FAST} gravity="0 0 0"').model()
    data = mujoco.MjData(model)
    data.xfrc_applied[1, 5] = 0.5
    run(model, 0.5, data)
    assert math.degrees(data.qvel[5]) == pytest.approx(28.0, rel=0.06)


def float_for(body: str, times: Sequence[float]) -> list[tuple[float, np.ndarray, np.ndarray]]:
    """Heading, position and rates of a floating body at some times."""
    model = wet_model(body, surface=0.0).model()
    data = mujoco.MjData(model)
    seen: list[tuple[float, np.ndarray, np.ndarray]] = []
    for time in times:
        run(model, time - data.time, data)
        w, x, y, z = data.qpos[3:7]
        heading = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        seen.append((math.degrees(heading), data.qpos[:3].copy(), data.qvel.copy()))
    return seen


def case_g07_floating_body_never_stops(_):
    """Rolling, pitching and heaving die out in tens of seconds, by the waves that a body makes.

    What they left as drift and yaw goes on slowly: at these Reynolds numbers (3000 and 10 000) a
    laminar boundary layer needs ten minutes and more to end it, which nothing here models.
    """
    box = '<freejoint/><geom type="box" size=".5 .2 .1" density="400"/>'
    level = f'<body name="b" pos="0 0 .02">{box}</body>'
    ((heading, place, rates),) = float_for(level, [60.0])
    assert heading == 0.0
    assert place == pytest.approx([0.0, 0.0, 0.02], abs=1e-5)
    assert np.max(np.abs(rates)) < 1e-6
    tilted = f'<body name="b" pos="0 0 .02" euler="4 3 0">{box}</body>'
    (before, _, _), (after, _, rates) = float_for(tilted, [20.0, 80.0])
    assert abs(after - before) < 4.0  # deg; it was 11.8
    assert np.max(np.abs(rates[[2, 3, 4]])) < 1e-4
    vehicle = """<body name="b" pos="0 0 -.3"><freejoint/>
    <geom type="capsule" size=".15 1" zaxis="1 0 0" density="950"/>
    <geom type="box" size=".05 .15 .01" pos="-1 0 0" density="950" contype="0" conaffinity="0"/></body>"""
    ((_, _, rates),) = float_for(vehicle, [60.0])
    assert abs(rates[2]) < 2e-3 and np.max(np.abs(rates[3:])) < 2e-3


# ---- right on 80cdc20a ---------------------------------------------------------------------------


def case_p02_ballast(_):
    model = wet_model(ball(0.1, RHO)).model()
    model.body_mass[1] += 0.5
    assert accelerate(model)[2] == pytest.approx(-0.7231116, abs=1e-7)


def case_p03_rotated_cylinder(_):
    size = 'type="cylinder" size=".1 .3" density="500"'
    ways = (
        f'<body name="b" euler="0 90 0"><freejoint/><geom {size}/></body>',
        f'<body name="b"><freejoint/><geom {size} euler="0 90 0"/></body>',
        f'<body name="b"><freejoint/><geom {size} zaxis="1 0 0"/></body>',
        '<body name="b"><freejoint/><geom type="capsule" size=".1" fromto="-.3 0 0 .3 0 0" density="500"/></body>',
    )
    for body in ways:
        handle = wet_model(body, surface=0.0)
        data = run(handle.model(), 2.0)
        assert data.qpos[2] == pytest.approx(0.0, abs=1e-4)
        weight = handle.model().body_mass[1] * GRAVITY
        lift = handle.forces(data)["buoyancy"][:, 2].sum()
        assert lift / weight == pytest.approx(1.0, abs=1e-5)


def case_p05_offset_geom(_):
    body = '<body name="b"><freejoint/><geom size=".1" pos=".3 0 0" density="500"/></body>'
    model = wet_model(body, surface=0.0).model()
    data = run(model, 4.0)
    assert data.geom_xpos[0][2] == pytest.approx(0.0, abs=3e-3)


def case_p06_small_and_slow(_):
    for radius in (0.1, 0.01, 1e-3, 1e-4):
        sphere = f'<geom size="{radius}" mass="1"/>'
        body = f'<body name="b"><freejoint/>{sphere}</body>'
        handle = wet_model(body, option=f'{FAST} gravity="0 0 0"')
        data = mujoco.MjData(handle.model())
        for speed in (1.0, 1e-3, 1e-6):
            data.qvel[0] = speed
            share = handle.forces(data)["drag"][0, 0] / (speed * radius) ** 2
            assert share == pytest.approx(-0.5 * RHO * SPHERE_DRAG * math.pi, rel=1e-11)


def case_p08_include_meshdir(folder, monkeypatch):
    """The file that it includes is elsewhere, as are its meshes and the folder where the run begins."""
    (folder / "parts" / "meshes").mkdir(parents=True)
    (folder / "elsewhere").mkdir()
    corners = [(x, y, z) for x in (0, 0.1) for y in (-0.5, 0.5) for z in (-0.3, 0.3)]
    mesh = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
    faces = ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
    mesh += "".join(f"f {face}\n" for face in faces)
    (folder / "parts" / "meshes" / "wall.obj").write_text(mesh)
    asset = '<asset><mesh name="w" file="wall.obj"/></asset>'
    wall = '<worldbody><geom type="mesh" mesh="w" pos=".9 0 -.5"/></worldbody>'
    part = f"<mujoco>{asset}{wall}</mujoco>"
    (folder / "parts" / "part.xml").write_text(part)
    include = '<compiler meshdir="parts/meshes"/><include file="parts/part.xml"/>'
    (folder / "scene.xml").write_text(f"<mujoco>{include}</mujoco>")
    plain = f'<mujoco><compiler meshdir="meshes"/>{asset}{wall}</mujoco>'
    (folder / "parts" / "plain.xml").write_text(plain)
    gait = lc.lateral_undulation(amplitude=0.3, frequency=3.0, phase_shift=0.7)
    monkeypatch.chdir(folder / "elsewhere")
    included, together = (
        lc.swim("mamba", gait, 0.5, model="spatial", scene=str(scene))
        for scene in ("../scene.xml", folder / "parts" / "plain.xml")
    )
    assert included.center_of_mass.tobytes() == together.center_of_mass.tobytes()


def case_p09_medium_replaced(_):
    spec = spec_of(ball(0.1, 2.0 * RHO), f'{FAST} density="1000" viscosity=".001"')
    with pytest.warns(UserWarning, match=r"replaces MuJoCo's own medium of 1000 kg/m\^3"):
        handle = water.attach(spec)
    model = handle.model()
    assert (model.opt.density, model.opt.viscosity) == (0.0, 0.0)
    assert accelerate(model)[2] == pytest.approx(-GRAVITY * (2.0 - 1.0) / (2.0 + 0.5))


def case_p20_runtime_current(_):
    handle = wet_model(ball(0.05, RHO))
    handle.set_current((0.3, 0.0, 0.0))
    data = run(handle.model(), 60.0)
    rate = 0.375 * SPHERE_DRAG / (1.5 * 0.05)
    assert data.qvel[0] == pytest.approx(0.3 - 0.3 / (1.0 + 0.3 * rate * 60.0), rel=1e-3)
    assert data.qvel[0] == pytest.approx(0.293, abs=5e-4)


def case_p21_lamb_table(_):
    table = {1.5: (0.305, 0.621, 0.094), 2.0: (0.209, 0.702, 0.240)}
    table |= {5.0: (0.059, 0.895, 0.701), 10.0: (0.021, 0.960, 0.883)}
    for slenderness, (along, across, turning) in table.items():
        mass, inertia = lamb((slenderness, 1.0, 1.0))
        # Lamb's slenderness is rounded, too: 1.99, 4.99, 9.97.
        assert mass == pytest.approx([along, across, across], abs=3e-3)
        displaced = (slenderness**2 + 1.0) / 5.0
        assert inertia[1] / displaced == pytest.approx(turning, abs=2e-3)


def case_p23_terminal_speed(_):
    data = run(wet_model(ball(0.05, 2700.0)).model(), 4.0)
    assert data.qvel[2] == pytest.approx(-2.17974, abs=1e-5)


def case_p24_gravity_direction(_):
    elements = [Element(body="b", volume=1.5 * 4.0 / 3.0 * math.pi * 0.1**3)]
    handle = wet_model(ball(0.1, RHO), elements, f'{FAST} gravity="0 -9.81 0"')
    assert accelerate(handle.model())[:3] == pytest.approx([0.0, 4.905, 0.0])


def case_q01_added_mass_above_body_mass(_):
    mass = RHO * 4.0 / 3.0 * math.pi * 0.1**3
    for integrator in ("Euler", "RK4", "implicitfast"):
        for ratio in (1.0, 10.0, 100.0, 1e4):
            added = ratio * mass
            elements = [Element(body="b", added_mass=(added, added, added))]
            option = f'integrator="{integrator}" timestep="0.002" gravity="0 0 0"'
            model = wet_model(ball(0.1, RHO), elements, option).model()
            data = mujoco.MjData(model)
            data.xfrc_applied[1, 0] = 1.0
            run(model, 2.0, data)
            assert data.qvel[0] * (mass + added) == pytest.approx(2.0, rel=1e-12)


def case_q03_off_diagonal_added_mass(_):
    element = Element(body="b", position=(0.1, 0.0, 0.0), added_mass=(0.01, 0.0140589, 0.0140589))
    model = wet_model(ball(0.1, RHO), [element]).model()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    matrix = np.zeros((6, 6))
    mujoco.mj_fullM(model, data, matrix)
    assert matrix[1, 5] == pytest.approx(0.00140589, rel=1e-12)
    np.testing.assert_array_equal(matrix, matrix.T)


def case_q04_sinks_straight(_):
    speeds: list[float] = []
    for density in (1100.0, 900.0):
        geom = f'<geom type="ellipsoid" size=".3 .1 .1" density="{density}"/>'
        model = wet_model(f'<body name="b"><freejoint/>{geom}</body>').model()
        data = run(model, 20.0)
        assert data.qpos[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
        assert up_of(data)[2] == pytest.approx(1.0, abs=1e-12)
        speeds.append(data.qvel[2])
    assert speeds[0] == pytest.approx(-speeds[1], rel=3e-7)


def case_q05_heading_and_compound(_):
    speeds: list[float] = []
    for heading in (0, 30, 90, 137, 250):
        geoms = (
            '<geom type="ellipsoid" size=".3 .1 .1" pos=".1 0 0" density="1100"/>'
            '<geom type="box" size=".1 .2 .05" pos="-.3 0 .02" density="1100"/>'
        )
        body = f'<body name="b" euler="0 0 {heading}"><freejoint/>{geoms}</body>'
        model = wet_model(body).model()
        data = run(model, 3.0)
        speeds.append(float(np.linalg.norm(data.qvel[:3])))
    assert speeds == pytest.approx([speeds[0]] * 5, rel=1e-12)


def case_q07_foam_buoyancy_alone(_):
    mass = RHO * 4.0 / 3.0 * math.pi * 0.1**3
    volume = mass / RHO * (1.0 + 10.736015954477 / GRAVITY)
    model = wet_model(ball(0.1, RHO), [Element(body="b", volume=volume)]).model()
    assert accelerate(model) == pytest.approx([0, 0, 10.736015954477, 0, 0, 0], abs=1e-11)


def segment(height: float) -> float:
    """The share of a circle below a height over the radius."""
    return 0.5 + (math.asin(height) + height * math.sqrt(1.0 - height**2)) / math.pi


def case_q08_cylinder_hull_draft(_):
    half = (0.5, 0.1, 0.1)
    for depth in (-0.99, -0.8, -0.5, -0.2, 0.0, 0.2, 0.5, 0.8, 0.99):
        share = wetted(CYLINDER, half, (0.0, 0.0, 1.0), 0.1 * depth)[0]
        assert share == pytest.approx(segment(depth), abs=2e-5)
    rng = np.random.default_rng(1)
    cube = rng.uniform(-1.0, 1.0, (200_000, 3))
    points = cube[np.sum(cube[:, 1:] ** 2, axis=1) < 1.0] * half
    for pitch, roll, depth in (
        (10, 0, 0.02),
        (30, 40, 0.1),
        (60, 0, -0.1),
        (85, 10, 0),
        (0, 45, 0),
    ):
        p, r = math.radians(pitch), math.radians(roll)
        up = (math.sin(p), math.cos(p) * math.sin(r), math.cos(p) * math.cos(r))
        share, *center = wetted(CYLINDER, half, up, depth)
        under = points[points @ up < depth]
        assert share == pytest.approx(len(under) / len(points), abs=0.004)
        assert center == pytest.approx(under.mean(axis=0), abs=0.006)


def case_q17_remus_ellipsoid(_):
    sea = 1030.0
    element = element_of('type="ellipsoid" size=".665 .0955 .0955"', sea)
    found = (element.added_mass[0], element.added_mass[1], element.added_inertia[2])
    # Closed form of a prolate spheroid (Lamb, articles 114 and 115).
    a, b = 0.665, 0.0955
    e = math.sqrt(1.0 - (b / a) ** 2)
    log = math.log((1.0 + e) / (1.0 - e))
    alpha = 2.0 * (1.0 - e**2) / e**3 * (0.5 * log - e)
    beta = 1.0 / e**2 - (1.0 - e**2) / (2.0 * e**3) * log
    mass = sea * 4.0 / 3.0 * math.pi * a * b**2
    turning = e**4 * (beta - alpha)
    turning /= (2.0 - e**2) * (2.0 * e**2 - (2.0 - e**2) * (beta - alpha))
    inertia = 0.2 * mass * (a**2 + b**2) * turning
    right = (mass * alpha / (2.0 - alpha), mass * beta / (2.0 - beta), inertia)
    assert found == pytest.approx(right, rel=1e-6)
    assert found == pytest.approx((0.946, 24.40, 1.902), rel=6e-4)


def acrobot_inertia(q: Sequence[complex]) -> np.ndarray:
    """M + A of two links of 1 m, whose ellipsoids hang at their middles: by hand, for angles from below."""
    along, across, own, turning = 0.4, 3.0, 0.09, 0.05
    matrix = np.zeros((2, 2), dtype=complex)
    columns = np.array([[1.0, 0.0], [1.0, 1.0]])
    for link in range(2):
        angle = q[0] + link * q[1]
        axis = np.array([np.sin(angle), -np.cos(angle)])
        normal = np.array([np.cos(angle), np.sin(angle)])
        first = np.array([np.cos(q[0]), np.sin(q[0])])
        jacobian = 0.5 * np.outer(normal, columns[link])
        if link == 1:
            jacobian = jacobian + np.outer(first, columns[0])
        spread = along * np.outer(axis, axis) + across * np.outer(normal, normal) + 2.0 * np.eye(2)
        matrix += jacobian.T @ spread @ jacobian
        matrix += (own + turning) * np.outer(columns[link], columns[link])
    return matrix


def acrobot_rates(_: float, state: np.ndarray) -> np.ndarray:
    """Lagrange's equations; slopes of M by complex steps; each link weighs 2 kg and displaces 1.2 l."""
    q, v = state[:2], state[2:]
    slopes = [np.imag(acrobot_inertia(q + 1e-30j * np.eye(2)[k])) / 1e-30 for k in range(2)]
    matrix = np.real(acrobot_inertia(q))
    turned = sum(slopes[k] * v[k] for k in range(2)) @ v
    energy = np.array([0.5 * v @ slopes[k] @ v for k in range(2)])
    lever = 0.5 * math.sin(q[0] + q[1])
    load = (2.0 - 1.2) * GRAVITY
    weight = load * np.array([1.5 * math.sin(q[0]) + lever, lever])
    return np.concatenate([v, np.linalg.solve(matrix, energy - turned - weight)])


def case_q18_underwater_acrobot(_):
    def link(number: int, pos: str, inside: str) -> str:
        return (
            f'<body name="l{number}" pos="{pos}"><joint axis="0 -1 0"/>'
            f'<inertial pos="0 0 -.5" mass="2" diaginertia=".09 .09 .01"/>{inside}</body>'
        )

    text = link(1, "0 0 0", link(2, "0 0 -1", ""))
    elements = [
        Element(
            body=f"l{number}",
            position=(0.0, 0.0, -0.5),
            added_mass=(3.0, 3.0, 0.4),
            added_inertia=(0.05, 0.05, 0.0),
            volume=1.2e-3,
        )
        for number in (1, 2)
    ]
    with pytest.warns(UserWarning, match="has buoyancy but no free joint"):
        model = wet_model(text, elements, 'integrator="RK4" timestep="0.001"').model()
    data = mujoco.MjData(model)
    data.qpos[:] = start = (2.0, -0.7)
    run(model, 5.0, data)
    solved = solve_ivp(acrobot_rates, (0.0, 5.0), (*start, 0.0, 0.0), rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose([*data.qpos, *data.qvel], solved.y[:, -1], atol=1e-8)


def energy_of(model: Any, data: Any) -> float:
    """Energy of a ball of half the water's density and of the water that moves with it."""
    z, speed = data.qpos[2], data.qvel[2]
    radius = float(model.geom_size[0, 0])
    mass = float(model.body_mass[1])
    share, *_ = wetted(0, (radius,) * 3, (0.0, 0.0, 1.0), -z)
    heights = np.linspace(-radius, max(-radius, min(radius, -z)), 2001)
    area = math.pi * (radius**2 - heights**2)
    raised = RHO * GRAVITY * float(np.trapezoid(area * (heights + z), heights))
    return 0.5 * (mass + share * mass) * speed**2 + mass * GRAVITY * z - raised


def case_q21_water_exit_and_entry(_):
    radius = GRAVITY * (1.0274 / (2.0 * math.pi)) ** 2
    still = GeomCoefficients(drag=(0.0, 0.0, 0.0))
    for drag in (still, None):
        for height in (0.5, -1.0):
            spec = spec_of(ball(radius, 500.0, pos=f"0 0 {height}"), EXACT)
            elements = water.geom_elements(spec.compile(), drag)
            model = water.attach(spec, elements, surface=0.0).model()
            data = mujoco.MjData(model)
            energy = [energy_of(model, data)]
            for _ in range(1500):
                mujoco.mj_step(model, data)
                energy.append(energy_of(model, data))
            gained = np.max(np.maximum.accumulate(energy) - energy[0])
            assert gained < 1e-3 * np.ptp(energy)
    spec = spec_of(ball(radius, 500.0, pos="0 0 .001"), EXACT)
    elements = water.geom_elements(spec.compile(), still)
    model = water.attach(spec, elements, surface=0.0).model()
    data = mujoco.MjData(model)
    crossings: list[float] = []
    before = data.qpos[2]
    while len(crossings) < 5:
        mujoco.mj_step(model, data)
        if before > 0.0 >= data.qpos[2]:
            crossings.append(data.time)
        before = data.qpos[2]
    assert (crossings[-1] - crossings[0]) / 4.0 == pytest.approx(1.0274, rel=2e-3)


def swim_fish(base: str, axes: str) -> np.ndarray:
    """The path of a fish with a driven tail, in the axes in which it began."""
    text = f"""<mujoco><compiler angle="degree"/><option {EXACT} gravity="0 0 0"/><worldbody>
    <body name="b" {base}>{axes}<geom type="ellipsoid" size=".2 .05 .1"/>
    <body name="t" pos="-.2 0 0"><joint name="j" axis="0 0 1" damping=".02"/>
    <geom type="ellipsoid" size=".1 .01 .08" pos="-.1 0 0"/></body></body></worldbody>
    <actuator><motor joint="j"/></actuator></mujoco>"""
    model = water.attach(mujoco.MjSpec.from_string(text)).model()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    turned, start = data.xmat[1].reshape(3, 3).copy(), data.xpos[1].copy()
    path: list[np.ndarray] = []
    for _ in range(1000):
        data.ctrl[0] = 0.3 * math.sin(8.0 * data.time)
        mujoco.mj_step(model, data)
        path.append((data.xpos[1] - start) @ turned)
    return np.array(path)


def case_q23_planar_fish_rotated_base(_):
    slides = """<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
    <joint axis="0 0 1"/>"""
    plain = swim_fish("", slides)
    assert np.ptp(plain, axis=0)[0] > 0.01
    for base, axes in (
        ('euler="0 0 180"', slides),
        ('euler="0 0 37" pos="3 2 1"', slides),
        ("", "<freejoint/>"),
    ):
        np.testing.assert_allclose(swim_fish(base, axes), plain, atol=1e-11)


def case_q29_bluerov_forum_divergence(_):
    """Coefficients as published for the BlueROV2 (T.-H. Wu, 2018): linear and quadratic, added mass and inertia."""
    hull = """<body name="b"><freejoint/><inertial pos="0 0 0" mass="11.5" diaginertia=".16 .16 .16"/>
    <geom type="box" size=".2285 .169 .127" mass="0"/></body>"""
    at = (0.0, 0.0, 0.02)
    linear = Element(
        body="b",
        drag=(4.03, 6.22, 5.18),
        torque_linear=(0.07, 0.07, 0.07),
        law=PolynomialDrag(reference_speed=1.0, quadratic=False),
    )
    quadratic = Element(
        body="b",
        drag=(18.18, 21.66, 36.99),
        torque_quadratic=(1.55, 1.55, 1.55),
        added_mass=(5.5, 12.7, 14.57),
        added_inertia=(0.12, 0.12, 0.12),
    )
    foam = Element(body="b", position=at, volume=0.0115)
    thrust = Element(body="b", thrust=(20.0, 0.0, 0.0))
    for integrator, step in (("Euler", 0.005), ("implicitfast", 0.005), ("RK4", 0.01)):
        option = f'integrator="{integrator}" timestep="{step}"'
        model = wet_model(
            hull, (linear, quadratic, foam, thrust), option, current=(0.3, -0.2, 0.1)
        ).model()
        data = mujoco.MjData(model)
        data.qvel[:] = (2.0, -1.5, 1.0, 3.0, -4.0, 5.0)
        fastest = 0.0
        for _ in range(round(60.0 / step)):
            mujoco.mj_step(model, data)
            fastest = max(fastest, float(np.linalg.norm(data.qvel[:3])))
        assert fastest < 2.75
        assert float(np.linalg.norm(data.qvel[:3])) < 1.5
    with pytest.warns(UserWarning, match=r"`timestep` 0.05 s is too large for the drag"):
        wet_model(hull, (linear, quadratic, foam), 'integrator="Euler" timestep="0.05"')


BODIES: dict[str, Callable[..., None]] = {
    name: value for name, value in globals().items() if name.startswith("case_")
}
