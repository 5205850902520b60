"""From pulses to commands."""

import math
from dataclasses import replace

import pytest

import laticauda as lc
from laticauda.robot import PectoralFin, Thruster
from laticauda.scenarios import Planar, Spatial
from laticauda.values import RobotFileError
from laticauda_ardupilot import Battery, Mixing, load_mixing
from laticauda_ardupilot.battery import Discharge
from laticauda_ardupilot.channels import (
    Amplitude,
    Deflection,
    Frequency,
    Offset,
    PhaseShift,
    PitchOffset,
    Thrust,
)
from laticauda_ardupilot.mixing import FILES

GAIT = lc.lateral_undulation(amplitude=0.3, frequency=2.0, phase_shift=0.7)
ROBOT = replace(
    lc.load_robot("mamba-modules"),
    thrusters=[
        Thruster(link=3, thrust=1.0),
        Thruster(link=4, thrust=0.0, max_thrust=5.0),
        Thruster(link=5, thrust=0.0, max_thrust=5.0),
    ],
    pectoral_fins=[
        PectoralFin(link=9, area=0.01, lift_slope=3.0, stall_angle=0.4, max_deflection=0.5)
    ],
)


def mixed(*channels, **pulses):
    pwm = [0] * 16
    for name, width in pulses.items():
        pwm[int(name.removeprefix("servo")) - 1] = width
    return Mixing(channels=channels).command(GAIT, ROBOT, tuple(pwm))


@pytest.mark.parametrize(
    ("pulse", "offset"),
    [
        (0, 0.1),
        (1500, 0.1),
        (1900, 0.5),
        (1700, 0.3),
        (1100, -0.1),
        (1300, 0.0),
        (2200, 0.5),
        (800, -0.1),
    ],
)
def test_a_pulse_is_read_between_least_trim_and_largest_and_limited(pulse, offset):
    channel = Offset(servo=4, at_min=-0.1, at_trim=0.1, at_max=0.5)
    assert mixed(channel, servo4=pulse).offset == pytest.approx(offset, abs=1e-12)


def test_a_reversed_channel_takes_long_pulses_for_short_ones():
    channel = Offset(servo=1, at_min=-0.1, at_max=0.4, reversed=True)
    assert mixed(channel, servo1=1900).offset == pytest.approx(-0.1)
    assert mixed(channel, servo1=1100).offset == pytest.approx(0.4)


def test_a_trim_at_the_end_leaves_one_side():
    channel = Amplitude(servo=3, pwm_min=1000, pwm_trim=1000, pwm_max=2000, at_max=0.5)
    assert mixed(channel, servo3=1000).gait.amplitude == 0.0
    assert mixed(channel, servo3=1500).gait.amplitude == pytest.approx(0.25)


def test_channels_of_one_kind_are_added_and_others_stay_as_in_the_gait():
    left = Amplitude(servo=1, at_min=-0.2, at_max=0.2)
    right = Amplitude(servo=2, at_min=-0.2, at_max=0.2)
    command = mixed(left, right, servo1=1900, servo2=1700)
    assert command.gait.amplitude == pytest.approx(0.3)
    assert command.gait == replace(GAIT, amplitude=command.gait.amplitude)
    assert mixed(left, right, servo1=1100).gait.amplitude == 0.0
    assert command.thrusts is None
    assert command.deflections is None


def test_every_kind_of_channel_sets_its_number():
    command = mixed(
        Frequency(servo=1, at_max=6.0),
        PhaseShift(servo=1, at_min=-1.0, at_max=1.0),
        PitchOffset(servo=1, at_min=-0.1, at_max=0.1),
        Thrust(servo=1, thruster=1, at_min=-5.0, at_max=5.0),
        Deflection(servo=1, at_min=-0.5, at_max=0.5),
        servo1=1700,
    )
    assert command.gait.frequency == pytest.approx(3.0)
    assert command.gait.phase_shift == pytest.approx(0.5)
    assert command.pitch_offset == pytest.approx(0.05)
    assert command.thrusts == pytest.approx((0.0, 2.5))
    assert command.deflections == pytest.approx((0.25,))


@pytest.mark.parametrize(
    ("channel", "model", "rule"),
    [
        (
            Thrust(servo=1, thruster=2, at_min=0.0, at_max=1.0),
            Spatial(),
            "must be below 2, .* got 2",
        ),
        (
            Deflection(servo=1, fin=1, at_min=0.0, at_max=1.0),
            Spatial(),
            "must be below 1, .* got 1",
        ),
        (PitchOffset(servo=1, at_min=0.0, at_max=1.0), Planar(), "without pitch joints, in space"),
    ],
)
def test_channels_of_what_the_robot_does_not_have_are_refused(channel, model, rule):
    with pytest.raises(ValueError, match=rf"channels\[0\].*{rule}"):
        Mixing(channels=(channel,)).check(ROBOT, model)


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        (
            'kind = "mixing"\nchannels = [{kind = "sail", servo = 1}]',
            "channels.*must be .*amplitude",
        ),
        (
            'kind = "mixing"\nchannels = [{kind = "amplitude", servo = 33, at_max = 1}]',
            "servo.*must be between 1 and 32",
        ),
        (
            'kind = "mixing"\n[[channels]]\nkind = "amplitude"\nservo = 1\nat_max = 1\npwm_trim = 2000',
            "pwm_trim.*must be between `pwm_min` and `pwm_max`",
        ),
        ('kind = "mixing"\nchannels = []\nattitude = "tail"', "attitude.*must be"),
        ('kind = "scenario"\nchannels = []', "kind.*mixing"),
        (
            'kind = "mixing"\nchannels = []\n[battery]\nempty_voltage = 50.0',
            "empty_voltage.*must be < `full_voltage` = 42 V, got 50",
        ),
    ],
)
def test_a_file_that_is_wrong_is_refused_with_its_key_and_the_rule(tmp_path, text, rule):
    file = tmp_path / "mix.toml"
    file.write_text(text)
    with pytest.raises(RobotFileError, match=rf"mix\.toml.*{rule}"):
        load_mixing(file)


def test_the_eel_takes_the_outputs_of_simplerov_3_apart_again():
    mixing = load_mixing("eel")

    def command(forward, yaw, down):
        motors = (forward - yaw, forward + yaw, down)
        pwm = tuple(1500 + round(400 * share) for share in motors)
        robot = lc.load_robot(str(FILES / "eel-robot.toml"))
        return mixing.command(GAIT, robot, (*pwm, *[0] * 13))

    assert command(0.8, 0.2, 0.0).gait.amplitude == pytest.approx(math.radians(20.0))
    assert command(0.8, 0.2, 0.0).offset == pytest.approx(math.radians(-4.0))  # to the right
    assert command(0.5, 0.0, 0.5).thrusts == pytest.approx((-6.0,))  # down
    assert command(0.5, 0.0, 0.5).pitch_offset == pytest.approx(math.radians(2.0))  # noses down


def test_a_battery_sinks_by_its_charge_and_by_its_current():
    battery = Battery(full_voltage=40.0, empty_voltage=30.0, capacity=1.0, resistance=0.5)
    discharge = Discharge(battery)
    discharge.draw(75.0, 1.0)
    assert discharge.current == pytest.approx(1.92, abs=0.01)
    assert discharge.voltage * discharge.current == pytest.approx(75.0)
    for _ in range(1800):
        discharge.draw(35.0, 1.0)
    assert discharge.charge == pytest.approx(0.47, abs=0.01)
    assert discharge.voltage < 36.0
    discharge.draw(
        1e6, 1.0
    )  # more than it has: half of its voltage, and no root of a negative number
    assert discharge.voltage == pytest.approx(17.6, abs=0.1)
    lossless = replace(battery, resistance=0.0)
    assert lossless.current(80.0, 0.0) == 2.0
