"""Runs of missions, alone or many side by side, and what came of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int

from laticauda.missions.checking import check_mission, doubts_about
from laticauda.missions.inspection import (
    find_dock,
    find_net,
    measure_clearance,
    measure_share_seen,
)
from laticauda.missions.mission import Mission
from laticauda.models.simulate import swim_side_by_side
from laticauda.scenarios import (
    Observation,
    Observations,
    Scenario,
    Start,
    check_many,
    warn_of_doubt,
)
from laticauda.sensing import Dock, Sonar
from laticauda.trials import Trial
from laticauda.values import BadArgument, Unknown, name_of, show_value

LATCH_OPEN = 20.0
"""Time after the start during which the latch of a dock stays open [s]."""


class PhaseChange(NamedTuple):
    """When a mission went from one phase to another, and why."""

    time: float
    """When [s]."""
    before: str
    """The phase that ended."""
    after: str
    """The phase that began."""
    reason: str
    """Why."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MissionResult:
    """What came of one run of a mission, by what is true, not by what the robot believed."""

    trial: Trial
    """The run, with what the robot believed among its signals."""
    changes: tuple[PhaseChange, ...]
    """All changes of the phase."""
    is_docked: bool
    """Whether a dock has caught the robot; False without a dock."""
    clearance: float
    """How near the surface of the body came to anything but docks [m]."""
    share_seen: float | None
    """Share of the net's circumference seen within sonar range and 60 deg of incidence; None without net or sonar."""
    largest_error: float
    """Largest distance between where the robot was and where it believed to be, of the times at which it was
    sure to 1 m; nan if it never was [m]."""

    @property
    def last_phase(self) -> str:
        """The phase in which it ended."""
        if self.changes:
            return self.changes[-1].after
        return mission_of(self.trial.scenario).phase_names[0]

    @property
    def duration(self) -> float:
        """How long it took [s]."""
        return float(self.trial.time[-1])


def mission_of(scenario: object) -> Mission:
    """Return the mission of a scenario.

    Args:
        scenario: The scenario.

    Raises:
        ValueError: If something else steers.
    """
    rule = "must be a scenario whose controller is a `mission`"
    if not isinstance(scenario, Scenario):
        raise BadArgument("scenario", f"{rule}, got {show_value(scenario)}")
    motion = scenario.motion
    if isinstance(motion, Mission):
        return motion
    if isinstance(motion, Unknown):
        raise BadArgument(
            "scenario", f"{rule}, got one of the kind `{motion.kind}`, which is not known"
        )
    raise BadArgument("scenario", f"{rule}, got `{name_of(type(motion))}`")


def start_of(scenario: Scenario) -> Start:
    """Return where the robot of a mission starts.

    Args:
        scenario: The scenario.

    Raises:
        ValueError: If it goes on from where another run ended.
    """
    if not isinstance(scenario.start, Start):
        raise BadArgument("mission", "must be one that starts anew, got one that continues a run")
    return scenario.start


def run_mission(scenario: Scenario) -> MissionResult:
    """Run a mission until a dock has caught the robot, or to the end.

    Args:
        scenario: The scenario, whose controller is a mission.
    """
    (result,) = run_missions([scenario])
    return result


def run_missions(scenarios: Sequence[Scenario]) -> list[MissionResult]:
    """Run missions, those in the plane side by side; see `run_mission`.

    Args:
        scenarios: The scenarios, all with the same duration and sample interval.
    """
    for scenario in scenarios:
        mission_of(scenario)
        check_mission(scenario)
    check_many(scenarios)
    doubts: dict[str, None] = {}
    for scenario in scenarios:
        doubts.update(dict.fromkeys(doubts_about(scenario)))
    for doubt in doubts:
        warn_of_doubt(doubt)
    return [
        judge_mission(trial, scenario.duration)
        for trial, scenario in zip(swim_to_dock(scenarios), scenarios, strict=True)
    ]


def swim_to_dock(scenarios: Sequence[Scenario]) -> list[Trial]:
    """Return the trials of scenarios that each end when a dock catches the robot, whatever steers it.

    Args:
        scenarios: The scenarios, all with the same duration and sample interval.
    """
    docks = [find_dock(scenario.model.places) for scenario in scenarios]

    def has_arrived(
        observations: Observations, indices: Int[np.ndarray, " n"]
    ) -> Bool[np.ndarray, " n"]:
        arrives = np.zeros(len(indices), dtype=bool)
        for number, index in enumerate(map(int, indices)):
            dock = docks[index]
            if dock is not None and observations.is_well[number]:
                arrives[number] = _catches(dock, observations.of_robot(number))
        return arrives

    return swim_side_by_side(scenarios, has_arrived)


def _catches(dock: Dock, observation: Observation) -> bool:
    """Return whether a dock catches a robot now, on its way in."""
    speed = float(np.linalg.norm(observation.center_of_mass_velocity))
    # It starts in the dock, whose latch is open until it has left.
    has_left = float(observation.time) > LATCH_OPEN
    return has_left and dock.catches(observation.head.position, observation.heading, speed)


def read_changes(trial: Trial) -> tuple[PhaseChange, ...]:
    """Return the changes of the phase in the log of a mission's trial.

    Args:
        trial: The trial.
    """
    mission = mission_of(trial.scenario)
    n_changes = trial.signals["mission_changes"]
    way_taken = trial.signals["mission_way"]
    changes: list[PhaseChange] = []
    for sample in np.flatnonzero(np.diff(n_changes)).tolist():
        way = mission.ways[int(way_taken[sample + 1])]
        time = float(trial.time[sample + 1])
        before, after = mission.phase_names[way.before], mission.phase_names[way.after]
        changes.append(PhaseChange(time, before, after, way.reason))
    return tuple(changes)


def judge_mission(trial: Trial, planned_duration: float) -> MissionResult:
    """Return what came of a run.

    Args:
        trial: The run.
        planned_duration: How long it would have taken if no dock had caught the robot [s].
    """
    scenario = trial.scenario
    mission_of(scenario)
    assert isinstance(scenario, Scenario)
    model = scenario.model
    net = find_net(model.places)
    sonars = [sensor for sensor in model.sensors if isinstance(sensor, Sonar)]
    share_seen = None
    if net is not None and sonars:
        share_seen = measure_share_seen(trial, net, sonars[0])
    has_dock = find_dock(model.places) is not None
    error_x = trial.signals["believed_x"] - trial.center_of_mass[:, 0]
    error_y = trial.signals["believed_y"] - trial.center_of_mass[:, 1]
    is_known = trial.signals["believed_std"] < 1.0
    errors = np.hypot(error_x, error_y)[is_known]
    largest_error = math.nan
    if errors.size:
        largest_error = float(np.max(errors))
    return MissionResult(
        trial=trial,
        changes=read_changes(trial),
        is_docked=has_dock and float(trial.time[-1]) < planned_duration - 1e-9,
        clearance=measure_clearance(trial),
        share_seen=share_seen,
        largest_error=largest_error,
    )
