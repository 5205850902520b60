"""Do models that others made swim and float by one line, `water.attach(model)`, without energy from nowhere?

Each is driven for 10 s by sines on its actuators. The energy is that of the bodies and of the water
that they take along, with weight, buoyancy and springs; all but the actuators can only take from
it. dm_control's two need its package, and Gymnasium's its own:
`python campaigns/mujoco_neighbours.py` runs this script beside each. `--films FOLDER` stores eight
pictures of each as an array.

Last answer ("surplus": the most that the energy was ever above its start and the actuators' work,
over the energy that they turned over):

    dm_control's fish (MuJoCo 3.17)      5 elements, 0.03 m away, work   0.014 J, surplus -1.3e-06
    dm_control's swimmer (MuJoCo 3.17)   6 elements, work   0.001 J, surplus  4.0e-14
    Gymnasium's Swimmer                  3 elements, 0.71 m away, work 801.105 J, surplus -4.0e-08
    a quadruped that floats              9 elements, 0.93 m away, work 169.922 J, all finite
    a hull with thrusters                2 elements, 3.45 m away, work -0.011 J (1.842 turned over), surplus -2.1e-05
"""

import argparse
import math
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from laticauda.water import mujoco as water

QUADRUPED = """<mujoco><option timestep="0.002"/><worldbody><light pos="0 0 3"/><body name="trunk" pos="0 0 -0.03">
<freejoint/><geom type="box" size=".25 .1 .06" density="450"/>{legs}</body></worldbody>
<actuator>{motors}</actuator></mujoco>"""
LEG = """<body pos="{x} {y} 0"><joint name="{n}h" axis="0 1 0" damping=".3" range="-60 60"/>
<geom type="capsule" size=".025" fromto="0 0 0 0 0 -.18" density="1100"/>
<body pos="0 0 -.2"><joint name="{n}k" axis="0 1 0" damping=".2" range="-100 0"/>
<geom type="capsule" size=".02" fromto="0 0 0 0 0 -.16" density="1100"/></body></body>"""
AUV = """<mujoco><option timestep="0.005"/><worldbody><light pos="0 0 3"/><body name="hull" pos="0 0 -2"><freejoint/>
<geom name="hull" type="capsule" size=".1 .6" euler="0 90 0" density="985"/>
<geom name="ballast" type="box" size=".3 .03 .02" pos="0 0 -.07" density="1700"/>
<geom name="mast" type="cylinder" size=".02 .1" pos=".2 0 .19" density="400"/>
<site name="port" pos="-.6 .15 0"/><site name="starboard" pos="-.6 -.15 0"/><site name="lift" pos=".1 0 0"/></body>
</worldbody><actuator><motor site="port" gear="1 0 0 0 0 0"/><motor site="starboard" gear="1 0 0 0 0 0"/>
<motor site="lift" gear="0 0 1 0 0 0"/></actuator></mujoco>"""


def quadruped() -> mujoco.MjModel:
    """Four legs of two hinges, lighter than water: it floats and paddles."""
    places = {
        f"{a}{b}": (x, y)
        for a, x in (("f", 0.2), ("h", -0.2))
        for b, y in (("l", 0.13), ("r", -0.13))
    }
    legs = "".join(LEG.format(n=n, x=x, y=y) for n, (x, y) in places.items())
    motors = "".join(f'<motor joint="{n}{j}" gear="1.5"/>' for n in places for j in "hk")
    return mujoco.MjModel.from_xml_string(QUADRUPED.format(legs=legs, motors=motors))


def strangers() -> Iterator[tuple[str, Any, Any, float | None]]:
    """Name, what holds the model, the model, and the height of the surface."""
    try:
        from dm_control import suite

        for domain, task in (("fish", "swim"), ("swimmer", "swimmer6")):
            environment = suite.load(domain, task)
            environment.reset()
            yield f"dm_control's {domain}", environment, environment.physics.model, None
    except ImportError:
        print("dm_control is not here")
    try:
        import gymnasium

        environment = gymnasium.make("Swimmer-v5")
        environment.reset(seed=0)
        yield "Gymnasium's Swimmer", environment, environment.unwrapped.model, None
    except ImportError:
        print("Gymnasium is not here")
    yield "a quadruped that floats", None, quadruped(), 0.0
    yield "a hull with thrusters", None, mujoco.MjModel.from_xml_string(AUV), None


def energy(model: Any, data: Any, handle: water.Water) -> float:
    """Of the bodies and of the water with them [J]."""
    mujoco.mj_forward(model, data)
    mujoco.mj_energyPos(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    total = float(data.energy[0]) + 0.5 * data.qvel @ inertia @ data.qvel
    if (
        handle.options["surface"] is None
        and not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
    ):
        density = handle.options["density"]
        for element in handle.elements:
            body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, element.body)
            body = int(element.body) if body < 0 else body
            place = data.xpos[body] + data.xmat[body].reshape(3, 3) @ element.position
            total += density * element.volume * float(np.dot(model.opt.gravity, place))
    return total


def run(name: str, model: Any, surface: float | None, films: Path | None) -> None:
    """10 s; prints a row."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        handle = water.attach(model, surface=surface)
    model = getattr(model, "ptr", model)
    data = mujoco.MjData(model)
    begin = energy(model, data, handle) if surface is None else math.nan
    work, turned, surplus, step, frames = 0.0, 0.0, -math.inf, model.opt.timestep, []
    renderer = mujoco.Renderer(model, 360, 640) if films else None
    low, high = np.where(
        model.actuator_ctrllimited[:, None], model.actuator_ctrlrange, [-1.0, 1.0]
    ).T
    phase = np.arange(model.nu) * 1.0
    for i in range(round(10.0 / step)):
        data.ctrl[:] = 0.5 * (low + high) + 0.4 * (high - low) * np.sin(
            2.0 * math.pi * i * step + phase
        )
        before = data.qvel.copy()
        mujoco.mj_step(model, data)
        power = float(data.qfrc_actuator @ (0.5 * (before + data.qvel)))
        work, turned = work + power * step, turned + abs(power) * step
        if surface is None and i % 20 == 0:
            copied = mujoco.MjData(model)
            copied.qpos[:], copied.qvel[:] = data.qpos, data.qvel
            surplus = max(surplus, energy(model, copied, handle) - begin - work)
        if renderer is not None and i % max(1, round(0.05 / step)) == 0:
            camera = mujoco.MjvCamera()
            mujoco.mjv_defaultFreeCamera(model, camera)
            camera.lookat[:] = data.subtree_com[1]
            camera.distance = (
                3.0 * model.stat.extent if model.nbody < 12 else 1.2 * model.stat.extent
            )
            renderer.update_scene(data, camera)
            frames.append(renderer.render())
    far = float(np.linalg.norm(data.subtree_com[1] - mujoco_start(model)))
    finite = bool(np.all(np.isfinite(data.qpos))) and not any(w.number for w in data.warning)
    share = surplus / max(turned, 1e-9)
    print(
        f"{name:26} {len(handle.elements):3} elements, {far:5.2f} m away, work {work:8.3f} J "
        f"({turned:8.3f} turned over), surplus {share:9.1e}, finite {finite}, {len(said)} warnings"
    )
    for one in said:
        print(f"    {one.message}")
    if films is not None and frames:
        films.mkdir(parents=True, exist_ok=True)
        strip = np.concatenate(
            [np.concatenate(frames[k : k + 4 * 25 : 25], axis=1) for k in (0, 100)], axis=0
        )
        np.save(films / f"{name.replace(' ', '-')}.npy", strip)


def mujoco_start(model: Any) -> np.ndarray:
    """Where the center of mass of the first tree is in the reference pose [m]."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data.subtree_com[1].copy()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--films", type=Path)
    films = parser.parse_args().films
    for name, _environment, model, surface in strangers():
        run(name, model, surface, films)
