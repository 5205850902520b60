"""Inspect a net pen in a tidal current, and come home into the dock.

The robot finds the net by sonar, its way by a Doppler log, gyro and compass, and
home by an acoustic beacon; the current is estimated on the way. Two seeds draw the
current, waves, and a sensor that fails for a while.

    python examples/25_inspect_a_net.py
"""

from laticauda.missions import (
    Conditions,
    change_scenario,
    draw_conditions,
    draw_map,
    load_mission,
    run_missions,
)
from laticauda.show.figures import save_figure

mission = load_mission("net-inspection")
conditions = Conditions(failing=("sonar", "velocity", "beacon"))
draws = [draw_conditions(conditions, seed) for seed in (3, 14)]
results = run_missions(
    [change_scenario(mission, conditions, draw) for draw in draws]
)
for draw, result in zip(draws, results, strict=True):
    print(
        f"current {draw.current:.2f} m/s, {draw.failing} {draw.fault.kind} from "
        f"{draw.fault.begin:.0f} to {draw.fault.end:.0f} s: "
        f"docked {result.is_docked} after {result.duration:.0f} s, "
        f"{100 * result.share_seen:.0f} % of the net seen, never nearer than "
        f"{result.clearance:.2f} m"
    )
    for change in result.changes:
        print(f"   {change.time:5.1f} s  {change.after}: {change.reason}")
save_figure(draw_map(results[1]), "inspection.png")
