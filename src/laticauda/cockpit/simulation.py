"""The simulation behind the page: one value, that `advance` and `altered` make another one of."""

from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from laticauda.cockpit.changes import checked, path_of
from laticauda.errors import instance
from laticauda.gaits import Gait
from laticauda.interfaces import Command, Log, Plant, Start
from laticauda.scenarios import Scenario
from laticauda.simulate import plant

TICK = 0.025  # time between two samples, and twice that between two control instants [s]
# For how long the amplitude is 0 before another kind of gait begins: 10 time constants of the generator's filter leave
# some 1e-3 of it.
FADE = 1.0  # [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulation:
    """A scenario at one instant."""

    scenario: Scenario
    """What swims how, where and by which model."""
    plant: Plant[Any]
    """That of the scenario."""
    state: Any
    """Of the plant."""
    controller_state: Any
    """Of the scenario's controller."""
    offset: float = 0.0
    """What the controller steers [rad]."""
    shape: Gait
    """The gait whose envelope is swum: the old one until its amplitude has come down."""
    fade: float = 0.0
    """How long it still has to [s]."""
    ticks: int = 0
    """Since the simulation began [-]."""
    failure: str | None = None
    """What went wrong; it stands still then."""

    @property
    def time(self) -> float:
        """Since the simulation began [s]."""
        return self.ticks * TICK

    @property
    def is_steered(self) -> bool:
        """Whether a controller steers the gait."""
        return not isinstance(self.scenario.motion, Gait)

    @property
    def command(self) -> Command:
        """What the plant is given now."""
        gait = replace(self.shape, amplitude=0.0) if self.fade > 0.0 else self.scenario.gait
        return Command(gait=gait, offset=self.offset)


def begin(scenario: Scenario) -> Simulation:
    """A simulation in which the robot lies straight, as the scenario's start says.

    Args:
        scenario: What swims how.

    Raises:
        ValueError: If it does not go together, or a page cannot show it.
    """
    body, start = plant(checked(scenario)), scenario.start
    instance("start", start, Start)
    return Simulation(
        scenario=scenario,
        plant=body,
        state=body.init(cast(Start, start), Command(gait=scenario.gait)),
        controller_state=scenario.controller.init(),
        shape=scenario.gait,
    )


def altered(simulation: Simulation, scenario: Scenario) -> Simulation:
    """The simulation with another scenario, from now on.

    Another gait is taken up by the reference generator, so that nothing jumps. Another body (robot, water, model) goes
    on from the same state where that has the same numbers, else straight and at rest at the same place and heading.

    Args:
        simulation: As it is.
        scenario: As it is to be.

    Raises:
        ValueError: If the scenario does not go together; the simulation stays what it was.
    """
    old, body, state = simulation.scenario, simulation.plant, simulation.state
    checked(scenario)
    if (scenario.robot, scenario.environment, scenario.model) != (old.robot, old.environment, old.model):
        body = plant(scenario)
        state = _carried(simulation, body, scenario.gait)
    goes_on = type(scenario.motion) is type(old.motion) and path_of(scenario) == path_of(old)
    fading = scenario.gait.kind != simulation.shape.kind
    after = replace(
        simulation,
        scenario=scenario,
        plant=body,
        state=state,
        controller_state=simulation.controller_state if goes_on else scenario.controller.init(),
        offset=0.0 if isinstance(scenario.motion, Gait) else simulation.offset,
        shape=simulation.shape if fading else scenario.gait,
        fade=(simulation.fade or FADE) if fading else 0.0,
        failure=None,
    )
    body.march(after.state, after.command, TICK, TICK)  # refuses now what it would refuse later
    return after


def _carried(simulation: Simulation, body: Plant[Any], gait: Gait) -> Any:
    """The old state in a new body, or a new one at the same place."""
    if type(body) is type(simulation.plant) and simulation.plant.robot.n_links == body.robot.n_links:
        try:
            return body.unpack(simulation.plant.pack(simulation.state))
        except ValueError:
            pass  # a fin that bends has more numbers
    now = simulation.plant.observe(simulation.state)
    x, y = (float(value) for value in now.center_of_mass[:2])
    return body.init(Start(center_of_mass=(x, y), heading=float(now.heading)), Command(gait=gait))


def advance(simulation: Simulation, *, link_forces: bool = False) -> tuple[Simulation, Log]:
    """The simulation one `TICK` later, and what the plant logged: two samples, or one where it failed.

    Args:
        simulation: As it is.
        link_forces: Whether to log the force on every link too.
    """
    now, body = simulation, simulation.plant
    if now.is_steered and (now.ticks % 2 == 0 or now.controller_state.time is None):
        state, command = now.scenario.controller.step(now.controller_state, body.observe(now.state))
        now = replace(now, controller_state=state, offset=command.offset)
    state, log, failure = body.march(now.state, now.command, TICK, TICK, link_forces=link_forces)
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
    return after, log


def cross_track_error(simulation: Simulation) -> float:
    """Distance from the path, positive to its left; nan without a path [m]."""
    path = path_of(simulation.scenario)
    if path is None:
        return float("nan")
    at = np.asarray(simulation.plant.observe(simulation.state).center_of_mass)[:2]
    return path.locate(None, at)[1].cross_track_error
