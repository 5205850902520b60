"""Robots in water that moves in space and time: the planar model and the twin are one, and no frame is special."""

from dataclasses import replace

import numpy as np
import pytest
from flow_laws import Moving

import laticauda as lc
from laticauda.models.planar import rows
from laticauda.water.fluid.flow import Flow

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.2, phase_shift=0.7)
STILL = lc.load_water("paper-lateral")


WAVES = Moving(amplitude=0.03)
SHEAR = Moving(shear=0.15, v_x=0.05)


@pytest.mark.parametrize("flow", [WAVES, SHEAR], ids=["waves", "shear"])
@pytest.mark.parametrize("robot", ["mamba", "mamba-fin", "amphibot"])
def test_the_plane_and_space_agree_in_waves_and_in_shear(robot: str, flow: Flow):
    water = replace(STILL, current=flow, added_mass_form="kirchhoff", tangential_added_mass=0.1)
    planar, spatial = (
        lc.swim(robot, GAIT, 4.0, environment=water, dt=0.01, model=model, link_forces=True)
        for model in ("planar", "spatial")
    )
    still = lc.swim(robot, GAIT, 4.0, environment=replace(water, current=(0.0, 0.0)), dt=0.01)
    distance = np.linalg.norm(still.center_of_mass[-1] - still.center_of_mass[0])
    assert np.abs(planar.center_of_mass - spatial.center_of_mass[:, :2]).max() < 1e-6 * distance
    assert np.abs(planar.center_of_mass[-1] - still.center_of_mass[-1]).max() > 0.05 * distance
    for name in ("drag", "added_mass"):
        forces = planar.link_force[name]
        np.testing.assert_allclose(
            spatial.link_force[name][..., :2], forces, atol=1e-4 * np.abs(forces).max()
        )


@pytest.mark.parametrize("form", ["relative", "kirchhoff", "classic"])
@pytest.mark.parametrize("model", ["planar", "spatial"])
@pytest.mark.parametrize("compiled", [False, True])
def test_a_robot_in_a_current_is_one_in_still_water_seen_from_a_moving_frame(
    model: str, form: str, compiled: bool
):
    """But for `classic`, whose velocity terms see the water's velocity and not the relative one."""
    velocity, robot = np.array((0.08, -0.05)), lc.load_robot("mamba-fin")
    still = replace(STILL, added_mass_form=form)
    current = Moving(v_x=velocity[0], v_y=velocity[1]) if compiled else tuple(velocity.tolist())
    command, paths = lc.Command(gait=GAIT), []
    for water, moving in ((still, np.zeros(2)), (replace(still, current=current), velocity)):
        plant = lc.build_plant(robot, water, model=model, dt=0.01)
        state = plant.init(lc.Start(), command)
        if model == "planar":
            first = rows.VX - rows.TIME
        else:
            first = plant._size - robot.n_links - plant._twin.n_qvel
        state.values[first : first + 2] += moving
        _, log, failure = plant.march(state, command, 4.0, 0.1)
        assert failure is None
        paths.append(log.center_of_mass[:, :2] - np.outer(log.time, moving))
    apart = np.abs(paths[0] - paths[1]).max()
    assert (apart < 1e-10) == (form != "classic")
    assert form != "classic" or 1e-3 < apart < 0.1


def test_a_robot_at_rest_in_turning_water_is_turned_as_one_that_turns_in_still_water_is_slowed():
    """In the plane; over a step so short that nothing else happens."""
    rate, dt, gains = 0.4, 1e-5, []
    straight = lc.Command(gait=replace(GAIT, amplitude=0.0))
    for turning, current in ((-rate, (0.0, 0.0)), (0.0, Moving(shear=-rate, swing=rate))):
        plant = lc.build_plant(
            lc.load_robot("mamba-fin"), replace(STILL, current=current), model="planar", dt=dt
        )
        state = plant.init(lc.Start(), straight)
        state.values[rows.HEADING_RATE - rows.TIME] += turning
        end, _, _ = plant.march(state, straight, dt, dt)
        gains.append(end.values[rows.HEADING_RATE - rows.TIME] - turning)
    assert gains[0] > 0.0
    assert gains[0] == pytest.approx(gains[1], rel=1e-4)


def test_in_waves_robots_of_one_scene_far_apart_swim_as_alone_and_a_run_goes_on_as_it_would_have():
    water = replace(STILL, current=WAVES)
    robot, settings = lc.load_robot("mamba"), {"model": "spatial", "root": "free", "scene": "open"}
    starts = [lc.Start(center_of_mass=(0.0, 5.0 * k), depth=0.07) for k in range(2)]
    scenarios = [
        lc.build_scenario(robot, GAIT, 1.0, environment=water, start=start, **settings)
        for start in starts
    ]
    together, alone = lc.swim_together(scenarios), [lc.swim(one) for one in scenarios]
    for a, b in zip(together, alone, strict=True):
        assert np.array_equal(a.center_of_mass, b.center_of_mass)
    assert np.ptp(alone[0].center_of_mass[:, 2]) > 0.01
    plant, command = (
        lc.build_plant(robot, STILL, **settings).in_current(WAVES),
        lc.Command(gait=GAIT),
    )
    state = plant.init(starts[0], command)
    whole, _, _ = plant.march(state, command, 1.0, 0.1)
    half, _, _ = plant.march(state, command, 0.5, 0.1)
    other, _, _ = lc.build_plant(robot, water, **settings).march(half, command, 0.5, 0.1)
    assert np.array_equal(other.values, whole.values)
