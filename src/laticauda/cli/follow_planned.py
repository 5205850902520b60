"""`laticauda follow --guidance model-predictive`: a run along a path that plans ahead."""

from dataclasses import replace

import laticauda as lc
from laticauda import control
from laticauda.cli.follow import Follow, learn_model
from laticauda.values import BadArgument, option, quantity, value_class


@value_class
class FollowPlanned(Follow):
    """Let a robot follow a path by planning ahead, with a model that is first fitted to four trials of the robot.

    For example: laticauda follow --robot mamba-fin --guidance model-predictive --current 0 -0.03
    --duration 60
    """

    speed: float | None = quantity(
        "m/s", "Speed along the path; none: the gait's own", gt=0.0, default=None
    )
    plan: control.PlanLimits = option("Model-predictive guidance", default=control.PlanLimits())

    def with_controller(self, scenario: lc.Scenario) -> lc.Scenario:
        """Return the scenario with a controller that uses a model fitted here; see `Follow.with_controller`."""
        if self.route.observe_current:
            rule = (
                "must be left out with model-predictive guidance, which learns the current itself"
            )
            raise BadArgument("observe_current", rule)
        path = self.route.planned_path
        gait = scenario.gait
        model = learn_model(scenario, self.plan.frequency_limits)
        speed = self.speed
        if speed is None:
            speed = model.speed(gait.frequency, 0.0)
        motion = control.ModelPredictive(
            gait=gait,
            path=path,
            model=model,
            speed=speed,
            **vars(self.plan),
        )
        return replace(scenario, motion=motion)
