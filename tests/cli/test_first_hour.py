"""A newcomer's own robot and table of speeds, to a prediction with an interval, as the tutorial has it."""

import json

ROBOT = """
kind = "robot"
name = "adder"
description = "nine printed modules and no fin"

[[modules]]
count = 9
length = 0.14
mass = 0.75
section = { half_height = 0.045, half_width = 0.04 }

[[joints]]
count = 8
limit_deg = 60

[joints.actuator]
stall_torque = 3.2
no_load_speed = 5.5
voltage = 14.8
stall_current = 3.1
"""
# The model's speeds with C_f = 0.041 and C_D = 1.35, and noise of 2 %.
SPEEDS = """gait,alpha_deg,omega_deg_s,delta_deg,v_m_s,v_sigma_m_s,duration_s
LU,20,110,45,0.145,0.005,20
LU,28,110,45,0.170,0.005,20
LU,28,140,45,0.236,0.005,20
LU,35,140,45,,0.005,20
LU,28,170,45,28.6,0.005,20
LU,28,140,35,0.303,0.005,20
LU,35,170,35,0.359,0.005,20
"""
TRUE_SPEED = 0.310
"""Of the gait that is predicted, in the same water [m/s]."""
IDENTIFICATION = """
kind = "identification"
name = "adder-in-the-pool"
robot = "adder.toml"
joints = "prescribed"
noise = "known"
starts = 1
table = { file = "speeds.csv" }
parameters = [
    "water.tangential_friction",
    { name = "water.normal_drag", prior = [1.29, 0.13] },
]
"""


def test_an_own_robot_and_an_own_table_lead_to_a_prediction_with_an_interval(run, folder):
    (folder / "adder.toml").write_text(ROBOT)
    (folder / "speeds.csv").write_text(SPEEDS)
    (folder / "pool.toml").write_text(IDENTIFICATION)
    assert "links, joints   9, 8" in run("robots adder.toml").out
    # A robot's file is taken as a word, like the name of a preset.
    first = run("swim adder.toml --duration 2")
    assert (first.status, first.err) == (0, "")
    assert first.out == run("swim --robot adder.toml --duration 2").out
    refused = run("identify pool.toml --output pool")
    assert refused.status == 2
    assert "speeds.csv: row 6: `v_m_s` of 28.6 at `omega_deg_s` of 170 is" in refused.err
    assert "is one in another unit, such as cm/s" in refused.err
    (folder / "speeds.csv").write_text(SPEEDS.replace("28.6", "0.286"))
    done = run("identify pool.toml --output pool --quick")
    assert done.status == 0, done.err
    assert "1 of 7 rows has no speed: row 5" in done.err
    assert "Any other gait, with an interval: laticauda predict pool" in done.out
    gait = "--amplitude-deg 32 --frequency-deg-s 155 --phase-shift-deg 40"
    predicted = json.loads(run(f"predict pool {gait} --json").out)
    speed = predicted["figures"]["forward_velocity"]
    assert speed["low"] < TRUE_SPEED < speed["high"] < 1.25 * speed["low"]
