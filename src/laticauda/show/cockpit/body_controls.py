"""Controls of the robot and its model: robot, fin, rigidity of the fin, model and joints."""

from importlib.util import find_spec
from typing import Any

from laticauda.motion.joints import JointLaw
from laticauda.robot import CaudalFin, Robot, load_robot, robot_names
from laticauda.scenarios import MODELS, Scenario
from laticauda.show.cockpit.changes import Changes, change_fin
from laticauda.show.cockpit.control import Control, read_hint
from laticauda.show.cockpit.live import Live
from laticauda.values import check_positive, name_of

RIGIDITY = 0.2
"""Initial value of an elastic fin [N m^2]."""
NO_FIN = "none"
RIGID = "rigid"
ELASTIC = "elastic"


class BodyControls:
    """Controls of the robot, which remember its rigidity while it has no elastic fin.

    Args:
        gui: GUI of the page's server; the controls are added at its current position.
        live: The simulation that they control.
    """

    def __init__(self, gui: Any, live: Live) -> None:
        self._live = live
        self._first_robot = live.scenario.robot
        self._rigidity = RIGIDITY
        self.by_name: dict[str, Control] = {}
        """Controls by what they set."""
        robots = tuple(dict.fromkeys((*robot_names(), self._first_robot.name)))
        self.by_name["robot"] = Control(
            gui.add_dropdown("robot", robots), self._read_robot, self._change_robot
        )
        self.by_name["fin"] = Control(
            gui.add_dropdown("fin", (NO_FIN, RIGID, ELASTIC)), _read_fin, self._change_fin
        )
        hint = read_hint(CaudalFin, "flexural_rigidity", "N m^2")
        rigidity = gui.add_number("rigidity [N m²]", RIGIDITY, step=0.01, hint=hint)
        self.by_name["rigidity"] = Control(rigidity, self._read_rigidity, self._change_rigidity)
        self.by_name["model"] = Control(
            gui.add_dropdown("model", list_available_models()), _read_model, _change_model
        )
        self.by_name["joints"] = Control(
            gui.add_dropdown("joints", JointLaw.names()), _read_joints, _change_joints
        )

    def remember_rigidity(self, robot: Robot) -> None:
        """Remember the rigidity of a robot's fin, if it has an elastic one."""
        if robot.caudal_fin is not None and robot.caudal_fin.flexural_rigidity:
            self._rigidity = robot.caudal_fin.flexural_rigidity

    def _read_robot(self, scenario: Scenario) -> str:
        return self._load_robot(scenario.robot.name).name

    def _change_robot(self, name: str) -> Changes:
        return {"robot": self._load_robot(name)}

    def _load_robot(self, name: str) -> Robot:
        """Return a robot with its original fin; the page's own robot if the name is not a preset."""
        if name != self._first_robot.name and name in robot_names():
            return load_robot(name)
        return self._first_robot

    def _change_fin(self, fin: str) -> Changes:
        return {"robot": self._with_fin(fin, self._rigidity)}

    def _with_fin(self, fin: str, rigidity: float) -> Robot:
        """Return the present robot with a fin, whose rigidity [N m^2] matters if it is elastic."""
        robot = self._load_robot(self._live.scenario.robot.name)
        rigidity_of_elastic = rigidity if fin == ELASTIC else None
        return change_fin(robot, fin != NO_FIN, rigidity_of_elastic)

    def _read_rigidity(self, scenario: Scenario) -> float:
        return self._rigidity

    def _change_rigidity(self, rigidity: float) -> Changes:
        """Return the robot with an elastic fin of this rigidity; without a fin, keep the rigidity for the next one."""
        robot = self._live.scenario.robot
        if robot.caudal_fin is None:
            self._rigidity = check_positive("flexural_rigidity", rigidity, "N m^2")
            return {"robot": robot}
        return {"robot": self._with_fin(ELASTIC, rigidity)}


def has_elastic_fin(scenario: Scenario) -> bool:
    """Return whether the robot has a fin that bends."""
    fin = scenario.robot.caudal_fin
    return fin is not None and fin.n_hinges > 0


def _read_fin(scenario: Scenario) -> str:
    if scenario.robot.caudal_fin is None:
        return NO_FIN
    if has_elastic_fin(scenario):
        return ELASTIC
    return RIGID


def _read_model(scenario: Scenario) -> str:
    return name_of(type(scenario.model))


def _change_model(name: str) -> Changes:
    return {"model": name}


def _read_joints(scenario: Scenario) -> str:
    return name_of(type(scenario.model.joints))


def _change_joints(name: str) -> Changes:
    return {"joints": name}


def list_available_models() -> tuple[str, ...]:
    """Return the models available in this installation."""
    return tuple(name for name in MODELS if name == "planar" or find_spec("mujoco"))
