"""Lost, doubled and late packets, and restarts: nothing hangs, and time does not jump."""

import os

import pytest

from laticauda_ardupilot.emulator import Ardupilot
from laticauda_ardupilot.lock_step import REPEAT_AFTER, RESTART_AFTER, LockStep
from laticauda_ardupilot.schedules import FIRST_PULSE, Clockwork, Schedule

N_SCHEDULES = int(os.environ.get("LATICAUDA_SCHEDULES", "1000"))
"""With 10 000, it takes ten times as long."""


@pytest.fixture
def lock_step():
    """The lock step of a vehicle that only has a time."""
    vehicle = Clockwork()
    lock_step = LockStep(vehicle, clock=lambda: lock_step.now)
    lock_step.vehicle = vehicle
    lock_step.now = 0.0

    def answer_at(now, data, sender="a"):
        lock_step.now = now
        return lock_step.answer(data, sender)

    lock_step.answer_at = answer_at
    return lock_step


def packet(count, pulse=1500, rate=400, n_channels=16):
    return Ardupilot(frame_rate=rate, frame_count=count, n_channels=n_channels).packet((pulse,))


def test_a_new_frame_advances_time_by_one_frame_whatever_was_lost(lock_step):
    for count in (0, 1, 5):
        assert lock_step.answer_at(0.01 * count, packet(count)) is not None
    assert lock_step.vehicle.time == 3 / 400
    assert lock_step.counts.missed == 3


def test_a_doubled_packet_gets_one_answer_and_a_repeated_one_the_same_again(lock_step):
    first = lock_step.answer_at(10.0, packet(0))
    assert lock_step.answer_at(10.0 + 0.5 * REPEAT_AFTER, packet(0)) is None
    assert lock_step.answer_at(10.0 + 1.1 * REPEAT_AFTER, packet(0)) == first
    assert lock_step.vehicle.time == 1 / 400
    assert (lock_step.counts.doubled, lock_step.counts.repeated) == (1, 1)


def test_packets_that_are_sent_again_during_a_slow_step_are_copies(lock_step, monkeypatch):
    step = lock_step.vehicle.step

    def step_slowly(pwm, duration):
        lock_step.now += 8.0
        return step(pwm, duration)

    monkeypatch.setattr(lock_step.vehicle, "step", step_slowly)
    assert lock_step.answer_at(0.0, packet(0)) is not None
    for _ in range(7):  # they waited in the socket
        assert lock_step.answer_at(8.001, packet(0)) is None


def test_a_late_packet_does_nothing(lock_step):
    for count in (0, 2):
        lock_step.answer_at(0.0, packet(count))
    assert lock_step.answer_at(0.0, packet(1)) is None
    assert lock_step.answer_at(0.0, packet(0)) is None
    assert lock_step.vehicle.time == 2 / 400
    assert lock_step.counts.late == 2


def test_frame_0_from_another_port_starts_again_at_once(lock_step):
    for count in range(700):
        lock_step.answer_at(0.0, packet(count))
    lock_step.answer_at(0.1, packet(0), "b")
    assert lock_step.vehicle.time == 1 / 400
    assert lock_step.answer_at(0.1, packet(701)) is None  # late, of the program before
    lock_step.answer_at(0.1, packet(1), "b")
    assert lock_step.vehicle.time == 2 / 400
    assert lock_step.counts.resets == 1


@pytest.mark.parametrize("old", [0, 3])
def test_an_old_frame_from_the_same_port_starts_again_if_it_is_all_that_comes(lock_step, old):
    for count in range(9):
        lock_step.answer_at(0.0, packet(count))
    assert lock_step.answer_at(0.1, packet(old)) is None
    assert lock_step.answer_at(0.1 + RESTART_AFTER, packet(1)) is None
    assert lock_step.answer_at(0.2 + RESTART_AFTER, packet(old)) is None
    assert lock_step.answer_at(0.2 + 2.0 * RESTART_AFTER, packet(old)) is not None
    assert lock_step.vehicle.time == 1 / 400


def test_the_rate_and_the_number_of_channels_may_change_at_any_frame(lock_step):
    lock_step.answer_at(0.0, packet(0, rate=400))
    lock_step.answer_at(0.0, packet(1, rate=50, n_channels=32))
    assert lock_step.vehicle.durations == [1 / 400, 1 / 50]


@pytest.mark.parametrize(
    "data", [b"", b"x", b"\x00" * 40, packet(0)[:-1], packet(0) + b"\x00", packet(0, rate=0)]
)
def test_what_is_no_servo_packet_is_counted_and_nothing_else(lock_step, data):
    assert lock_step.answer_at(0.0, data) is None
    assert lock_step.counts.invalid == 1
    assert lock_step.vehicle.durations == []


def test_a_simulation_that_was_restarted_takes_up_where_ardupilot_is(lock_step):
    assert lock_step.answer_at(0.0, packet(12345)) is not None
    assert lock_step.vehicle.time == 1 / 400
    assert lock_step.counts.missed == 0


def test_no_schedule_of_lost_doubled_and_late_packets_hangs_or_lets_time_jump():
    for seed in range(N_SCHEDULES):
        schedule = Schedule(seed).run()
        vehicle = schedule.vehicle
        # The robot saw every frame at most once and in order, and each was as long as it says.
        assert vehicle.pulses == sorted(set(vehicle.pulses)), seed
        assert vehicle.time == pytest.approx(sum(vehicle.durations)), seed
        assert schedule.lock_step.counts.resets == 0, seed


@pytest.mark.parametrize("same_port", [False, True])
def test_a_restart_in_the_middle_of_any_schedule_begins_once_more(same_port):
    for seed in range(N_SCHEDULES // 10):
        schedule = Schedule(seed).run()
        schedule.restart_ardupilot(same_port=same_port)
        schedule.run()
        assert schedule.lock_step.counts.resets == 1, seed
        assert schedule.vehicle.pulses == sorted(set(schedule.vehicle.pulses)), seed
        # From the same port, answers to the program before may take it past its first frames.
        assert same_port or schedule.vehicle.pulses[0] == FIRST_PULSE, seed
