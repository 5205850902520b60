"""The settings of the paper's path-following trials, from `paper.toml`: what is run, and what is printed beside it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from laticauda.errors import BadArgument
from laticauda.gaits import Gait, envelope_of
from laticauda.paper.measured import MeasuredPathFollowing, path_following_trials
from laticauda.paper.settings import (
    PARAMETERS,
    Coefficients,
    efficiency_settings,
    paper_table,
    printed_changes,
)
from laticauda.quantities import option, quantity, value
from laticauda.trial.null_models import group_name

LEAST_DURATION = 15.0  # a steady part takes 10 s and a gait cycle, 4 s in Table 2 [s]


@dataclass(frozen=True, kw_only=True)
class FollowingGroup:
    """One gait with one configuration of the robot: a part of Table 2."""

    gait: str
    """The gait's kind."""
    robot: str
    """The robot's name (`load_robot`)."""
    has_fin: bool
    """Whether it wears the caudal fin."""
    figures: tuple[int, ...]
    """Numbers of the paper's figures, by case."""
    printed_velocity_change: tuple[float | None, ...]
    """By case, the printed change of forward velocity by the fin; None where there is none [%]."""
    printed_power_change: tuple[float | None, ...]
    """The same for the power [%]."""

    @property
    def name(self) -> str:
        """What tables and files call it."""
        return group_name(self.gait, self.has_fin)

    @property
    def measured(self) -> tuple[MeasuredPathFollowing, ...]:
        """Its cases, as the paper measured them, one per figure."""
        own = [row for row in path_following_trials() if row.gait.kind == self.gait and row.has_fin == self.has_fin]
        return tuple(own[: len(self.figures)])


@dataclass(frozen=True, kw_only=True)
class HeldOut:
    """A published trial of the same robot that no choice here rests on."""

    gait: Gait
    """What the joints are asked for, apart from the steering."""
    robot: str
    """The robot's name (`load_robot`)."""
    initial_cross_track_error: float
    """Initial distance of the center of mass from the path, positive to its left [m]."""
    initial_heading: float
    """Initial heading [rad]."""
    velocity: tuple[float, float]
    """Smallest and largest forward velocity that was published [m/s]."""
    offset: tuple[float, float]
    """Smallest and largest offset that was published [rad]."""


@value
class PathFollowingSettings:
    """What the path-following study runs: every case of Table 2 along the x axis, in every way of the band."""

    duration: float = quantity("s", "After which a run ends", ge=LEAST_DURATION, le=1e5)
    distance: float = quantity("m", "Progress along the path after which it ends earlier", gt=0.0)
    look_ahead_distance: float = quantity("m", "Delta", gt=0.0)
    gain: float = quantity("", "k", gt=0.0)
    max_offset: float = quantity("rad", "Of the joints to either side", gt=0.0)
    control_interval: float = quantity("s", "Between two control instants", gt=0.0)
    coefficients: Coefficients = option("The water of every gait")
    accepted_error: float = quantity("m", "What the mean over the gait cycle shall stay within at the end", gt=0.0)
    joint_laws: tuple[str, ...] = option("Of the band: how the joints follow the gait")
    offset_bandwidths: tuple[float, ...] = quantity("rad/s", "Of the band: bandwidths of the reference generator")
    groups: tuple[FollowingGroup, ...] = option("The parts of Table 2")
    held_out: HeldOut = option("The trial of another publication")

    def __post_init__(self) -> None:
        """Check what has a range."""
        for name in ("joint_laws", "offset_bandwidths", "groups"):
            if not getattr(self, name):
                raise BadArgument(name, "must hold at least one entry, got none")
        for group in self.groups:
            if len(group.measured) != len(group.figures):
                raise BadArgument(
                    "figures",
                    f"must be at most as many as Table 2 has cases of {group.name}, {len(group.measured)}, "
                    f"got {len(group.figures)}",
                )

    @property
    def n_cases(self) -> int:
        """How many cases there are [-]."""
        return sum(len(group.figures) for group in self.groups)

    def band(self, joints: str, offset_bandwidth: float) -> tuple[tuple[str, float], ...]:
        """Every way to run a case, joint law and bandwidth [rad/s], with the chosen one among them.

        Args:
            joints: The chosen joint law.
            offset_bandwidth: The chosen bandwidth [rad/s].
        """
        ways = [(law, bandwidth) for law in self.joint_laws for bandwidth in self.offset_bandwidths]
        chosen = (joints, float(offset_bandwidth))
        return tuple(ways if chosen in ways else [chosen, *ways])

    def n_runs(self, joints: str, offset_bandwidth: float) -> int:
        """How many runs the study takes: bands, cycle means, unsteered ones and the held-out one.

        Args:
            joints: The chosen joint law.
            offset_bandwidth: The chosen bandwidth [rad/s].
        """
        return self.n_cases * (len(self.band(joints, offset_bandwidth)) + 1) + len(self.groups) + 1


@cache
def path_following_settings() -> PathFollowingSettings:
    """The settings that come with laticauda; `dataclasses.replace` makes others."""
    table = paper_table()["path_following"]
    models = {model.name: model for model in efficiency_settings().models}
    same = ("duration", "distance", "look_ahead_distance", "gain", "control_interval", "accepted_error")
    return PathFollowingSettings(
        **{name: table[name] for name in same},
        max_offset=math.radians(table["max_offset_deg"]),
        coefficients=models[table["coefficients"]],
        joint_laws=tuple(table["joint_laws"]),
        offset_bandwidths=tuple(map(float, table["offset_bandwidths"])),
        groups=tuple(_group(group) for group in table["groups"]),
        held_out=_held_out(table["held_out"]),
    )


def _group(table: Mapping[str, Any]) -> FollowingGroup:
    velocity, power = printed_changes(table, len(table["figures"]))
    return FollowingGroup(
        gait=table["gait"],
        robot=table["robot"],
        has_fin=table["robot"].endswith("-fin"),
        figures=tuple(table["figures"]),
        printed_velocity_change=velocity,
        printed_power_change=power,
    )


def _held_out(table: Mapping[str, Any]) -> HeldOut:
    amplitude, frequency, phase_shift = (math.radians(table[f"{name}_deg"]) for name in PARAMETERS)
    return HeldOut(
        gait=Gait(
            envelope=envelope_of(table["gait"]), amplitude=amplitude, frequency=frequency, phase_shift=phase_shift
        ),
        robot=table["robot"],
        initial_cross_track_error=table["cross_track_error"],
        initial_heading=math.radians(table["heading_deg"]),
        velocity=_pair(table["velocity"]),
        offset=_pair([math.radians(value) for value in table["offset_deg"]]),
    )


def _pair(values: Sequence[float]) -> tuple[float, float]:
    low, high = values
    return low, high
