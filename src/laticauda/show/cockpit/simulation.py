"""Simulation behind the page: a value, from which `advance` and `switch_to` make another one."""

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, cast

import numpy as np

import laticauda as lc
from laticauda.models.simulate import plant_of_scenario
from laticauda.scenarios import Scenario, check_plausible
from laticauda.show.cockpit.changes import check_scenario, read_path
from laticauda.values import check_instance, series

TICK = 0.025
"""Time between two samples [s]."""
FADE = 1.0
"""How long the amplitude is 0 before another kind of gait begins [s].

After 10 time constants of the generator's filter, about 1e-3 of the amplitude is left.
"""
LONGEST_INTERVAL = 1e3
"""Control interval that stands for an infinite one [s]."""


class PendingCommand(NamedTuple):
    """A command on its way to the joints."""

    arrival: int
    """Tick at which it arrives."""
    command: lc.Command


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
    envelope_gait: lc.Gait
    """Gait whose envelope is in use: the old one until its amplitude has decayed."""
    fade: float = 0.0
    """Remaining time of that decay [s]."""
    ticks: int = 0
    """Ticks since the simulation began [-]."""
    next_control: int = 0
    """Tick at which the controller runs next."""
    pending: tuple[PendingCommand, ...] = ()
    """Commands that have not arrived yet, the oldest first."""
    failure: str | None = None
    """What went wrong, after which the simulation stands still; None if nothing did."""

    @property
    def time(self) -> float:
        """Time since the simulation began [s]."""
        return self.ticks * TICK

    @property
    def plant_command(self) -> lc.Command:
        """Command given to the plant now: `command`, except while another kind of gait has to wait."""
        if self.fade == 0.0:
            return self.command
        return replace(self.command, gait=replace(self.envelope_gait, amplitude=0.0))

    @property
    def control_ticks(self) -> int:
        """Number of ticks for which a command is held [-]."""
        interval = min(self.scenario.controller.interval, LONGEST_INTERVAL)
        return max(round(interval / TICK), 1)

    @property
    def delay_ticks(self) -> int:
        """Number of ticks by which a command is delayed [-]."""
        if isinstance(self.scenario.motion, lc.Gait):
            return 0
        return round(self.scenario.model.loop_delay / TICK)

    @property
    def has_interval(self) -> bool:
        """Whether a command is delayed and held for as long as the scenario says, or held until the end."""
        interval = self.scenario.controller.interval
        if math.isinf(interval):
            return True
        delay = self.scenario.model.loop_delay
        if not math.isclose(delay, self.delay_ticks * TICK, abs_tol=1e-9):
            return False
        return math.isclose(interval, self.control_ticks * TICK)

    @property
    def cross_track_error(self) -> float:
        """Distance from the path, positive to its left; nan without a path [m]."""
        path = read_path(self.scenario)
        if path is None:
            return math.nan
        position = np.asarray(self.plant.observe(self.state).center_of_mass)[:2]
        _, location = path.locate(self.controller_state.progress, position)
        return location.cross_track_error

    # ---- another scenario ------------------------------------------------------------------------

    def switch_to(self, scenario: Scenario) -> "Simulation":
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
            return begin_simulation(scenario, before=self.scenario)
        check_scenario(scenario)
        check_plausible(scenario, before=self.scenario)
        moved = self._with_body(scenario)
        steered = moved._with_steering(scenario)
        fading = steered._with_gait(scenario)
        switched = replace(fading, scenario=scenario, failure=None)
        switched.check_plant()
        return switched

    def _with_body(self, scenario: Scenario) -> "Simulation":
        """Return the simulation with the plant of another scenario, in the state that continues this one's."""
        if _bodies_are_equal(scenario, self.scenario):
            return self
        plant = plant_of_scenario(scenario)
        return replace(self, plant=plant, state=self._carry_state(plant, scenario.gait))

    def _carry_state(self, plant: lc.Plant[Any], gait: lc.Gait) -> Any:
        """Return the present state for another plant, or a new state at the same position."""
        n_links = self.plant.robot.n_links
        if type(plant) is type(self.plant) and plant.robot.n_links == n_links:
            with suppress(ValueError):  # an elastic fin has more numbers
                return plant.unpack(self.plant.pack(self.state))
        observation = self.plant.observe(self.state)
        position = [float(value) for value in observation.center_of_mass]
        start = lc.Start(
            center_of_mass=(position[0], position[1]), heading=float(observation.heading)
        )
        is_spatial = len(position) == 3
        if is_spatial and getattr(plant.settings, "root", None) == "free":
            start = replace(start, depth=-position[2])
        return plant.init(start, lc.Command(gait=gait))

    def _with_steering(self, scenario: Scenario) -> "Simulation":
        """Return the simulation with another scenario's controller, which begins anew if it follows another path."""
        old = self.scenario
        is_same_kind = type(scenario.motion) is type(old.motion)
        if is_same_kind and read_path(scenario) == read_path(old):
            return self
        state = scenario.controller.init()
        return replace(self, controller_state=state, next_control=self.ticks)

    def _with_gait(self, scenario: Scenario) -> "Simulation":
        """Return the simulation with another scenario's gait in all of its commands.

        Steering goes on from where it is; without steering, commands on their way are dropped.
        """
        gait = scenario.gait
        command = lc.Command(gait=gait)
        pending: list[PendingCommand] = []
        is_steered = not isinstance(scenario.motion, lc.Gait)
        if is_steered:
            command = replace(command, offset=self.command.offset)
            for arrival, old_command in self.pending:
                pending.append(PendingCommand(arrival, replace(old_command, gait=gait)))
        envelope_gait = gait
        fade = 0.0
        if gait.kind != self.envelope_gait.kind:
            envelope_gait = self.envelope_gait
            fade = self.fade or FADE
        return replace(
            self,
            command=command,
            pending=tuple(pending),
            envelope_gait=envelope_gait,
            fade=fade,
        )

    def check_plant(self) -> None:
        """Reject now what the plant would reject at the next tick.

        Raises:
            ValueError: If the plant cannot execute the command.
        """
        self.plant.march(self.state, self.plant_command, TICK, TICK)

    # ---- time ------------------------------------------------------------------------------------

    def advance(self, *, link_forces: bool = False) -> tuple["Simulation", series.Log]:
        """Return the simulation one `TICK` later, and the log of both ends of the tick, with the controller's signals.

        Args:
            link_forces: Whether to also log the force on every link.
        """
        now = self
        if now.ticks >= now.next_control:
            now = now._run_controller()
        now = now._receive_commands()
        state, log, failure = now.plant.march(
            now.state, now.plant_command, TICK, TICK, link_forces=link_forces
        )
        later = replace(now._shorten_fade(), state=state, ticks=now.ticks + 1, failure=failure)
        signals = dict(log.signals)
        for name, value in now.scenario.controller.signals(now.controller_state).items():
            signals[name] = np.full(log.time.size, value)
        return later, replace(log, signals=signals)

    def _run_controller(self) -> "Simulation":
        observation = self.plant.observe_under(self.state, self.plant_command)
        state, command = self.scenario.controller.step(self.controller_state, observation)
        pending = PendingCommand(self.ticks + self.delay_ticks, command)
        return replace(
            self,
            controller_state=state,
            pending=(*self.pending, pending),
            next_control=self.ticks + self.control_ticks,
        )

    def _receive_commands(self) -> "Simulation":
        """Return the simulation with the newest command that has arrived."""
        command: lc.Command | None = None
        still_pending: list[PendingCommand] = []
        for pending in self.pending:
            if pending.arrival <= self.ticks:
                command = pending.command
            else:
                still_pending.append(pending)
        if command is None:
            return self
        return replace(self, command=command, pending=tuple(still_pending))

    def _shorten_fade(self) -> "Simulation":
        """Return the simulation with one tick less of its fade; at its end, the new gait begins."""
        if self.fade == 0.0:
            return self
        fade = max(self.fade - TICK, 0.0)
        if fade < 0.5 * TICK:
            return replace(self, fade=0.0, envelope_gait=self.scenario.gait)
        return replace(self, fade=fade)


def _bodies_are_equal(first: Scenario, second: Scenario) -> bool:
    """Return whether two scenarios have the same plant."""
    return (first.robot, first.environment, first.model) == (
        second.robot,
        second.environment,
        second.model,
    )


def begin_simulation(scenario: Scenario, before: Scenario | None = None) -> Simulation:
    """Create a simulation in which the robot lies straight, at the scenario's start.

    Args:
        scenario: The scenario to simulate.
        before: The scenario that it was changed from, whose doubts are known.

    Raises:
        ValueError: If the scenario is inconsistent, or a page cannot show it.
    """
    check_plausible(check_scenario(scenario), before)
    plant = plant_of_scenario(scenario)
    start = scenario.start
    check_instance("start", start, lc.Start)
    command = lc.Command(gait=scenario.gait)
    simulation = Simulation(
        scenario=scenario,
        plant=plant,
        state=plant.init(cast(lc.Start, start), command),
        controller_state=scenario.controller.init(),
        command=command,
        envelope_gait=scenario.gait,
    )
    simulation.check_plant()
    return simulation
