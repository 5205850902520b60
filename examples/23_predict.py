"""How fast will my robot be at a gait that I have not tried, give or take?

python examples/23_predict.py
"""

from dataclasses import replace
from math import radians

import matplotlib.pyplot as plt
import numpy as np

import laticauda as lc
from laticauda.identify import (
    Measurement,
    Unknown,
    basis_of,
    fit,
    predict_scenario,
)
from laticauda.robot import Joint, Module, Robot, Section, textbook_water

section = Section(half_height=0.035, half_width=0.03)
robot = Robot(
    name="eel",
    modules=(Module(length=0.1, mass=0.3, section=section),) * 9,
    joints=(Joint(),) * 8,
)


def gait(frequency: float, amplitude: float = 30.0) -> lc.Gait:
    return lc.lateral_undulation(
        amplitude=radians(amplitude),
        frequency=radians(frequency),
        phase_shift=radians(45),
    )


# Instead of a tank: water whose numbers nobody knows, and 3 % of noise.
textbook = textbook_water(robot).water
truth = replace(textbook, tangential_friction=0.05, added_mass=1.1)
tried_gaits = []
for frequency in (100, 140, 180, 220):
    tried_gaits += [gait(frequency, amplitude=25), gait(frequency, amplitude=35)]
speeds = lc.swim_many(robot, tried_gaits, 15.0, environments=truth).forward_velocity
speeds *= 1.0 + 0.03 * np.random.default_rng(2).standard_normal(speeds.size)
measurements = []
for number, (tried, speed) in enumerate(zip(tried_gaits, speeds, strict=True)):
    scenario = lc.build_scenario(robot, tried, 15.0, environment=textbook)
    figures = {"forward_velocity": (speed, 0.03 * speed)}  # and its deviation
    measurements.append(
        Measurement(name=f"run {number}", scenario=scenario, figures=figures)
    )

# Friction is fitted, drag as well, with what the tables say about it; added mass and
# the law's beta stay at the tables' values, though nobody knows them.
drag = Unknown(name="water.normal_drag", prior=(textbook.normal_drag, 0.14))
result = fit(
    measurements, parameters=["water.tangential_friction", drag], n_starts=1
)
basis = basis_of(result)
fitted = result.problem.scenarios_at(result.best)[0]

frequencies = np.linspace(80, 260, 10)
predictions = []
for frequency in frequencies:
    prediction = predict_scenario(basis, replace(fitted, motion=gait(frequency)))
    predictions.append(prediction.figures["forward_velocity"])
speed = predictions[5]
print(
    f"{speed.value:.3f} m/s at {frequencies[5]:.0f} deg/s, "
    f"95 % {speed.low:.3f} to {speed.high:.3f}"
)
for name in ("coefficients", "held_fixed", "left_out"):
    print(f"  {name:12} {100 * getattr(speed.shares, name):.1f} %, one deviation")

figure, ax = plt.subplots(figsize=(7, 4.5), layout="constrained")
ax.fill_between(
    frequencies,
    [speed.low for speed in predictions],
    [speed.high for speed in predictions],
    alpha=0.25,
    label="95 % interval at 30°",
)
values = [speed.value for speed in predictions]
ax.plot(frequencies, values, label="predicted at 30°")
new_gaits = [gait(frequency) for frequency in frequencies]
swims = lc.swim_many(robot, new_gaits, 15.0, environments=truth)
ax.plot(frequencies, swims.forward_velocity, "k--", label="what it would swim")
tried_frequencies = np.degrees([tried.frequency for tried in tried_gaits])
ax.plot(tried_frequencies, speeds, "ko", label="measured at 25° and 35°")
ax.set_xlabel("frequency [deg/s]")
ax.set_ylabel("speed [m/s]")
ax.legend()
figure.savefig("predict.png", dpi=150)
