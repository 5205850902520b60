"""What the page's controls do, as its server calls them; `test_page` does the same in a browser."""

import asyncio
import math
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import laticauda as lc
from laticauda.cli import main
from laticauda.control import Following, StraightLine
from laticauda.models.spatial.scene import Pipe
from laticauda.motion.gaits import Custom
from laticauda.motion.joints.laws import Servo
from laticauda.show.cockpit import Cockpit, Live, read_figures
from laticauda.show.cockpit.changes import adapt_scenario, read_depth, read_path, sample_route
from laticauda.show.cockpit.events import Event
from laticauda.show.cockpit.gait_map import QUANTITY_OF_LABEL
from laticauda.show.cockpit.gait_trials import AMPLITUDES, FREQUENCIES, change_wave
from laticauda.show.cockpit.page import GizmoPose
from laticauda.show.cockpit.readouts import format_figures
from laticauda.values.errors import TrialFileError
from laticauda.values.quantities import hints_of

pytest.importorskip("viser")
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)


class Page:
    """Stands for a browser's page: keeps what it is told."""

    def __init__(self):
        self.told, self.files = [], {}

    def add_notification(self, title, text, **settings):
        self.told.append(text)

    _websock_connection = SimpleNamespace(
        get_message_buffer=lambda: SimpleNamespace(message_from_id={})
    )

    def send_file_download(self, name, content, **settings):
        self.files[name] = content


@pytest.fixture
def cockpit():
    served = Cockpit(Live(lc.build_scenario("mamba", GAIT)), port=0)
    yield served
    served.close()


def control(cockpit, name):
    return cockpit._controls.by_name[name].handle


def use(cockpit, handle, value):
    """As if somebody had set a control on a page; what the page was told."""
    page = Page()
    handle.value = value
    cockpit._controls.apply(Event(page, handle, value))
    cockpit._controls.settle()
    cockpit.live.advance(0.1)
    cockpit.frame()
    return page.told


def test_what_the_page_says_has_no_underscores(cockpit):
    handles = [one.handle for one in cockpit._controls.by_name.values()]
    said = [text for handle in handles for text in (handle.label, *getattr(handle, "options", ()))]
    assert "eel like" in said and "phase shift [°]" in said
    assert [text for text in (*said, *QUANTITY_OF_LABEL) if "_" in text] == []
    use(cockpit, control(cockpit, "flow"), "swell")  # its numbers have fields of their own
    assert [
        name for name, one in cockpit._controls.by_name.items() if "_" in one.handle.label
    ] == []


def test_every_control_acts_at_once(cockpit):
    live = cockpit.live
    assert use(cockpit, control(cockpit, "amplitude"), 42.0) == []
    assert math.degrees(live.scenario.gait.amplitude) == pytest.approx(42.0)
    use(cockpit, control(cockpit, "kind"), "eel like")
    use(cockpit, control(cockpit, "fin"), "rigid")
    assert live.scenario.robot.caudal_fin.n_hinges == 0
    use(cockpit, control(cockpit, "fin"), "elastic")
    use(cockpit, control(cockpit, "rigidity"), 0.4)
    assert live.scenario.robot.caudal_fin.flexural_rigidity == 0.4
    use(cockpit, control(cockpit, "joints"), "servo")
    use(cockpit, control(cockpit, "current_x"), 0.1)
    use(cockpit, control(cockpit, "path"), True)
    assert (live.scenario.gait.kind, live.scenario.model.joints) == ("eel_like", Servo())
    assert live.scenario.environment == replace(lc.load_water("paper-eel"), current=(0.1, 0.0))
    assert abs(read_figures(live)["cross_track_error"]) == pytest.approx(0.6, abs=0.05)
    use(cockpit, control(cockpit, "robot"), "chain")
    assert live.scenario.robot == lc.load_robot("chain")
    assert control(cockpit, "fin").value == "none"


def test_a_bad_value_is_refused_in_the_words_of_the_api_and_the_field_goes_back(cockpit):
    live = cockpit.live
    use(cockpit, control(cockpit, "fin"), "elastic")
    before = live.scenario
    (told,) = use(cockpit, control(cockpit, "rigidity"), -1.0)
    assert told == "`flexural_rigidity` must be > 0 N m^2, got -1.0."
    assert live.scenario == before
    assert control(cockpit, "rigidity").value == before.robot.caudal_fin.flexural_rigidity
    for value, message in (
        (math.nan, "`current` must be a finite number"),
        (3.0, "`current` must be between -2 and 2 m/s"),
    ):
        (told,) = use(cockpit, control(cockpit, "current_y"), value)
        assert told.startswith(message)
        assert control(cockpit, "current_y").value == 0.0


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("amplitude", 99.0, "`amplitude_deg` must be between 0 and 60, got 99.0."),
        ("frequency", 221.0, "`frequency_deg_s` must be between 0 and 220, got 221.0."),
        ("frequency", -5.0, "`frequency` must be >= 0 rad/s, got "),
    ],
)
def test_what_is_typed_beyond_the_ends_of_a_slider_is_refused(cockpit, field, value, message):
    handle, before = cockpit._controls.by_name[field].handle, cockpit.live.scenario
    shown = handle.value
    (told,) = use(cockpit, handle, value)
    assert told.startswith(message)
    assert cockpit.live.scenario == before
    assert handle.value == shown


def test_a_slider_that_is_dragged_ends_where_it_was_let_go(cockpit):
    handle, live = control(cockpit, "frequency"), cockpit.live
    for value in np.arange(125.0, 60.0, -1.0):
        handle._impl.value = value  # as the page's server does it
        for heard in handle._impl.update_cb:
            asyncio.run(heard(SimpleNamespace(client=Page(), target=handle)))
    cockpit._events.close()
    assert math.degrees(live.scenario.gait.frequency) == pytest.approx(61.0)
    assert handle.value == 61.0


def test_a_speed_of_time_beyond_its_limits_is_refused(cockpit):
    page, handle = Page(), cockpit._controls.speed
    handle.value = 99.0
    cockpit._controls.set_speed(Event(page, handle, 99.0))
    cockpit._controls.settle()
    assert page.told == ["`speed` must be between 0.1 and 8, got 99.0."]
    assert handle.value == cockpit.live.speed == 1.0


def test_the_path_goes_where_it_is_dragged(cockpit):
    use(cockpit, control(cockpit, "path"), True)
    pose = (1.0, 2.0, 0.0), (math.cos(0.2), 0.0, 0.0, math.sin(0.2))
    cockpit._drag(Event(Page(), cockpit._gizmo, GizmoPose(*pose, "end")))
    path = read_path(cockpit.live.scenario)
    assert path.point == (1.0, 2.0)
    assert path.angle == pytest.approx(0.4)


def test_the_best_gait_of_the_map_can_be_swum_and_is_marked_on_it(cockpit):
    shown, live = cockpit._map, cockpit.live
    shown._on.value = True
    end = time.monotonic() + 60.0
    while not shown._image.visible and time.monotonic() < end:
        shown.show()
        time.sleep(0.05)
    before = shown._image.image
    shown._swim_best(Event(Page(), None, None))
    cockpit._show_scenario()
    shares, _ = shown._shares_and_limit()
    possible = np.where(shares <= 1.0 + 1e-9, shown._values(), np.nan)
    i, j = np.unravel_index(np.nanargmax(possible), possible.shape)
    assert live.scenario.gait == change_wave(GAIT, AMPLITUDES[j], FREQUENCIES[i])
    assert control(cockpit, "amplitude").value == AMPLITUDES[j]
    shown.show()
    assert not np.array_equal(shown._image.image, before)
    shown._on.value = False
    shown.show()
    assert not shown._image.visible


def test_a_run_is_saved_and_comes_back_as_a_ghost(cockpit, tmp_path):
    page, runs = Page(), cockpit._runs
    for _ in range(20):
        cockpit.live.advance(0.1)
    runs._save(SimpleNamespace(client=page))
    (content,) = page.files.values()
    file = SimpleNamespace(name="run.nc", content=content)
    runs._load(SimpleNamespace(client=page, target=SimpleNamespace(value=file)))
    cockpit.frame()
    assert page.told == []
    assert runs._ghost.robot == cockpit.live.scenario.robot
    runs._remove(None)
    assert runs._ghost is None


def test_a_ghost_begins_beside_the_robot_or_where_it_was_and_anew_with_the_world(cockpit):
    runs, live = cockpit._runs, cockpit.live
    trial = lc.swim(live.scenario.robot, GAIT, 3.0, start=lc.Start(center_of_mass=(5.0, 2.0)))
    live.advance(1.0)
    runs.play(trial)
    cockpit.frame()

    def gone():
        return np.asarray(runs._ghost.sample(0.0).center_of_mass) - live.latest().center_of_mass

    assert np.linalg.norm(gone()) == pytest.approx(0.5)
    runs._beside.value = False
    runs._place()
    np.testing.assert_allclose(runs._ghost.sample(0.0).center_of_mass, (5.0, 2.0))
    live.advance(1.0)
    cockpit._reset()
    assert runs._ghost_start == live.simulation.time == 0.0


def test_a_recorded_operation_is_played_back_and_what_is_no_trial_says_why(cockpit, tmp_path):
    from tank.operate.tank import record

    from laticauda.studies import Grid, Sweep, open_sweep, run_sweep

    record(tmp_path / "run.mcap")
    cockpit.load(tmp_path / "run.mcap")
    cockpit.frame()
    assert (
        cockpit._runs._ghost.robot == lc.load_trial(_replayed(tmp_path / "run.mcap")).robot.planar()
    )
    values = {"gait.amplitude": (0.3, 0.5), "gait.frequency": (1.0, 2.0)}
    run_sweep(
        Sweep(scenario=lc.build_scenario("mamba", GAIT, 2.0), points=Grid(values=values)),
        tmp_path / "s",
    )
    open_sweep(tmp_path / "s").to_netcdf(tmp_path / "s.nc", engine="netcdf4")
    page = Page()
    for name, content in (("s.nc", (tmp_path / "s.nc").read_bytes()), ("broken.txt", b"nothing")):
        file = SimpleNamespace(name=name, content=content)
        cockpit._runs._load(SimpleNamespace(client=page, target=SimpleNamespace(value=file)))
    sweep, text = page.told
    assert sweep.startswith("Cannot load s.nc: ")
    assert text == "Cannot load broken.txt: a trial file ends in one of .nc, .mcap, .parquet, .mat."
    with pytest.raises(TrialFileError, match="a trial file ends in one of"):
        cockpit.load(tmp_path / "s")
    with pytest.raises(TrialFileError, match=r"Cannot load .*nothing\.nc: there is no such file"):
        cockpit.load(tmp_path / "nothing.nc")


def _replayed(path):
    """The trial that `laticauda replay` makes of a recording."""
    assert main(["replay", str(path), "--save", str(path.with_suffix(".nc")), "--json"]) == 0
    return path.with_suffix(".nc")


def test_a_gait_of_ones_own_can_be_left_and_taken_up_again():
    gait = replace(GAIT, envelope=Custom(values=(1.0,) * 8))
    served = Cockpit(Live(lc.build_scenario("mamba", gait)), port=0)
    try:
        assert use(served, control(served, "kind"), "eel like") == []
        assert served.live.scenario.gait.kind == "eel_like"
        assert use(served, control(served, "kind"), "custom") == []
        assert served.live.scenario.gait == gait
    finally:
        served.close()


@pytest.mark.parametrize(
    ("name", "message"),
    [("run.nc", "Cannot load run.nc: "), ("run.txt", "a trial file ends in one of .nc")],
)
def test_a_file_that_is_no_trial_says_what_is_wrong(cockpit, name, message):
    page = Page()
    file = SimpleNamespace(name=name, content=b"nothing")
    cockpit._runs._load(SimpleNamespace(client=page, target=SimpleNamespace(value=file)))
    assert message in page.told[0]
    assert cockpit._runs._ghost is None


def test_forces_failure_and_reset_are_shown(cockpit):
    live = cockpit.live
    cockpit.frame()
    assert "largest load of a joint" not in cockpit._figures.content
    live.link_forces = True
    live.advance(0.2)
    for _ in range(12):
        cockpit.frame()
    assert "largest load of a joint" in cockpit._figures.content
    assert cockpit._scene._forces.arrows.points.shape == (9, 2, 3)
    assert cockpit._scene._forces.frame.visible
    assert "speed in the tank" in cockpit._figures.content
    live.simulation = replace(live.simulation, failure="The run diverged.")
    for _ in range(12):
        cockpit.frame()
    assert cockpit._figures.content.startswith("**The run diverged.**")
    cockpit._reset()
    assert live.simulation.failure is None
    live.alter(path=StraightLine())
    cockpit.frame()


@pytest.fixture
def in_space():
    robot = lc.load_robot("mamba-modules")
    water = replace(lc.load_water("paper-lateral"), density=robot.mass / robot.volume)
    start = lc.Start(depth=0.7, roll=0.2, pitch=0.1)
    served = Cockpit(
        Live(lc.build_scenario(robot, GAIT, environment=water, model="spatial", start=start)),
        port=0,
    )
    yield served
    served.close()


def test_depth_pitch_and_roll_are_shown_of_a_robot_in_space(in_space, cockpit):
    live = in_space.live
    live.advance(0.05)
    in_space.frame()
    plotted = live.plots()
    assert plotted["depth"][-1] == pytest.approx(0.7, abs=0.02)
    assert plotted["roll"][-1] == pytest.approx(math.degrees(0.2), abs=1.0)
    assert plotted["pitch"][-1] == pytest.approx(math.degrees(0.1), abs=1.0)
    text = format_figures(live)
    assert "| depth | **0.7" in text and "| pitch | **" in text and "| roll | **" in text
    assert (
        in_space._scene._floor.position[2] == -1.5 and in_space._scene._surface.position[2] == 0.0
    )
    cockpit.live.advance(0.1)
    cockpit.frame()
    assert np.isnan(cockpit.live.plots()["depth"]).all() and "depth" not in format_figures(
        cockpit.live
    )


def test_a_depth_is_held_from_the_page_straight_ahead_or_along_the_path(in_space):
    assert use(in_space, control(in_space, "depth"), 1.0) == []
    live = in_space.live
    assert read_depth(live.scenario) == 1.0 and read_path(live.scenario) is not None
    assert in_space._gizmo.position[2] == -1.0
    before = float(live.latest().center_of_mass[2])
    live.advance(3.0)
    assert live.simulation.failure is None
    assert live.latest().signals["climb_offset"] < 0.0
    live.advance(5.0)
    assert float(live.latest().center_of_mass[2]) < before - 0.05
    assert use(in_space, control(in_space, "depth"), 0.0) == []
    assert read_depth(live.scenario) is None and read_path(live.scenario) is not None
    use(in_space, control(in_space, "path"), False)
    assert live.scenario.motion == live.scenario.gait


def test_the_pitch_wave_has_sliders_and_goes_when_it_is_still(in_space, cockpit):
    use(in_space, control(in_space, "pitch_amplitude"), 20.0)
    use(in_space, control(in_space, "pitch_phase"), 90.0)
    pitch = in_space.live.scenario.gait.pitch
    assert (pitch.amplitude, pitch.phase) == (math.radians(20.0), math.radians(90.0))
    assert (pitch.frequency, pitch.phase_shift) == (GAIT.frequency, GAIT.phase_shift)
    in_space.live.advance(1.0)
    assert in_space.live.simulation.failure is None
    use(in_space, control(in_space, "pitch_amplitude"), 0.0)
    assert in_space.live.scenario.gait.pitch is None
    (told,) = use(cockpit, control(cockpit, "pitch_amplitude"), 20.0)
    assert told.startswith("`gait.pitch` must be None unless `model` is `spatial`")
    (told,) = use(cockpit, control(cockpit, "depth"), 1.0)
    assert told.startswith("`robot` must have pitch joints for a path in space")
    assert cockpit.live.scenario.motion == GAIT


def test_a_helix_around_a_pipe_is_drawn_and_swum_from_a_scenario():
    following = Following(
        circle=(0.0, 0.0, 1.0, 2.0), path_depth=(0.5, 1.0), look_ahead_distance=0.5
    )
    motion, start = following.controller(GAIT), lc.Start(center_of_mass=(0.0, -1.0), depth=0.5)
    pipe = Pipe(bore=0.2, length=1.5, center=(0.0, 0.0, -0.75), tilt=0.5 * math.pi)
    scenario = lc.build_scenario("mamba-modules", motion, model="spatial", scene=pipe, start=start)
    points = sample_route(scenario, 0.0)
    np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1]), 1.0)
    assert points[0, 2] == pytest.approx(-0.5, abs=0.02) and points[-1, 2] == pytest.approx(
        -1.0, abs=0.02
    )
    served = Cockpit(Live(scenario), port=0)
    assert len(served._scene._surroundings) == 24  # the staves of the pipe
    assert not served._gizmo.visible
    served.live.advance(5.0)
    served.frame()
    assert abs(served.live.simulation.cross_track_error) < 0.2
    use(served, control(served, "model"), "planar")  # refused: it has no pitch joints
    assert served.live.scenario == scenario
    use(served, control(served, "path"), False)
    assert served.live.scenario.motion == GAIT and sample_route(served.live.scenario, 0.0).size == 0
    served.close()


def test_a_flow_is_chosen_with_the_numbers_that_it_declares_and_can_be_left(cockpit):
    before = cockpit.live.scenario.environment

    def field(name):
        return control(cockpit, f"flow_{name}")

    assert not use(cockpit, control(cockpit, "flow"), "street")
    flow = cockpit.live.scenario.environment.current
    numbers = {name for name, one in hints_of(type(flow)).items() if one in (float, int)}
    assert numbers == {
        name.removeprefix("flow_") for name in cockpit._controls.by_name if name.startswith("flow_")
    }
    assert not control(cockpit, "current_x").visible
    use(cockpit, field("direction"), 30.0)
    use(cockpit, field("pairs"), 3)
    assert cockpit.live.scenario.environment.current == replace(
        flow, direction=math.radians(30.0), pairs=3
    )
    assert field("direction").value == 30.0 and control(cockpit, "flow").value == "street"
    [told] = use(cockpit, field("diameter"), -1.0)
    assert "`diameter` must be > 0 m" in told and field("diameter").value == flow.diameter
    cockpit.live.advance(0.1)
    cockpit.frame()
    tails, tips = np.moveaxis(cockpit._scene._water._arrows_handle.points, 1, 0)
    middle = 0.5 * (tails + tips)[:, :2].astype(float)
    velocity = cockpit.live.scenario.environment.velocity(middle, cockpit.live.simulation.time)
    assert np.allclose(
        (tips - tails)[:, :2], velocity * cockpit._scene._water._arrows.time, atol=1e-5
    )
    assert not use(cockpit, control(cockpit, "flow"), "uniform")
    assert cockpit.live.scenario.environment == before and control(cockpit, "current_x").visible
    assert not any(name.startswith("flow_") for name in cockpit._controls.by_name)


def at_start(robot):
    gait = GAIT
    parameters = lc.load_parameters("mamba-identified")
    return lc.build_scenario(robot, gait, parameters=parameters)


def test_another_robot_comes_with_what_was_identified_on_it_or_with_its_default_water():
    identified = at_start("mamba")
    with_fin = adapt_scenario(identified, robot=lc.load_robot("mamba-fin"))
    assert with_fin == at_start("mamba-fin")
    other = adapt_scenario(with_fin, robot=lc.load_robot("amphibot"))
    assert other == lc.build_scenario("amphibot", GAIT)
    assert adapt_scenario(other, robot=lc.load_robot("mamba")) == identified


def test_a_current_stays_when_the_robot_changes():
    identified = at_start("mamba")
    moving = replace(identified.environment, current=(0.1, 0.0))
    other = adapt_scenario(replace(identified, environment=moving), robot=lc.load_robot("amphibot"))
    assert other.environment.current == (0.1, 0.0)


def test_a_water_that_somebody_chose_stays_when_the_robot_changes():
    chosen = lc.build_scenario("mamba", GAIT, environment="paper-vortex")
    other = adapt_scenario(chosen, robot=lc.load_robot("mamba-fin"))
    assert other.environment == chosen.environment
    assert other.model.joints == lc.Prescribed()


def test_controls_are_shown_only_where_they_do_something(cockpit):
    assert not cockpit._controls._space_folder.visible
    assert not control(cockpit, "rigidity").visible
    use(cockpit, control(cockpit, "fin"), "elastic")
    assert control(cockpit, "rigidity").visible
