"""A robot as an FMU: exported here, and steered by another program without
laticauda.

FMPy (pip install fmpy) stands in for any tool that supports FMI 2.0. Exporting
the FMU requires a C compiler.

python examples/15_fmu.py
"""

from collections import Counter
from math import atan2, degrees, radians
from os.path import abspath

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave

import laticauda as lc
from laticauda.connect import export_fmu
from laticauda.show.figures import new_panels, save_figure, style

gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
swimmer = lc.build_scenario("mamba-fin", gait, parameters="mamba-identified")
variables = export_fmu("mamba.fmu", swimmer)
counts = Counter(variable.causality for variable in variables)
print(
    f"mamba.fmu: {counts['parameter']} parameters, {counts['input']} inputs, "
    f"{counts['output']} outputs"
)

# The same 30 s in FMPy and in Python.
outputs = simulate_fmu("mamba.fmu", stop_time=30.0, output_interval=0.05)
trial = lc.swim(swimmer)
x_in_fmpy = float(outputs["center_of_mass.x"][-1])
x_in_python = float(trial.center_of_mass[-1, 0])
print(
    f"after 30 s: x = {x_in_fmpy:.6f} m in FMPy, "
    f"{abs(x_in_fmpy - x_in_python):.0e} m from Python's"
)

# Step by step, as in a co-simulation: a current sets in after 20 s, and the
# offset keeps the robot on course against it.
folder = extract("mamba.fmu", abspath("mamba"))
description = read_model_description(folder)
number = {v.name: v.valueReference for v in description.modelVariables}
snake = FMU2Slave(
    guid=description.guid,
    unzipDirectory=folder,
    modelIdentifier=description.coSimulation.modelIdentifier,
    instanceName="snake",
)
snake.instantiate()
snake.setupExperiment()
snake.enterInitializationMode()
snake.exitInitializationMode()
x_number, y_number = number["center_of_mass.x"], number["center_of_mass.y"]
gain, look_ahead = 0.3, 1.5
times = 0.05 * np.arange(2000)
errors = []
for time in times:
    y, heading = snake.getReal([y_number, number["heading"]])
    errors.append(y)
    offset = gain * (atan2(-y, look_ahead) - heading)
    current = 0.03 if time >= 20.0 else 0.0
    snake.setReal([number["gait.offset"], number["current.y"]], [offset, current])
    snake.doStep(time, 0.05)
x, y, heading = snake.getReal([x_number, y_number, number["heading"]])
print(
    f"after 100 s: x = {x:.2f} m, {y:.3f} m beside the line, heading "
    f"{degrees(heading):.1f} deg"
)
snake.freeInstance()

figure, (ax,) = new_panels(height=2.6)
ax.plot(times, errors)
ax.axvline(20.0, **style.AIM)
style.add_note(
    ax, "the current sets in", (20.0, min(errors)), (5, -2), color=style.ORANGE
)
style.style_axes(ax, xlabel="time [s]", ylabel="cross-track error [m]")
save_figure(figure, "fmu.png")
