"""The robot in the water: one `Plant`, whose joints get their references from outside."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from laticauda.models.dynamics import Plant, PlantState
from laticauda.motion import gaits
from laticauda.motion.joints import Servo
from laticauda.robot import ModulePoses, Robot, from_quaternion, module_poses, turn
from laticauda.scenarios import ORIENTATION, Command, Experiment, Start
from laticauda.sensing import Reading, senses_of
from laticauda.trials import Trial
from laticauda.values import BadArgument, SimulationFailed, name_of, series

SAMPLE_INTERVAL = 0.05  # s
MOST_SAMPLES = 72_000
STILL = gaits.Gait(amplitude=0.0, frequency=0.0, phase_shift=0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Truth:
    """True state at one moment, regardless of any measurement."""

    time: float
    """Time [s]."""
    center_of_mass: Float[np.ndarray, " 3"]
    """Center of mass [m]."""
    heading: float
    """Mean link angle (6) [rad]."""
    joint_angle: Float[np.ndarray, " n_joints"]
    """Angles of all joints of the robot, then of a driven fin; a planar world holds the pitch joints at 0 [rad]."""
    joint_rate: Float[np.ndarray, " n_joints"]
    """Rates of the same joints [rad/s]."""
    joint_torque: Float[np.ndarray, " n_joints"]
    """Torques of the motors [N m]."""
    electrical_work: float
    """Energy above idle that the robot has taken from the supply since the beginning [J]."""
    modules: ModulePoses
    """Poses of the modules."""


class VirtualRobot:
    """One robot in its water, with its state.

    Args:
        robot: Robot as it is built, with all its joints.
        plant: The same robot as a plant that can be stepped, with servo joints; a planar one drives
            its yaw joints.
        start: Where the robot starts.
        depth: Depth below the surface at which the robot of a planar world swims [m].

    Raises:
        ValueError: If the plant is of another robot, or its joints are not servos of either kind.
    """

    def __init__(
        self, robot: Robot, plant: Plant[Any], start: Start | None = None, *, depth: float = 0.15
    ) -> None:
        joints: object = plant.settings.joints
        if not isinstance(joints, Servo):
            raise BadArgument(
                "plant", f"must have `servo` or `speed-servo` joints, got {name_of(type(joints))!r}"
            )
        driven = list(range(robot.n_joints))
        if plant.robot.n_joints != robot.n_joints:
            driven = [i for i, joint in enumerate(robot.joints) if joint.axis == "yaw"]
        if plant.robot.n_joints != len(driven):
            rule = f"must have the {robot.n_joints} joints of the robot, or its {len(driven)} yaw joints"
            raise BadArgument("plant", f"{rule}, got {plant.robot.n_joints}")
        driven += range(robot.n_joints, len(robot.driven_joints))  # the fin
        self.robot, self.plant, self.depth = robot, plant, depth
        self.driven = np.array(driven, dtype=int)
        self.start = start or Start()
        self._work = 0.0
        self._log: list[series.Log] = []
        self._joint_force: Float[np.ndarray, "n_joints 3"] | None = None
        self._senses = senses_of(plant.settings, plant.environment)
        self.sensor_columns: dict[str, tuple[str, ...]] = {
            sensor.name: sensor.columns for sensor in plant.settings.sensors
        }
        """Names of the values of each of its own sensors, by name."""
        self._put(self.start, 0.0)
        # What computes it is compiled before a world must keep up with a clock.
        _ = self.joint_force

    def carry(self, start: Start) -> None:
        """Take the robot out of the water, straighten it, and put it back at rest at `start`; time and water go on.

        Args:
            start: Place and heading at which it is put.
        """
        self._work = self.truth.electrical_work
        self._put(start, self.truth.time)

    @property
    def joint_force(self) -> Float[np.ndarray, "n_joints 3"]:
        """Force in every joint of the robot, and of a driven fin, now: along, left, up [N].

        nan in joints that the world does not know: those for pitch in a planar world.
        """
        if self._joint_force is None:
            loads = self.plant.evaluate_loads(self._state, self._command)
            force = np.full((len(self.robot.driven_joints), 3), np.nan)
            of_body = self.driven[: len(loads.joint_force)]
            force[of_body] = loads.joint_force
            force[self.robot.n_joints :] = loads.fin_force
            self._joint_force = force
        return self._joint_force

    def read_sensors(self) -> dict[str, Reading]:
        """Let the robot's own sensors measure if it is time to, and return their last readings by name."""
        if self._senses is None:
            return {}
        observation = self.plant.observe_under(self._state, self._command)
        return self._senses.read(observation)

    def _put(self, start: Start, time: float) -> None:
        values = self.plant.init(start, Command(gait=STILL)).values.copy()
        values[0] = time
        self._state = PlantState(values=values)
        self._work_of_limp_modules = 0.0
        n = len(self.driven)
        log = self._marched([0.0] * n, [False] * n, 1e-6)[1].at(slice(1))
        self._log = [log]
        self.truth = self._truth(log)

    def advance(
        self,
        references: Float[np.ndarray, " n_joints"],
        on: Bool[np.ndarray, " n_joints"],
        dt: float,
        *,
        jammed: Bool[np.ndarray, " n_joints"] | None = None,
    ) -> None:
        """Advance time by `dt` [s].

        Args:
            references: Where the servo of every joint, and of a driven fin, is to go [rad].
            on: Whether the motor of each is on.
            dt: Time step [s].
            jammed: Joints that are held at their references, with their motors on or off; None:
                none is.

        Raises:
            SimulationFailed: If the body's motion diverges.
        """
        is_held = on if jammed is None else on | jammed
        self._state, log = self._marched(
            references[self.driven].tolist(), is_held[self.driven].tolist(), dt
        )
        log = self._without_limp_modules(log, on[self.driven], dt)
        self.truth = self._truth(log)
        if float(log.time[-1] - self._log[-1].time[-1]) >= SAMPLE_INTERVAL - 1e-9:
            self._log.append(log.at(slice(-1, None)))
            del self._log[MOST_SAMPLES:]

    def _marched(
        self, references: Sequence[float], on: Sequence[bool], dt: float
    ) -> tuple[PlantState, series.Log]:
        """Return the state after `dt` [s], and the log."""
        command = Command(gait=STILL, references=tuple(references), enabled=tuple(on))
        state, log, failure = self.plant.march(self._state, command, dt, dt)
        if failure is not None:
            raise SimulationFailed(failure)
        self._command = command
        self._joint_force = None
        return state, log

    def _without_limp_modules(
        self, log: series.Log, on: Bool[np.ndarray, " n_driven"], dt: float
    ) -> series.Log:
        """Return a log without what the plant counts for the electronics of modules whose motors are off.

        A plant swims from its beginning, and counts the robot's `active_power` all the time. A robot
        in a tank lies limp as well, for instance while its power at rest is measured.
        """
        active_power = self.plant.robot.active_power
        if active_power is None or log.electrical_work is None:
            return log
        limp_share = 1.0 - float(np.mean(on))
        self._work_of_limp_modules += limp_share * active_power * dt
        # The end of this stretch alone is read: its first sample is the end of the one before.
        return replace(log, electrical_work=log.electrical_work - self._work_of_limp_modules)

    def trial(self, version: str) -> Trial:
        """Return the true motion since the robot was put into the water, regardless of measurements; at most an hour.

        Args:
            version: Version of laticauda.
        """
        return Trial(
            **vars(series.concatenated(self._log)),
            scenario=Experiment(
                robot=self.plant.robot,
                environment=self.plant.environment,
                model=self.plant.settings,
            ),
            version=version,
            status="Ground truth of the virtual tank.",
            succeeded=True,
        )

    def _truth(self, log: series.Log) -> Truth:
        angle = self._all_joints(log, log.joint_angle, "fin_angle_0")
        rate = self._all_joints(log, log.joint_rate, "fin_rate_0")
        torque = self._all_joints(log, log.joint_torque, "fin_torque")
        center = log.center_of_mass[-1]
        if center.size == 2:
            center = np.array([center[0], center[1], -self.depth])
        if ORIENTATION[0] in log.signals:
            rotation = from_quaternion(*(float(log.signals[name][-1]) for name in ORIENTATION))
        else:
            rotation = turn("yaw", float(log.link_angle[-1, 0]))
        ballast = float(getattr(self.plant.settings, "ballast_depth", 0.0))
        return Truth(
            time=float(log.time[-1]),
            center_of_mass=center,
            heading=float(log.heading[-1]),
            joint_angle=angle,
            joint_rate=rate,
            joint_torque=torque,
            electrical_work=self._work
            + (0.0 if log.electrical_work is None else float(log.electrical_work[-1])),
            modules=module_poses(
                self.robot, center, rotation, angle[: self.robot.n_joints], ballast_depth=ballast
            ),
        )

    def _all_joints(self, log: series.Log, values: np.ndarray, of_fin: str) -> np.ndarray:
        """Return the last values of all joints, from those of the plant, and of a driven fin; the others are held."""
        full = np.zeros(len(self.robot.driven_joints))
        full[self.driven] = (
            np.append(values[-1], log.signals[of_fin][-1]) if of_fin in log.signals else values[-1]
        )
        return full
