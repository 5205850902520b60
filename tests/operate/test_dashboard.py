import io
import math

from operate.rig import run_of
from rich.console import Console

import laticauda as lc
from laticauda.operate.course.operator import Operator
from laticauda.operate.dashboard import Dashboard, Lines, picture
from laticauda.operate.settings import Calibration, Connection, Following, Operation

WHAT = Operation(
    name="shown",
    gait=lc.lateral_undulation(amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)),
    following=Following(),
    duration=5.0,
    rate=25.0,
    estimator="kinematics",
    countdown=0.1,
    connection=Connection(meter_port="there"),
    supply_voltage=35.0,
    calibration=Calibration(idle_time=0.2, still_time=0.3),
)


def text_of(run) -> str:
    console = Console(record=True, width=110, file=io.StringIO())
    console.print(picture(WHAT, run.state, tuple(run.events[-4:])))
    return console.export_text()


def test_the_dashboard_shows_modules_pose_state_and_events():
    run = run_of(Operator(operation=WHAT))
    first = text_of(run)
    assert "not heard" in first
    assert "not known yet" in first
    run.until("running")
    run.tick(25)
    shown = text_of(run)
    for word in ("RUNNING", "active", "25 °C", "35.0 V", "0.30 A", "m/s", "tracking", "at rest", "1.180 A", "of 5 s"):
        assert word in shown, word
    assert max(len(line) for line in shown.splitlines()) <= 110
    run.rig.leak = {3}
    run.tick(20)
    shown = text_of(run)
    assert "LEAK" in shown
    assert "FAULT" in shown
    assert "emergency stop" in shown


def test_it_is_drawn_by_a_thread_that_ends():
    run = run_of(Operator(operation=WHAT))
    with Dashboard(WHAT) as dashboard:
        dashboard(run.state, run.outputs)
    assert not dashboard._thread.is_alive()


def test_without_a_terminal_there_is_a_line_per_event():
    run, stream = run_of(Operator(operation=WHAT)), io.StringIO()
    with Lines(stream) as lines:
        while run.state.phase != "running":
            run.tick()
            lines(run.state, run.outputs)
    told = stream.getvalue()
    assert "8 modules and the motion capture are heard" in told
    assert "I_0 = 1.180 A" in told
    assert "phase" not in told
