"""Save a trial for other tools, and load a log from another program as a trial.

python examples/11_logs.py
"""

from math import degrees, radians
from pathlib import Path

import laticauda as lc
from laticauda.show.figures import new_panels, save_figure, style

gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
trial = lc.swim("mamba-fin", gait, duration=30.0, parameters="mamba-identified")

# Out: MCAP opens in Foxglove, .mat in MATLAB and Octave, Parquet in pandas. Each of
# them loads back as an equal trial.
for name in ("run.mcap", "run.mat", "run.parquet"):
    trial.save(name)
    megabytes = Path(name).stat().st_size / 1e6
    is_equal = lc.load_trial(name).equals(trial)
    print(f"{name}: {megabytes:.2f} MB, equal: {is_equal}")

# In: a table of the robot's positions from any program, and a map that says what
# its columns are.
lines = ["ms,x,y,heading"]
for time, (x, y), angle in zip(
    trial.time, trial.center_of_mass, trial.heading, strict=True
):
    lines.append(f"{1000.0 * time},{x},{y},{degrees(angle)}")
Path("log.csv").write_text("\n".join(lines))
Path("map.toml").write_text("""
kind = "columns"
robot = "mamba-fin"

[gait]
kind = "lateral-undulation"
amplitude_deg = 30
frequency_deg_s = 130
phase_shift_deg = 40

[time]
column = "ms"
unit = "ms"

[center_of_mass]
position = ["x", "y"]

[heading]
column = "heading"
unit = "deg"
""")
log = lc.load_trial("log.csv", columns="map.toml")
print(
    f"{log.status} {log.forward_velocity:.4f} m/s, turns "
    f"{degrees(log.turning_rate):+.3f} deg/s"
)
print(f"Not measured: {', '.join(log.not_measured)}")

figure, (ax,) = new_panels(height=2.0)
ax.plot(*log.center_of_mass.T)
ax.set_aspect("equal", adjustable="datalim")
style.style_axes(ax, xlabel="x [m]", ylabel="y [m]")
style.add_title(figure, "Path of the center of mass, as the log says")
save_figure(figure, "log.png")
