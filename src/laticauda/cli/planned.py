"""`laticauda follow --guidance model-predictive`: what is planned for."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from laticauda.cli.flags import Ends, Number, default

if TYPE_CHECKING:
    from laticauda.control import ModelPredictive, Path
    from laticauda.gaits import Gait
    from laticauda.interfaces import Plant


@dataclass(frozen=True, kw_only=True)
class PlanFlags:
    """Model-predictive guidance; it learns how the gait moves the robot in four trials of its own first."""

    speed: Annotated[Number, default("what the gait swims")] = None
    """Speed along the path that is asked for [m/s]."""
    power_limit: Annotated[Number, default("none")] = None
    """Most that the gait may take, mean over its cycle [W]."""
    frequency_limits_deg_s: Annotated[Ends, default("the gait's frequency alone")] = None
    """Least and greatest frequency of the gait [deg/s]."""

    def controller(
        self, gait: "Gait", path: "Path[Any]", body: "Plant[Any]", settings: dict[str, Any]
    ) -> "ModelPredictive":
        """Path following by planning ahead.

        Args:
            gait: What swims.
            path: Where to go.
            body: The robot in its water.
            settings: Further fields of `ModelPredictive`.
        """
        from laticauda.control import ModelPredictive
        from laticauda.studies import averaged_model

        limits = self._limits()
        model = averaged_model(body, gait, limits)
        return ModelPredictive(
            gait=gait,
            path=path,
            model=model,
            speed=model.speed(gait.frequency, 0.0) if self.speed is None else self.speed,
            power_limit=math.inf if self.power_limit is None else self.power_limit,
            frequency_limits=limits,
            **settings,
        )

    def _limits(self) -> tuple[float, float] | None:
        if self.frequency_limits_deg_s is None:
            return None
        low, high = self.frequency_limits_deg_s
        if not 0.0 < low < high:
            raise ValueError(
                f"`frequency_limits_deg_s` must be 0 < least < greatest in deg/s, got {low:g} and {high:g}."
            )
        return math.radians(low), math.radians(high)
