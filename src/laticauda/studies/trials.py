"""The trials of a sweep: what all of them share, and what the points of one region come to."""

import dataclasses
import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Shaped

from laticauda.errors import instance, not_negative, one_of, positive
from laticauda.gaits import Gait
from laticauda.robot import Environment, Ground, Robot, Water, load_water
from laticauda.scenarios import default_water
from laticauda.simulate import plant, swim_many
from laticauda.simulate.numbers import Parameter, changed, check_whole, look_up, parameters, place

Table = Float[np.ndarray, "n_points n_names"]
Column = Shaped[np.ndarray, " n_points"]

JOINTS = ("prescribed", "pd", "servo")
QUANTITIES = {
    "forward_velocity": ("m/s", "forward velocity, straight line over the whole run"),
    "steady_velocity": ("m/s", "the same over whole gait cycles after the transient"),
    "mechanical_power": ("W", "mechanical power, mean of sum |u phi'|"),
    "net_power": ("W", "mechanical power, net"),
    "mean_power": ("W", "electrical power where there is a power model, else the mechanical power"),
    "cost_of_transport": ("1", "cost of transport: mean power / (weight of the displaced water * forward velocity)"),
    "succeeded": ("", "whether the run reached its end"),
}
"""What is kept of every trial: unit and title by name."""
# More corners than this are not worth the time: every range's ends are tried in any case.
MOST_CORNERS = 256


@dataclass(frozen=True, kw_only=True, eq=False)
class Setup:
    """What all trials of a sweep share, apart from the numbers that are swept.

    Raises:
        ValueError: If a field is out of its range.
    """

    robot: Robot
    """What swims."""
    gait: Gait
    """What the joints are asked for."""
    environment: Environment | None = None
    """Where; None takes the paper's water for the gait."""
    duration: float = 30.0
    """Of every trial [s]."""
    joints: str = "prescribed"
    """See `laticauda.simulate.plant`."""
    dt: float | None = None
    """See `laticauda.simulate.plant` [s]."""
    offset_bandwidth: float = 10.0
    """See `laticauda.simulate.plant` [rad/s]."""
    ramp: float | None = None
    """See `laticauda.simulate.plant` [s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        instance("robot", self.robot, Robot)
        instance("gait", self.gait, Gait)
        if self.environment is None:
            object.__setattr__(self, "environment", load_water(default_water(self.gait)))
        instance("environment", self.environment, Water, Ground)
        positive("duration", self.duration, "s")
        one_of("joints", self.joints, JOINTS)
        positive("offset_bandwidth", self.offset_bandwidth, "rad/s")
        for check, name in ((positive, "dt"), (not_negative, "ramp")):
            value = getattr(self, name)
            if value is not None:
                check(name, value, "s")

    @property
    def where(self) -> Environment:
        """The environment, which is never None once it is checked."""
        assert self.environment is not None
        return self.environment

    @property
    def setup(self) -> "Setup":
        """This part alone, without the points of a sweep: what a worker needs."""
        return Setup(**{field.name: getattr(self, field.name) for field in dataclasses.fields(Setup)})

    def known(self) -> dict[str, Parameter]:
        """What can be swept, by name."""
        return parameters(self.robot, self.gait, self.where)


def check_ranges(setup: Setup, ranges: Mapping[str, tuple[float, float]], argument: str = "points") -> None:
    """Refuse what cannot be swept, before any work is done.

    The ends of all ranges are tried, alone and together: fields have bounds, and some are bounds of others.

    Args:
        setup: What all trials share.
        ranges: Least and greatest value by parameter.
        argument: Where they are from, for messages.

    Raises:
        ValueError: If there is no such parameter, or a value is out of its range; the message has its name.
    """
    known = setup.known()
    for name, ends in ranges.items():
        parameter = look_up(name, known, argument)
        check_whole(parameter, np.array(ends))
    corners: Iterable[tuple[float, ...]] = itertools.product(*ranges.values())
    if 2 ** len(ranges) > MOST_CORNERS:
        corners = zip(*ranges.values(), strict=True)
    for corner in corners:
        values = dict(zip(ranges, corner, strict=True))
        try:
            robot, gait, environment = changed(setup.robot, setup.gait, setup.where, values)
            body = plant(
                robot,
                environment,
                joints=setup.joints,
                dt=setup.dt,
                offset_bandwidth=setup.offset_bandwidth,
                ramp=setup.ramp,
            )
            gait.joint_envelope(body.robot.planar().n_links)
        except ValueError as error:
            listed = ", ".join(f"{name} = {value:g}" for name, value in values.items())
            reason = str(error).replace("`", "")  # these are no arguments of the caller
            raise ValueError(
                f"`{argument}` must be within the bounds of what is swept, got {listed}: {reason}"
            ) from error


def swim_points(setup: Setup, names: tuple[str, ...], table: Table, threads: int | None = None) -> dict[str, Column]:
    """Let the robots of some points swim.

    Args:
        setup: What all trials share.
        names: Of the parameters, a column of the table each.
        table: The points, a row each.
        threads: See `laticauda.simulate.swim_many`.

    Returns:
        A value per point of every quantity in `QUANTITIES`; nan where a run blew up, or where there is none.
    """
    robots, gaits, environments = things(setup, names, table)
    swims = swim_many(
        robots,
        gaits,
        setup.duration,
        environments=environments,
        joints=setup.joints,
        dt=setup.dt,
        offset_bandwidth=setup.offset_bandwidth,
        ramp=setup.ramp,
        threads=threads,
    )
    return {name: getattr(swims, name) for name in QUANTITIES}


def things(setup: Setup, names: tuple[str, ...], table: Table) -> tuple[list[Robot], list[Gait], list[Environment]]:
    """Robot, gait and environment of every point; equal ones are one object, made once.

    Args:
        setup: What all trials share.
        names: Of the parameters, a column of the table each.
        table: The points, a row each.
    """
    environment_word = place(setup.where)
    columns = {root: [i for i, name in enumerate(names) if name.split(".")[0] == root] for root in _roots(setup)}
    made: dict[str, dict[tuple[float, ...], Any]] = {root: {} for root in columns}
    lists: dict[str, list[Any]] = {root: [] for root in columns}
    order = {"robot": 0, "gait": 1, environment_word: 2}
    for root, own in columns.items():
        own_names = [names[i] for i in own]
        for row in map(tuple, table[:, own].tolist()):
            thing = made[root].get(row)
            if thing is None:
                values = dict(zip(own_names, row, strict=True))
                thing = changed(setup.robot, setup.gait, setup.where, values)[order[root]]
                made[root][row] = thing
            lists[root].append(thing)
    return lists["robot"], lists["gait"], lists[environment_word]


def _roots(setup: Setup) -> tuple[str, str, str]:
    return "robot", "gait", place(setup.where)
