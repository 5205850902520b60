"""Simulation behind the page: a value from which `advance` and `altered` make another one; changes by a page."""

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, TypedDict, Unpack, cast

import numpy as np

import laticauda as lc
from laticauda import control
from laticauda.robot.environment import Current
from laticauda.scenarios import Model, Planar, Scenario, default_water, model_of
from laticauda.trials.measured import MeasuredTrial, measured_setting
from laticauda.values import series
from laticauda.values.checks import check_instance

TICK = 0.025  # time between two samples [s]
# How long the amplitude is 0 before another kind of gait begins: after 10 time constants of the
# generator's filter, about 1e-3 of it is left.
FADE = 1.0  # [s]
N_HINGES = 3  # of an elastic fin
STILL = (0.0, 0.0)
WIDE = 60.0  # to either side, of an unbounded path [m]


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulation:
    """A scenario at one instant."""

    scenario: Scenario
    """Robot, motion, environment and model."""
    plant: lc.Plant[Any]
    """Plant of the scenario."""
    state: Any
    """State of the plant."""
    controller_state: Any
    """State of the scenario's controller."""
    command: lc.Command
    """Command in effect: the controller's last one, or what is left of it until the loop's delay is over."""
    shape: lc.Gait
    """Gait whose envelope is in use: the old one until its amplitude has decayed."""
    fade: float = 0.0
    """Remaining time of that decay [s]."""
    ticks: int = 0
    """Ticks since the simulation began [-]."""
    next_control: int = 0
    """Tick at which the controller runs next."""
    coming: tuple[tuple[int, lc.Command], ...] = ()
    """Commands on their way to the joints, and the tick at which each arrives."""
    failure: str | None = None
    """What went wrong, after which the simulation stands still; None if nothing did."""

    @property
    def time(self) -> float:
        """Time since the simulation began [s]."""
        return self.ticks * TICK

    @property
    def held(self) -> lc.Command:
        """Command given to the plant now: `command`, except while another kind of gait has to wait."""
        if self.fade == 0.0:
            return self.command
        return replace(self.command, gait=replace(self.shape, amplitude=0.0))

    @property
    def control_ticks(self) -> int:
        """Number of ticks for which a command is held [-]."""
        return max(round(min(self.scenario.controller.interval, 1e3) / TICK), 1)

    @property
    def delay_ticks(self) -> int:
        """Number of ticks by which a command is delayed [-]."""
        return (
            0
            if isinstance(self.scenario.motion, lc.Gait)
            else round(self.scenario.model.loop_delay / TICK)
        )

    @property
    def has_interval(self) -> bool:
        """Whether a command is delayed and held for as long as the scenario says, or held until the end."""
        interval, delay = self.scenario.controller.interval, self.scenario.model.loop_delay
        if math.isinf(interval):
            return True
        late = math.isclose(delay, self.delay_ticks * TICK, abs_tol=1e-9)
        return late and math.isclose(interval, self.control_ticks * TICK)

    @property
    def cross_track_error(self) -> float:
        """Distance from the path, positive to its left; nan without a path [m]."""
        path = path_of(self.scenario)
        if path is None:
            return float("nan")
        at = np.asarray(self.plant.observe(self.state).center_of_mass)[:2]
        return path.locate(self.controller_state.progress, at)[1].cross_track_error

    def altered(self, scenario: Scenario) -> "Simulation":
        """Return the simulation with another scenario from now on; before the first tick, one that begins with it.

        The reference generator changes smoothly to another gait, so that nothing jumps. Another
        body (robot, water, model) continues from the same state if its state has the same numbers;
        otherwise it starts straight and at rest, at the same position and heading.

        Args:
            scenario: The new scenario.

        Raises:
            ValueError: If the scenario is inconsistent; the simulation stays unchanged.
        """
        if self.ticks == 0:
            return begin_simulation(scenario)
        old, body, state = self.scenario, self.plant, self.state
        check_scenario(scenario)
        if (scenario.robot, scenario.environment, scenario.model) != (
            old.robot,
            old.environment,
            old.model,
        ):
            body = lc.build_plant(scenario)
            state = self._carried(body, scenario.gait)
        goes_on = type(scenario.motion) is type(old.motion) and path_of(scenario) == path_of(old)
        steering = (
            {}
            if goes_on
            else {"controller_state": scenario.controller.init(), "next_control": self.ticks}
        )
        is_steered = not isinstance(scenario.motion, lc.Gait)
        fading = scenario.gait.kind != self.shape.kind
        after = replace(
            self,
            scenario=scenario,
            plant=body,
            state=state,
            command=lc.Command(
                gait=scenario.gait, offset=self.command.offset if is_steered else 0.0
            ),
            coming=tuple((at, replace(one, gait=scenario.gait)) for at, one in self.coming)
            if is_steered
            else (),
            shape=self.shape if fading else scenario.gait,
            fade=(self.fade or FADE) if fading else 0.0,
            failure=None,
            **steering,
        )
        body.march(after.state, after.held, TICK, TICK)  # rejects now what it would reject later
        return after

    def _carried(self, body: lc.Plant[Any], gait: lc.Gait) -> Any:
        """Return the old state for a new body, or a new state at the same position."""
        if type(body) is type(self.plant) and self.plant.robot.n_links == body.robot.n_links:
            with suppress(ValueError):  # an elastic fin has more numbers
                return body.unpack(self.plant.pack(self.state))
        now = self.plant.observe(self.state)
        x, y, *height = (float(value) for value in now.center_of_mass)
        start = lc.Start(center_of_mass=(x, y), heading=float(now.heading))
        if height and getattr(body.settings, "root", None) == "free":
            start = replace(start, depth=-height[0])
        return body.init(start, lc.Command(gait=gait))

    def advance(self, *, link_forces: bool = False) -> tuple["Simulation", series.Log]:
        """Return the simulation one `TICK` later, and the log of both ends of the tick, with the controller's signals.

        Args:
            link_forces: Whether to also log the force on every link.
        """
        now, body, controller = self, self.plant, self.scenario.controller
        if now.ticks >= now.next_control:
            state, command = controller.step(now.controller_state, body.observe(now.state))
            coming = (*now.coming, (now.ticks + now.delay_ticks, command))
            now = replace(
                now,
                controller_state=state,
                coming=coming,
                next_control=now.ticks + now.control_ticks,
            )
        if due := [command for at, command in now.coming if at <= now.ticks]:
            now = replace(
                now, command=due[-1], coming=tuple(one for one in now.coming if one[0] > now.ticks)
            )
        state, log, failure = body.march(now.state, now.held, TICK, TICK, link_forces=link_forces)
        signals = {
            name: np.full(log.time.size, one)
            for name, one in controller.signals(now.controller_state).items()
        }
        fade = max(now.fade - TICK, 0.0)
        done = now.fade > 0.0 and fade < 0.5 * TICK
        after = replace(
            now,
            state=state,
            fade=0.0 if done else fade,
            shape=now.scenario.gait if done else now.shape,
            ticks=now.ticks + 1,
            failure=failure,
        )
        return after, replace(log, signals={**log.signals, **signals})


def begin_simulation(scenario: Scenario) -> Simulation:
    """Create a simulation in which the robot lies straight, at the scenario's start.

    Args:
        scenario: The scenario to simulate.

    Raises:
        ValueError: If the scenario is inconsistent, or a page cannot show it.
    """
    body, start = lc.build_plant(check_scenario(scenario)), scenario.start
    check_instance("start", start, lc.Start)
    command = lc.Command(gait=scenario.gait)
    state = body.init(cast(lc.Start, start), command)
    body.march(state, command, TICK, TICK)  # rejects now what it would reject later
    return Simulation(
        scenario=scenario,
        plant=body,
        state=state,
        controller_state=scenario.controller.init(),
        command=command,
        shape=scenario.gait,
    )


# ---- changes to a scenario that a page can make, and what they entail ----------------------------


class Changes(TypedDict, total=False):
    """Possible changes; `model` and `joints` may be names, and None means no `path`, or no `depth` along it."""

    robot: lc.Robot
    gait: lc.Gait
    environment: lc.Water
    current: Current
    model: Model | str
    joints: lc.JointLaw | str
    path: control.Path[Any] | None
    depth: float | None


def adapt_scenario(scenario: Scenario, **changes: Unpack[Changes]) -> Scenario:
    """Return a changed scenario; the default water adapts to robot and gait.

    Args:
        scenario: The current scenario.
        changes: Fields to change.

    Raises:
        ValueError: If a value is out of range.
    """
    gait, motion, model = changes.get("gait", scenario.gait), scenario.motion, scenario.model
    path, depth = changes.get("path", path_of(scenario)), changes.get("depth", depth_of(scenario))
    if path is None:
        motion = (
            gait
            if "path" in changes or isinstance(motion, lc.Gait)
            else replace(cast("Any", motion), gait=gait)
        )
    elif isinstance(motion, lc.PathFollowing) and depth == depth_of(scenario):
        motion = replace(motion, gait=gait, path=path)
    else:
        steering = lc.Following(path_depth=None if depth is None else (depth,)).controller(gait)
        motion = replace(steering, path=path)
    if "model" in changes or "joints" in changes:
        model = model_of(changes.get("model", model), joints=changes.get("joints", model.joints))
    robot, water = (
        changes.get("robot", scenario.robot),
        changes.get("environment", scenario.environment),
    )
    assert isinstance(water, lc.Water)
    current = changes.get("current", water.current)
    if replace(water, current=STILL) == default_water(scenario.robot, scenario.gait):
        water = default_water(robot, gait)
    water = water if water.current == current else replace(water, current=current)
    return replace(scenario, robot=robot, motion=motion, environment=water, model=model)


def check_scenario(scenario: Scenario) -> Scenario:
    """Return the scenario, if a page can show it.

    Raises:
        ValueError: If the robot is not in water, is steered by anything other than path following,
            or its joints have no room for the steering.
    """
    check_instance("environment", scenario.environment, lc.Water)
    check_instance("motion", scenario.motion, lc.Gait, lc.PathFollowing)
    scenario.controller.check(
        scenario.robot.planar() if isinstance(scenario.model, Planar) else scenario.robot
    )
    return scenario


def path_of(scenario: Scenario) -> control.Path[Any] | None:
    """Return the path that is followed, in plan view, or None."""
    return scenario.motion.path if isinstance(scenario.motion, lc.PathFollowing) else None


def route_of(scenario: Scenario, height: float) -> np.ndarray:
    """Return points of the followed path [m], if any: at its own heights, or at `height` if depth is not steered."""
    path = path_of(scenario)
    if path is None:
        return np.empty((0, 3))
    end = getattr(path, "lengths", (0.0,))[
        -1
    ]  # a straight line has none; in pieces, else too little is shown
    along = np.arange(0.0, end, 0.05) if end else np.arange(-WIDE, WIDE, 2.0)
    profile = np.array([(0.0, height)])
    if isinstance(scenario.motion, lc.SpatialPathFollowing):
        profile = scenario.motion.profile.points(np.linspace(-WIDE, WIDE + 2.0 * end, 4000))
    heights = np.interp(along, profile[:, 0], profile[:, 1])
    return np.column_stack((path.points(along), heights))


def depth_of(scenario: Scenario) -> float | None:
    """Return the depth that is held along the path, or None [m]."""
    profile = (
        scenario.motion.profile if isinstance(scenario.motion, lc.SpatialPathFollowing) else None
    )
    return -profile.point[1] if isinstance(profile, lc.StraightLine) else None


def find_measured(scenario: Scenario) -> MeasuredTrial | None:
    """Return the paper's trial with this scenario, or None."""
    gait = scenario.motion if isinstance(scenario.motion, lc.Gait) else None
    return measured_setting(scenario.robot, gait, scenario.environment)


def change_fin(robot: lc.Robot, has_fin: bool, rigidity: float | None) -> lc.Robot:
    """Return the robot with or without a fin: its own, or Mamba's if it has none.

    Args:
        robot: The robot.
        has_fin: Whether the result has a fin.
        rigidity: E I of an elastic fin; None: rigid [N m^2].

    Raises:
        ValueError: If the rigidity is not positive.
    """
    if not has_fin:
        return robot if robot.caudal_fin is None else replace(robot, caudal_fin=None)
    fin = robot.caudal_fin or lc.load_robot("mamba-fin").caudal_fin
    assert fin is not None
    hinges = 0 if rigidity is None else N_HINGES
    return replace(robot, caudal_fin=replace(fin, n_hinges=hinges, flexural_rigidity=rigidity))
