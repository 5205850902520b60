"""Assembly of an animat from its bodies and its YAML file."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from laticauda.connect.farms.animat import FarmsAnimat
from laticauda.connect.farms.bodies import Morphology, is_parallel
from laticauda.connect.farms.drag import FARMS_WATER, add_drag
from laticauda.connect.farms.entries import Entry
from laticauda.connect.farms.motors import Drivetrain, build_drivetrain
from laticauda.connect.farms.network_file import Drives, OscillatorPair
from laticauda.connect.farms.oscillators import MovedJoint, build_network
from laticauda.connect.farms.remarks import Remarks
from laticauda.connect.farms.robots import build_robot
from laticauda.connect.farms.spine import Spine, find_spine
from laticauda.control import PhaseOscillators
from laticauda.robot import Robot
from laticauda.values import RobotFileError

MOST_LISTED = 6
"""Names that a remark lists at most."""


class Assembly:
    """An animat that is being built.

    Args:
        morphology: Its bodies.
        bodies_file: File that they come from.
        entry: All of its YAML file; an empty entry if there is none.
        head: Name of the head's link; None: the root.

    Raises:
        RobotFileError: If the bodies have no spine.
    """

    def __init__(
        self,
        morphology: Morphology,
        bodies_file: Path,
        entry: Entry,
        head: str | None,
    ) -> None:
        self.morphology = morphology
        self.bodies_file = bodies_file
        self.control = entry.inner("control")
        self.parts = entry.inner("morphology")
        self.remarks = Remarks(morphology.remarks)
        self.spine = self._find_spine(head)
        self.joint_names = [hinge.name for hinge in reversed(self.spine.hinges)]
        self.motors = self._find_entries("motors")
        self.muscles = self._find_entries("muscles")

    def build(self, drives: Drives | None) -> FarmsAnimat:
        """Return the animat.

        Args:
            drives: Drives in place of those of the file; None: those.

        Raises:
            RobotFileError: If a file is not understood.
        """
        network = self._build_network(drives)
        drivetrain = self._build_drivetrain(network)
        robot = self._build_robot(drivetrain)
        links = {link.text("name"): link for link in self.parts.items("links")}
        robot_with_drag = add_drag(
            robot=robot,
            spine=self.spine,
            links=links,
            remarks=self.remarks,
        )
        water = None
        if robot_with_drag is not None:
            water = FARMS_WATER
        self._list_what_is_left()
        heads_of_segments = [segment[0].name for segment in reversed(self.spine.segments)]
        return FarmsAnimat(
            robot=robot,
            links=tuple(heads_of_segments),
            joint_names=tuple(self.joint_names),
            network=network,
            joints=drivetrain.law,
            robot_with_drag=robot_with_drag,
            water=water,
            left_out=tuple(self.remarks),
        )

    # ---- bodies ----------------------------------------------------------------------------------

    def _find_spine(self, head: str | None) -> Spine:
        """Return the spine among the bodies."""
        try:
            return find_spine(self.morphology, self._list_driven_joints(), head)
        except ValueError as refusal:
            raise RobotFileError(f"{self.bodies_file}: {refusal}") from None

    def _list_driven_joints(self) -> list[str] | None:
        """Return the joints of the spine, the first ones of the list; None if the file does not say."""
        if not self.parts.has("n_joints_body"):
            return None
        count = int(self.parts.number("n_joints_body"))
        names = [joint.text("name") for joint in self.parts.items("joints")]
        if not 0 < count <= len(names):
            raise self.parts.error("n_joints_body", f"must be 1 to {len(names)}, got {count}")
        return names[:count]

    def _build_robot(self, drivetrain: Drivetrain) -> Robot:
        """Return the robot of the spine."""
        try:
            return build_robot(
                name=self.morphology.name,
                description=f"spine of an animat of FARMS, from {self.bodies_file.name}",
                spine=self.spine,
                actuators=drivetrain.actuators,
                remarks=self.remarks,
            )
        except ValueError as refusal:
            raise RobotFileError(f"{self.bodies_file}: {refusal}") from None

    # ---- joints ----------------------------------------------------------------------------------

    def _find_entries(self, key: str) -> dict[str, Entry]:
        """Return the entries of the joints of the spine in a list, by the joints' names."""
        entries: dict[str, Entry] = {}
        for entry in self.control.items(key):
            name = entry.text("joint_name")
            if name in self.joint_names:
                entries[name] = entry
        return entries

    def _build_drivetrain(self, network: PhaseOscillators | None) -> Drivetrain:
        """Return what moves the joints."""
        amplitude = 0.0
        if network is not None:
            shares = network.gait.envelope.joints(len(self.joint_names) + 1)
            amplitude = network.gait.amplitude * float(np.mean(np.abs(shares)))
        return build_drivetrain(
            motors=list(self.motors.values()),
            muscles=list(self.muscles.values()),
            amplitude=amplitude,
            remarks=self.remarks,
        )

    def _build_network(self, drives: Drives | None) -> PhaseOscillators | None:
        """Return the network; None if there is none with numbers."""
        network = self.control.inner("network")
        oscillators = list(network.items("oscillators"))
        if not oscillators:
            return None
        if not oscillators[0].has("frequency_gain"):
            self.remarks.append("oscillators without numbers: another program is the network")
            return None
        return build_network(
            entry=network,
            joints=self._list_moved_joints(),
            drives=drives,
            remarks=self.remarks,
        )

    def _list_moved_joints(self) -> list[MovedJoint]:
        """Return the joints with their oscillators, tail first."""
        no_motor = Entry(self.control.path, self.control.place, {})
        joints: list[MovedJoint] = []
        for name, sense in zip(self.joint_names, _list_senses(self.spine), strict=True):
            muscle = self.muscles.get(name)
            if muscle is None:
                rule = f"must say which oscillators move joint `{name}`"
                raise self.control.error("muscles", rule)
            pair = OscillatorPair(left=muscle.text("osc1"), right=muscle.text("osc2"))
            motor = self.motors.get(name, no_motor)
            joints.append(
                MovedJoint(
                    name=name,
                    sense=sense,
                    pair=pair,
                    motor=motor,
                )
            )
        return joints

    # ---- what is left ----------------------------------------------------------------------------

    def _list_what_is_left(self) -> None:
        """Add what no reader takes."""
        limbs = self.spine.limbs
        if limbs:
            mass = sum(limb.mass for limb in limbs)
            listed = _list_names([limb.name for limb in limbs])
            self.remarks.append(f"limbs of {mass:.4g} kg: {listed}")
        if self.spine.locked:
            listed = _list_names(self.spine.locked)
            self.remarks.append(f"joints of the spine that are held: {listed}")
        if self.control.text("kinematics_file", ""):
            reader = "`laticauda.recorded_gait` swims a table"
            self.remarks.append(f"angles in its `kinematics_file`; {reader}")
        sensors = self.control.inner("sensors")
        n_sensors = sum(sensors.count(kind) for kind in sensors.table)
        self.remarks.add_count(n_sensors, "sensors")
        self.remarks.add_count(self.control.count("hill_muscles"), "Hill-type muscles")
        if any(joint.number("stiffness", 0.0) for joint in self.parts.items("joints")):
            self.remarks.append("stiffness of joints in the YAML file")
        if self.parts.count("links"):
            self.remarks.append("friction, contacts and buoyancy of links")


def _list_senses(spine: Spine) -> list[float]:
    """Return for each joint, tail first, whether FARMS's angles are ours (1) or their negatives (-1)."""
    senses: list[float] = []
    for hinge, is_tailward in zip(spine.hinges, spine.tailward, strict=True):
        axis_of_ours = spine.left
        if is_parallel(hinge.axis, spine.up):
            axis_of_ours = spine.up
        sense = float(np.sign(hinge.axis @ axis_of_ours))
        if is_tailward:
            sense = -sense
        senses.append(sense)
    return senses[::-1]


def _list_names(names: Sequence[str]) -> str:
    """Return names in a list that is not too long."""
    listed = ", ".join(names[:MOST_LISTED])
    if len(names) <= MOST_LISTED:
        return listed
    return f"{listed} and {len(names) - MOST_LISTED} more"
