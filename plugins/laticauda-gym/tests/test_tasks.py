import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

import laticauda as lc
from laticauda_gym import Efficiency, PathFollowing, Pilots, StationKeeping, Step
from laticauda_gym.episodes import BOUND, Episodes
from laticauda_gym.tasks import log_square

TASKS = [PathFollowing(), Efficiency(), StationKeeping()]
NAMES = [type(task).__name__ for task in TASKS]


def begun(task, n=4, seed=0, **given) -> Episodes:
    episodes = Episodes(task, n)
    episodes.begin(
        np.full(n, True), [np.random.default_rng(seed + lane) for lane in range(n)], given
    )
    return episodes


def after(episodes: Episodes, count: int, share: float = 0.5):
    actions = np.full((episodes.n, len(episodes.task.actions)), share)
    return [episodes.step(actions) for _ in range(count)][-1]


def named(episodes: Episodes, observation: np.ndarray) -> dict[str, np.ndarray]:
    """An observation by its names, in SI units."""
    sights = episodes.task.sights
    return {sight.name: observation[:, i] * sight.unit for i, sight in enumerate(sights)}


@pytest.mark.parametrize("task", TASKS, ids=NAMES)
def test_what_is_seen_has_a_name_and_stays_within_the_bound(task):
    episodes = begun(task)
    done = after(episodes, 20)
    assert done.observation.shape == (4, len(task.sights))
    assert len({sight.name for sight in task.sights}) == len(task.sights)
    assert np.abs(done.observation).max() <= BOUND
    assert episodes.seen.shape == done.observation.shape


@pytest.mark.parametrize("task", TASKS, ids=NAMES)
def test_episodes_draw_within_their_ranges(task):
    drawn = begun(task, n=200).drawn
    for draw in task.draws:
        assert draw.low <= drawn[draw.name].min() < drawn[draw.name].max() <= draw.high
        assert np.ptp(drawn[draw.name]) > 0.9 * (draw.high - draw.low)


@pytest.mark.parametrize("task", TASKS, ids=NAMES)
def test_the_reward_of_a_step_grows_with_its_interval_alone(task):
    """A return is an integral: two halves of an interval are worth what the whole one is, but for what changes."""
    whole, half = (begun(replace(task, interval=h)) for h in (0.02, 0.01))
    before = [after(whole, 50), after(half, 100)][0]
    twice = [after(half, 1).reward for _ in range(2)]
    np.testing.assert_allclose(sum(twice), after(whole, 1).reward, rtol=0.03, atol=1e-3)
    assert not before.terminated.any()


def test_the_path_is_seen_as_line_of_sight_sees_it():
    episodes = begun(PathFollowing())
    seen = named(episodes, after(episodes, 10).observation)
    line = lc.StraightLine()
    for lane in range(4):
        other = episodes.school.observe(lane)
        frame = line.locate(line.init(), other.center_of_mass)[1]
        assert seen["cross_track_error"][lane] == pytest.approx(frame.cross_track_error, abs=1e-15)
        assert math.atan2(seen["sin_heading"][lane], seen["cos_heading"][lane]) == pytest.approx(
            other.heading
        )
        speed = math.hypot(*other.center_of_mass_velocity)
        assert math.hypot(
            seen["velocity_along"][lane], seen["velocity_across"][lane]
        ) == pytest.approx(speed)


@pytest.mark.parametrize(
    "task", [PathFollowing(), StationKeeping()], ids=["PathFollowing", "StationKeeping"]
)
def test_the_current_is_not_seen_at_first(task):
    """It shows in how the robot drifts, as it does for line of sight."""
    given = {"y": 0.3, "heading": 0.2, "current_direction": 1.0} | (
        {"x": 0.1} if "Station" in str(task) else {}
    )
    still, moving = (begun(task, current_speed=speed, **given) for speed in (0.0, 0.05))
    np.testing.assert_array_equal(still.seen, moving.seen)
    assert not np.array_equal(after(still, 10).observation, after(moving, 10).observation)


def test_progress_and_distance_and_power_make_the_reward_of_path_following():
    task = PathFollowing()
    episodes = begun(task, y=0.3)
    before = episodes.motion
    done = after(episodes, 1)
    motion = episodes.motion
    for lane in range(4):
        distance = math.log(1.0 + (motion.y[lane] / 0.1) ** 2)
        power = (motion.work[lane] - before.work[lane]) / 0.2
        worth = (motion.x[lane] - before.x[lane]) / 0.1 - 0.2 * (distance + power / 100.0)
        assert done.reward[lane] == pytest.approx(worth, rel=1e-12)
        assert done.power[lane] == pytest.approx(power)


def test_line_of_sight_is_rewarded_more_than_going_straight():
    episodes, idle = (begun(PathFollowing(), n=16) for _ in range(2))
    law = lc.PathFollowing(
        gait=episodes.task.gait,
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=0.18),
        heading=lc.HeadingController(gain=0.4, max_offset=episodes.task.max_offset),
        interval=0.2,
    )
    pilots = Pilots(law, episodes)
    steered = sum(episodes.step(pilots.actions()).reward for _ in range(150))
    assert steered.mean() > sum(after(idle, 1, 0.0).reward for _ in range(150)).mean() + 100.0


def test_the_best_of_the_gaits_for_a_speed_is_the_one_with_the_least_power():
    """Of two gaits that swim at the speed asked for, the slow wide one costs less than the fast narrow one."""
    task = Efficiency()
    wide, narrow = (begun(task, speed_ref=0.09) for _ in range(2))

    def worth(
        episodes: Episodes, amplitude_deg: float, frequency_deg_s: float
    ) -> tuple[float, float]:
        wanted = (math.radians(amplitude_deg), math.radians(frequency_deg_s), math.radians(40.0))
        action = [
            2.0 * (x - a.low) / (a.high - a.low) - 1.0
            for x, a in zip(wanted, task.actions, strict=True)
        ]
        done = [episodes.step(np.tile(action, (4, 1))) for _ in range(200)]
        late = done[100:]
        speed = np.mean([named(episodes, each.observation)["speed"] for each in late])
        return float(speed), float(np.mean([each.reward for each in late]))

    slow, fast = worth(wide, 30.0, 64.0), worth(narrow, 20.0, 100.0)
    assert slow[0] == pytest.approx(fast[0], rel=0.1)
    assert slow[1] > fast[1]


def test_who_stays_at_the_origin_pays_for_power_alone():
    task = StationKeeping()
    episodes = begun(task, x=0.0, y=0.0, current_speed=0.0)
    actions = np.tile([0.0, -1.0], (4, 1))  # no frequency: it lies still
    for _ in range(40):
        done = episodes.step(actions)
    assert np.hypot(episodes.motion.x, episodes.motion.y).max() < 0.3
    seen = named(episodes, done.observation)
    distance = np.hypot(seen["origin_along"], seen["origin_across"])
    np.testing.assert_allclose(distance, np.hypot(episodes.motion.x, episodes.motion.y), atol=1e-12)
    cost = task.interval * (log_square(distance, 0.2) + done.power / 100.0)
    np.testing.assert_allclose(done.reward, -cost, rtol=1e-9)


@given(st.floats(-100.0, 100.0), st.floats(0.01, 10.0))
def test_the_distance_counts_by_its_square_when_small_and_by_its_digits_when_large(
    x: float, tolerance: float
):
    once, tenfold = log_square(np.array([x, 10.0 * x]), tolerance)
    ratio = abs(x) / tolerance
    assert 0.0 <= once <= ratio**2 * (1.0 + 1e-12)
    if ratio < 1e-3:
        assert once == pytest.approx(ratio**2, rel=1e-5)
    if ratio > 1e3:
        assert tenfold - once == pytest.approx(2.0 * math.log(10.0), abs=1e-5)


def test_a_step_knows_its_mean_power_and_its_velocity_in_body_axes():
    episodes = begun(
        PathFollowing(), n=1, y=0.0, heading=math.pi / 2, current_speed=0.05, current_direction=0.0
    )
    before = episodes.motion
    after(episodes, 1)
    step = Step(drawn={}, before=before, after=episodes.motion, interval=0.2)
    along, across = step.velocity
    motion = episodes.motion
    velocity = complex(motion.velocity_x[0], motion.velocity_y[0]) * np.exp(-1j * motion.heading[0])
    assert along[0] == pytest.approx(velocity.real, abs=1e-15)
    assert across[0] == pytest.approx(velocity.imag, abs=1e-15)
    assert step.power[0] == pytest.approx(motion.work[0] / 0.2)


@pytest.mark.parametrize("task", TASKS, ids=NAMES)
def test_no_sight_looks_at_the_water_that_an_episode_drew(task):
    episodes = begun(task)
    seen, motion = episodes.seen, episodes.motion
    known = {
        name: values for name, values in episodes.drawn.items() if name == "speed_ref"
    }  # the order, no water
    step = Step(drawn=known, before=motion, after=motion, interval=task.interval)
    told = np.stack([sight.of(step) / sight.unit for sight in task.sights], axis=1)
    np.testing.assert_array_equal(np.clip(told, -BOUND, BOUND), seen)
