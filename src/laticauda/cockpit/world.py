"""The simulated world of the cockpit: one value, that `advance` and `altered` make another one of."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.cockpit.settings import Setting
from laticauda.control import PathFollowing, PathFollowingState
from laticauda.gaits import Gait
from laticauda.interfaces import Command, Log, Plant, Start

TICK = 0.025  # time between two samples, and twice that between two control instants [s]
# For how long the amplitude is 0 before another kind of gait begins: 10 time constants of the generator's filter leave
# some 1e-3 of it.
FADE = 1.0  # [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class World:
    """Robot and water at one instant."""

    setting: Setting
    """What is asked for."""
    plant: Plant[Any]
    """That of the setting."""
    state: Any
    """Of the plant."""
    controller: PathFollowing | None
    """That of the setting, or None."""
    thought: PathFollowingState | None
    """State of the controller, or None."""
    offset: float = 0.0
    """What the controller steers [rad]."""
    shape: Gait
    """The gait whose envelope is swum: the old one until its amplitude has come down."""
    fade: float = 0.0
    """How long it still has to [s]."""
    ticks: int = 0
    """Since the world began [-]."""
    failure: str | None = None
    """What went wrong; the world stands still then."""

    @property
    def time(self) -> float:
        """Since the world began [s]."""
        return self.ticks * TICK

    @property
    def command(self) -> Command:
        """What the plant is asked for now."""
        gait = replace(self.shape, amplitude=0.0) if self.fade > 0.0 else self.setting.gait
        return Command(gait=gait, offset=self.offset)


def begin(setting: Setting, start: Start | None = None) -> World:
    """A world in which the robot lies straight and at rest.

    Args:
        setting: What swims how.
        start: Where; None: at the origin, along x.

    Raises:
        ValueError: If the setting does not go together.
    """
    body, controller = setting.plant(), setting.controller()
    return World(
        setting=setting,
        plant=body,
        state=body.init(start or Start(), Command(gait=setting.gait)),
        controller=controller,
        thought=None if controller is None else controller.init(),
        shape=setting.gait,
    )


def altered(world: World, setting: Setting) -> World:
    """The world with another setting, from now on.

    Another gait is taken up by the reference generator, so that nothing jumps. Another body (robot, water, model,
    joints) goes on from the same state where that has the same numbers, else straight and at rest at the same place
    and heading.

    Args:
        world: As it is.
        setting: As it is to be.

    Raises:
        ValueError: If the setting does not go together; the world stays what it was.
    """
    old = world.setting
    controller = setting.controller()
    body, state = world.plant, world.state
    if setting.body() != old.body():
        body = setting.plant()
        state = _carried(world, body, setting)
    same_path = controller is not None and world.controller is not None and setting.path == old.path
    fading = setting.gait.kind != world.shape.kind
    after = replace(
        world,
        setting=setting,
        plant=body,
        state=state,
        controller=controller,
        thought=None if controller is None else world.thought if same_path else controller.init(),
        offset=world.offset if controller is not None else 0.0,
        shape=world.shape if fading else setting.gait,
        fade=(world.fade or FADE) if fading else 0.0,
        failure=None,
    )
    body.march(after.state, after.command, TICK, TICK)  # refuses now what it would refuse later
    return after


def _carried(world: World, body: Plant[Any], setting: Setting) -> Any:
    """The old state in a new body, or a new one at the same place."""
    if type(body) is type(world.plant) and world.plant.robot.n_links == body.robot.n_links:
        try:
            return body.unpack(world.plant.pack(world.state))
        except ValueError:
            pass  # a fin that bends has more numbers
    seen = world.plant.observe(world.state)
    x, y = (float(value) for value in seen.center_of_mass[:2])
    return body.init(Start(center_of_mass=(x, y), heading=float(seen.heading)), Command(gait=setting.gait))


def advance(world: World, *, link_forces: bool = False) -> tuple[World, Log]:
    """The world one `TICK` later, and what the plant logged: two samples, or one where it failed.

    Args:
        world: As it is.
        link_forces: Whether to log the force on every link too.
    """
    thought, offset = world.thought, world.offset
    if world.controller is not None and thought is not None and (world.ticks % 2 == 0 or thought.time is None):
        thought, command = world.controller.step(thought, world.plant.observe(world.state))
        offset = command.offset
    world = replace(world, thought=thought, offset=offset)
    state, log, failure = world.plant.march(world.state, world.command, TICK, TICK, link_forces=link_forces)
    fade = max(world.fade - TICK, 0.0)
    done = world.fade > 0.0 and fade < 0.5 * TICK
    return (
        replace(
            world,
            state=state,
            fade=0.0 if done else fade,
            shape=world.setting.gait if done else world.shape,
            ticks=world.ticks + 1,
            failure=failure,
        ),
        log,
    )


def cross_track_error(world: World) -> float:
    """Distance from the path, positive to its left; nan without a path [m]."""
    if world.setting.path is None:
        return float("nan")
    at = np.asarray(world.plant.observe(world.state).center_of_mass)[:2]
    return world.setting.path.locate(None, at)[1].cross_track_error
