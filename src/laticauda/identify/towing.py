"""Tows: a straight robot pulled at a constant velocity, and the loads that hold it.

Nothing swims in a tow, so nothing is simulated: the loads are smooth functions in closed form, and
their derivatives are finite differences.
"""

import laticauda as lc
from laticauda.models.planar import PlanarPlant
from laticauda.scenarios import Planar
from laticauda.values import quantity, value_class

_WITHOUT_STEPS = Planar(dt=0.05)
"""Settings of a plant that is not simulated: choosing a time step takes longer than the loads."""
LOADS = {"drag": "N", "side_force": "N", "yaw_moment": "N m"}
"""Loads of a tow, and their units; see `Tow`."""


@value_class
class Tow:
    """Tow of a straight robot at a constant velocity, and the loads that hold it (`LOADS`).

    The drag is along the body, and the side force across it. For a positive angle, the side force
    is positive, and the yaw moment about the middle of the links is positive if it turns the robot
    further away.
    """

    speed: float = quantity("m/s", "Speed through the water", gt=0.0)
    angle: float = quantity(
        "rad", "Angle from the direction of the tow to the heading", default=0.0
    )

    def loads(self, scenario: lc.Scenario) -> dict[str, float]:
        """Compute the loads exerted by the water.

        Args:
            scenario: Scenario that provides robot and water; all else is ignored.
        """
        plant = PlanarPlant(
            robot=scenario.robot, environment=scenario.environment, settings=_WITHOUT_STEPS
        )
        along, across, moment = plant.towing_load(self.speed, self.angle)
        return {"drag": -along, "side_force": across, "yaw_moment": moment}
