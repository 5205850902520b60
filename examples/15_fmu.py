"""A robot as an FMU: exported here, and steered by another program without
laticauda.

FMPy (pip install fmpy) stands in for any tool that supports FMI 2.0. Exporting
the FMU requires a C compiler.

python examples/15_fmu.py
"""

from math import atan2, degrees, radians
from os.path import abspath

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
count = {
    kind: sum(v.causality == kind for v in variables)
    for kind in ("parameter", "input", "output")
}
print(
    "mamba.fmu:", ", ".join(f"{number} {kind}s" for kind, number in count.items())
)

# The same 30 s in FMPy and in Python.
seen = simulate_fmu("mamba.fmu", stop_time=30.0, output_interval=0.05)
trial = lc.swim(swimmer)
there, here = (
    float(seen["center_of_mass.x"][-1]),
    float(trial.center_of_mass[-1, 0]),
)
print(
    f"after 30 s: x = {there:.6f} m in FMPy, {abs(there - here):.0e} m from "
    "Python's"
)

# Step by step, as in a co-simulation: a current sets in after 20 s, and the
# offset keeps the robot on course against it.
folder = extract("mamba.fmu", abspath("mamba"))
told = read_model_description(folder)
number = {v.name: v.valueReference for v in told.modelVariables}
snake = FMU2Slave(
    guid=told.guid,
    unzipDirectory=folder,
    modelIdentifier=told.coSimulation.modelIdentifier,
    instanceName="snake",
)
snake.instantiate()
snake.setupExperiment()
snake.enterInitializationMode()
snake.exitInitializationMode()
gain, look_ahead, step = 0.3, 1.5, 0.05
way = []
for k in range(2000):
    y, heading = snake.getReal([number["center_of_mass.y"], number["heading"]])
    way.append(y)
    offset = gain * (atan2(-y, look_ahead) - heading)
    current = 0.03 if k * step >= 20.0 else 0.0
    snake.setReal([number["gait.offset"], number["current.y"]], [offset, current])
    snake.doStep(k * step, step)
x, y, heading = snake.getReal(
    [number[name] for name in ("center_of_mass.x", "center_of_mass.y", "heading")]
)
print(
    f"after 100 s: x = {x:.2f} m, {y:.3f} m beside the line, heading "
    f"{degrees(heading):.1f} deg"
)
snake.freeInstance()

figure, (ax,) = new_panels(height=2.6)
ax.plot([k * step for k in range(2000)], way)
ax.axvline(20.0, **style.AIM)
style.add_note(
    ax, "the current sets in", (20.0, min(way)), (5, -2), color=style.ORANGE
)
style.style_axes(ax, xlabel="time [s]", ylabel="cross-track error [m]")
save_figure(figure, "fmu.png")
