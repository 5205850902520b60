"""Reference numbers of an independent implementation: nine settings of the paper with n = 9 and 10 links."""

import numpy as np
import pytest

import laticauda as lc
from laticauda.motion.gaits import envelope_of

# gait, amplitude [deg], frequency [deg/s], phase shift [deg]: per n, with prescribed joints the
# velocity (5), the displacement of the last 20 s / 20 s and the mechanical power, and the velocity
# (5) under pd.
REFERENCE = {
    ("lateral_undulation", 30, 130, 40): (
        (0.1476, 0.1499, 9.38, 0.1113),
        (0.1614, 0.1636, 12.11, 0.1175),
    ),
    ("lateral_undulation", 30, 150, 40): (
        (0.1690, 0.1711, 13.04, 0.1183),
        (0.1847, 0.1872, 16.84, 0.1243),
    ),
    ("lateral_undulation", 36, 110, 40): (
        (0.1392, 0.1412, 8.08, 0.1209),
        (0.1499, 0.1518, 10.24, 0.1286),
    ),
    ("lateral_undulation", 30, 110, 35): (
        (0.1370, 0.1395, 8.28, 0.1090),
        (0.1530, 0.1553, 11.04, 0.1185),
    ),
    ("eel_like", 30, 130, 40): ((0.1121, 0.1153, 2.74, 0.0627), (0.1304, 0.1339, 3.87, 0.0678)),
    ("eel_like", 30, 150, 40): ((0.1305, 0.1339, 3.75, 0.0655), (0.1514, 0.1550, 5.31, 0.0706)),
    ("eel_like", 48, 110, 40): ((0.1544, 0.1582, 3.77, 0.1120), (0.1713, 0.1754, 5.02, 0.1209)),
    ("eel_like", 50, 110, 40): ((0.1590, 0.1629, 3.97, 0.1171), (0.1755, 0.1796, 5.24, 0.1262)),
    ("eel_like", 30, 110, 35): ((0.1024, 0.1052, 2.29, 0.0611), (0.1235, 0.1268, 3.34, 0.0671)),
}


def test_speeds_and_powers_of_the_reference_table_are_reproduced():
    for (kind, amplitude, frequency, phase_shift), columns in REFERENCE.items():
        gait = lc.Gait(
            envelope=envelope_of(kind),
            amplitude=np.deg2rad(amplitude),
            frequency=np.deg2rad(frequency),
            phase_shift=np.deg2rad(phase_shift),
        )
        for n, (velocity, steady, power, pd_velocity) in zip((9, 10), columns, strict=True):
            robot = lc.load_robot("mamba", n_links=n)
            prescribed = lc.swim(robot, gait, duration=30.0)
            driven = lc.swim(robot, gait, duration=30.0, joints="pd")
            last = prescribed.time > 10.0 - 1e-9
            path = prescribed.center_of_mass[last]
            assert prescribed.forward_velocity == pytest.approx(velocity, rel=5e-3)
            assert float(np.hypot(*(path[-1] - path[0]))) / 20.0 == pytest.approx(steady, rel=5e-3)
            assert prescribed.mechanical_power == pytest.approx(power, rel=5e-3)
            assert driven.forward_velocity == pytest.approx(
                pd_velocity, rel=5e-3
            )  # the issue asks for 3 %


@pytest.mark.parametrize("ramp", [0.5, 2.0, 4.0])
def test_the_steady_velocity_does_not_depend_on_the_length_of_the_smooth_start(ramp):
    robot = lc.load_robot("mamba")
    gait = lc.lateral_undulation(
        amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
    )
    usual = lc.swim(robot, gait, duration=60.0).steady_velocity
    assert lc.swim(robot, gait, duration=60.0, ramp=ramp).steady_velocity == pytest.approx(
        usual, rel=1e-6
    )
