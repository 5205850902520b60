"""A mission: a table of phases, which steers a robot by what its sensors tell. It is a controller."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

from laticauda.missions.avoidance import Avoidance
from laticauda.missions.depth import DepthKeeping, DepthState
from laticauda.missions.estimate import Estimate
from laticauda.missions.navigation import Navigation, NavigationState
from laticauda.missions.phases import Phase, Transition
from laticauda.missions.steering import Helm, Steering
from laticauda.motion.gaits import Gait
from laticauda.robot import Robot
from laticauda.scenarios import SHORTEST_INTERVAL, Command, Controller, Observation
from laticauda.values import BadArgument, check_positive, option, quantity, value_class


class Way(NamedTuple):
    """A way from one phase to another."""

    before: int
    """Index of the phase that ends."""
    after: int
    """Index of the phase that begins."""
    reason: str
    """Why, in words."""


@dataclass(frozen=True, kw_only=True)
class MissionState:
    """Where a mission is."""

    navigation: NavigationState
    """What navigation keeps."""
    phase: int = 0
    """Index of the phase."""
    began_at: float | None = None
    """When it began; None: nothing has begun [s]."""
    behaviour: Any = None
    """State of its behaviour."""
    n_changes: int = 0
    """How often the phase has changed."""
    way: int = -1
    """Index of the last way taken, see `Mission.ways`."""
    depth_keeping: DepthState | None = None
    """What depth keeping remembers; None: it has not begun."""
    signals: Mapping[str, float] = field(default_factory=dict[str, float])
    """What the log holds."""


@value_class
class Mission(Controller[MissionState]):
    """A table of phases. The robot is steered by estimates from sensors; the scene is not known to it.

    The first phase begins at once. In each phase a behaviour steers; the phase ends when that is
    done or has failed, after a time limit, or under a condition, and the table says which comes
    next. Which way was taken, and when, is in the signals of the trial (`read_changes`).
    """

    gait: Gait = option("Gait that swims; steering adds to its offset")
    phases: tuple[Phase, ...] = option("The phases; it begins with the first")
    always: tuple[Transition, ...] = option("Transitions out of any phase", default=())
    navigation: Navigation = option("Where it believes to be", default=Navigation())
    helm: Helm = option("How it steers", default=Helm())
    avoidance: Avoidance = option("How it keeps clear of what it saw", default=Avoidance())
    depth_keeping: DepthKeeping = option(
        "How it holds the depth of a phase", default=DepthKeeping()
    )
    interval: float = quantity(
        "s", "Time between two control instants", ge=SHORTEST_INTERVAL, default=0.2
    )

    def __post_init__(self) -> None:
        """Reject tables with phases that are missing or named twice."""
        check_positive("gait.frequency", self.gait.frequency, "rad/s, whose cycle is averaged over")
        if not self.phases:
            raise BadArgument("phases", "must hold at least one phase, got none")
        names = self.phase_names
        for name in names:
            if names.count(name) > 1:
                raise BadArgument("phases", f"must have different names, got `{name}` twice")
        _ = self.ways

    @property
    def phase_names(self) -> tuple[str, ...]:
        """Names of the phases."""
        return tuple(phase.name for phase in self.phases)

    @cached_property
    def ways(self) -> tuple[Way, ...]:
        """All ways from one phase to another, in the order of the table."""
        return tuple(entry.way for entry in self._entries)

    @cached_property
    def _entries(self) -> tuple["_Entry", ...]:
        """All ways with what they depend on."""
        entries: list[_Entry] = []
        for index, phase in enumerate(self.phases):
            entries += self._entries_of(index, phase)
        return tuple(entries)

    def _entries_of(self, index: int, phase: Phase) -> list["_Entry"]:
        """Return the ways out of one phase; those of the whole mission come first."""
        entries: list[_Entry] = []
        for transition in self.always:
            if phase.name != transition.to and phase.name not in transition.except_in:
                way = self._way(index, transition.to, transition.when.words)
                entries.append(_Entry(way, transition, None))
        for transition in phase.transitions:
            way = self._way(index, transition.to, transition.when.words)
            entries.append(_Entry(way, transition, None))
        for outcome in ("done", "failed"):
            target = getattr(phase, outcome)
            if target is not None:
                entries.append(_Entry(self._way(index, target, outcome), None, outcome))
        if phase.late is not None:
            reason = f"longer than {phase.time_limit:g} s"
            entries.append(_Entry(self._way(index, phase.late, reason), None, "late"))
        return entries

    def _way(self, before: int, name: str, reason: str) -> Way:
        """Return a way to a phase by its name."""
        if name not in self.phase_names:
            listed = ", ".join(f"`{known}`" for known in self.phase_names)
            leaving = self.phases[before].name
            raise BadArgument(
                "phases", f"must lead to one of {listed}, got {name!r} after `{leaving}`"
            )
        return Way(before, self.phase_names.index(name), reason)

    @cached_property
    def _entries_by_phase(self) -> dict[int, list[tuple[int, "_Entry"]]]:
        """The ways out of every phase, with their indices."""
        by_phase: dict[int, list[tuple[int, _Entry]]] = {}
        for number, entry in enumerate(self._entries):
            by_phase.setdefault(entry.way.before, []).append((number, entry))
        return by_phase

    @cached_property
    def _resting_gait(self) -> Gait:
        """The gait without its wave."""
        return replace(self.gait, amplitude=0.0)

    @cached_property
    def _steers_depth(self) -> bool:
        """Whether any phase holds a depth."""
        return any(phase.depth is not None for phase in self.phases)

    @cached_property
    def cycle(self) -> float:
        """Period of the gait [s]."""
        return 2.0 * math.pi / abs(self.gait.frequency)

    def init(self) -> MissionState:
        """Return the state before the first control instant."""
        return MissionState(navigation=self.navigation.init())

    def step(self, state: MissionState, observation: Observation) -> tuple[MissionState, Command]:
        """Return the state after an observation, of which only readings and joints are used, and the command.

        Args:
            state: The state before.
            observation: The observation.
        """
        navigation = self.navigation.step(state.navigation, observation, self.cycle)
        estimate = navigation.estimate
        assert estimate is not None
        state = replace(state, navigation=navigation)
        if state.began_at is None:
            state = self._begin(state, 0, estimate)
        state, steering = self._steer(state, estimate)
        numbered_way = self._way_taken(state, estimate)
        if numbered_way is not None:
            number, entry = numbered_way
            state = self._begin(state, entry.way.after, estimate)
            state = replace(state, way=number, n_changes=state.n_changes + 1)
            state, steering = self._steer(state, estimate)
        phase = self.phases[state.phase]
        if phase.avoids:
            steering = self.avoidance.correct(steering, estimate)
        if phase.depth is not None:
            depth_state = self.depth_keeping.step(state.depth_keeping, phase.depth, estimate)
            state = replace(state, depth_keeping=depth_state)
            if depth_state is not None:
                steering = replace(steering, pitch_offset=depth_state.offset)
        offset = self.helm.offset_of(steering, estimate)
        signals = _signals(state, estimate, offset)
        if self._steers_depth:
            signals["pitch_offset"] = steering.pitch_offset
        state = replace(state, signals=signals)
        return state, self._command(steering, offset)

    def _begin(self, state: MissionState, phase: int, estimate: Estimate) -> MissionState:
        """Return the state at the beginning of a phase."""
        behaviour = self.phases[phase].behaviour.begin(estimate)
        return replace(state, phase=phase, began_at=estimate.time, behaviour=behaviour)

    def _steer(self, state: MissionState, estimate: Estimate) -> tuple[MissionState, Steering]:
        """Return the state after the behaviour of the phase, and what that wants."""
        phase = self.phases[state.phase]
        behaviour, steering = phase.behaviour.steer(state.behaviour, estimate)
        return replace(state, behaviour=behaviour), steering

    def _way_taken(self, state: MissionState, estimate: Estimate) -> "tuple[int, _Entry] | None":
        """Return the first way out of the phase that is open; None if it goes on."""
        entries = self._entries_by_phase.get(state.phase, [])
        if not entries or state.began_at is None:
            return None
        phase = self.phases[state.phase]
        outcome = phase.behaviour.outcome(state.behaviour, estimate)
        is_late = estimate.time - state.began_at > phase.time_limit
        for number, entry in entries:
            if entry.transition is not None and entry.transition.when.is_met(estimate):
                return number, entry
            if entry.ends_by is not None and entry.ends_by == outcome:
                return number, entry
            if entry.ends_by == "late" and is_late:
                return number, entry
        return None

    def _command(self, steering: Steering, offset: float) -> Command:
        """Return the command of a steering."""
        if steering.effort == 0.0:
            return Command(gait=self._resting_gait, thrusts=steering.thrusts)
        gait = self.gait
        if steering.effort != 1.0:
            gait = replace(gait, amplitude=steering.effort * gait.amplitude)
        if steering.pace != 1.0:
            gait = replace(gait, frequency=steering.pace * gait.frequency)
        return Command(
            gait=gait,
            offset=offset,
            pitch_offset=steering.pitch_offset,
            thrusts=steering.thrusts,
        )

    def check(self, robot: Robot) -> None:
        """Reject a robot whose joints cannot bend as far as gait and steering together may require.

        Args:
            robot: The robot.
        """
        envelope = self.gait.joint_envelope(robot.planar().n_links)
        for number, (joint, share) in enumerate(zip(robot.planar().joints, envelope, strict=True)):
            room = joint.limit - self.gait.amplitude * abs(share) - abs(self.gait.offset)
            if self.helm.max_offset > room:
                rule = f"must be <= {room:.4g} rad, or joint {number} goes beyond its limit"
                raise BadArgument("helm.max_offset", f"{rule}, got {self.helm.max_offset:.4g} rad")
        for phase in self.phases:
            if phase.depth is not None:
                self._check_pitch_joints(robot, phase)

    def _check_pitch_joints(self, robot: Robot, phase: Phase) -> None:
        """Reject a robot that cannot hold the depth of a phase."""
        limits = [joint.limit for joint in robot.joints if joint.axis == "pitch"]
        if not limits:
            rule = f"must have pitch joints to hold the depth of the phase `{phase.name}`"
            raise BadArgument("robot", f"{rule}, got `{robot.name}`, which has none")
        if self.depth_keeping.max_offset > min(limits):
            rule = f"must be <= {min(limits):.4g} rad, or a pitch joint goes beyond its limit"
            raise BadArgument(
                "depth_keeping.max_offset",
                f"{rule}, got {self.depth_keeping.max_offset:.4g} rad",
            )


class _Entry(NamedTuple):
    """A way, and what opens it: a transition, or how the phase ends by itself."""

    way: Way
    transition: Transition | None
    ends_by: str | None


def _signals(state: MissionState, estimate: Estimate, offset: float) -> dict[str, float]:
    """Return what the log holds of a control instant."""
    return {
        "mission_phase": float(state.phase),
        "mission_changes": float(state.n_changes),
        "mission_way": float(state.way),
        "believed_x": estimate.position[0],
        "believed_y": estimate.position[1],
        "believed_std": estimate.position_std,
        "believed_heading": estimate.heading,
        "believed_current_x": estimate.current[0],
        "believed_current_y": estimate.current[1],
        "offset": offset,
    }
