from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda_gym import PathFollowing, Pilots, SwimmingVectorEnv, swimmer

TASK = PathFollowing(scenario=swimmer(duration=30.0))


def sight(interval: float = TASK.interval, gait: lc.Gait = TASK.gait) -> lc.PathFollowing:
    return lc.PathFollowing(
        gait=gait,
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=0.18),
        heading=lc.HeadingController(gain=0.4, max_offset=TASK.max_offset),
        interval=interval,
    )


def test_line_of_sight_in_a_lane_is_the_trial_of_the_runner():
    envs = SwimmingVectorEnv(3, task=TASK)
    start = {"y": np.array([1.0, 0.5, -0.8]), "heading": np.array([0.0, 0.3, -0.2])}
    envs.reset(options={**start, "current_speed": 0.0})
    pilots = Pilots(sight(), envs.episodes)
    place, work = [], []
    for _ in range(TASK.n_steps):
        envs.step(pilots.actions())
        motion = envs.episodes.motion
        place.append(np.stack((motion.x, motion.y)))
        work.append(motion.work)
    for lane in range(3):
        at = lc.Start(center_of_mass=(0.0, start["y"][lane]), heading=start["heading"][lane])
        trial = lc.run(
            TASK.plant, sight(), TASK.scenario.duration, start=at, sample_interval=TASK.interval
        )
        np.testing.assert_allclose(
            np.array(place)[:, :, lane], trial.center_of_mass[1:], atol=1e-12
        )
        np.testing.assert_allclose(np.array(work)[:, lane], trial.work[1:, 0], rtol=1e-12)


def test_steering_adds_to_the_offset_of_the_gait():
    task = replace(TASK, scenario=swimmer(gait=replace(TASK.gait, offset=0.1), duration=5.0))
    envs = SwimmingVectorEnv(1, task=task)
    envs.reset(options={"y": 0.5, "heading": 0.0, "current_speed": 0.0})
    pilots = Pilots(sight(gait=task.gait), envs.episodes)
    for _ in range(task.n_steps):
        envs.step(pilots.actions())
    at = lc.Start(center_of_mass=(0.0, 0.5))
    trial = lc.run(
        task.plant,
        sight(gait=task.gait),
        task.scenario.duration,
        start=at,
        sample_interval=task.interval,
    )
    assert envs.episodes.motion.heading[0] == pytest.approx(trial.heading[-1], abs=1e-12)


def test_a_new_episode_gets_a_new_pilot():
    envs = SwimmingVectorEnv(2, task=PathFollowing(scenario=swimmer(duration=1.0)))
    law = lc.PathFollowing(
        gait=TASK.gait,
        path=lc.StraightLine(),
        guidance=lc.IntegralLineOfSight(look_ahead_distance=0.5, integral_gain=0.1),
        heading=lc.HeadingController(gain=0.4, max_offset=TASK.max_offset),
        interval=TASK.interval,
    )
    pilots = Pilots(law, envs.episodes)
    envs.reset(
        seed=3, options={"y": 0.05, "heading": 0.0}
    )  # the offset is not at its limit, and the integral grows
    begin = envs.episodes.school.observe(0)
    for _ in range(6):
        envs.step(pilots.actions())
    assert begin.time == envs.episodes.motion.time[0] == 0.0
    assert [state.guidance != 0.0 for state in pilots._states] == [True, True]
    pilots.actions()
    assert [state.guidance for state in pilots._states] == [0.0, 0.0]


def test_a_controller_of_another_pace_is_refused():
    envs = SwimmingVectorEnv(2, task=TASK)
    with pytest.raises(
        ValueError, match=r"`controller.interval` must be the task's, 0.2 s, got 0.05"
    ):
        Pilots(sight(0.05), envs.episodes)
