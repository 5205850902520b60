"""What `import laticauda as lc` offers.

A Python toolkit for swimming snake robots: simulate them, fit the model to measurements, optimize
their gaits, and operate them.

    import laticauda as lc
    trial = lc.swim(lc.load_robot("mamba"), lc.lateral_undulation(amplitude=0.52, frequency=2.27, phase_shift=0.70))

Names are imported when they are first used, so that ``import laticauda`` stays fast and loads no
heavy library.
"""

import os
from typing import TYPE_CHECKING

from laticauda.values import moved
from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.values.errors import (
        ImplausibleWarning as ImplausibleWarning,
        InfeasibleWarning as InfeasibleWarning,
        UnitWarning as UnitWarning,
    )
    from laticauda.motion.joints import (
        Ekeberg as Ekeberg,
        Hill as Hill,
        JointLaw as JointLaw,
        PD as PD,
        Prescribed as Prescribed,
        Servo as Servo,
        SpeedServo as SpeedServo,
    )
    from laticauda.control import (
        Following as Following,
        HeadingController as HeadingController,
        IntegralLineOfSight as IntegralLineOfSight,
        LineOfSight as LineOfSight,
        PathFollowing as PathFollowing,
        Polyline as Polyline,
        SpatialPathFollowing as SpatialPathFollowing,
        Spline as Spline,
        StraightLine as StraightLine,
    )
    from laticauda.models.dynamics.plant import Plant as Plant
    from laticauda.water.fluid import (
        CoulombFriction as CoulombFriction,
        DragLaw as DragLaw,
        FunctionDrag as FunctionDrag,
        PolynomialDrag as PolynomialDrag,
        TotalSpeedDrag as TotalSpeedDrag,
        ViscousFriction as ViscousFriction,
    )
    from laticauda.motion.gaits import (
        Anguilliform as Anguilliform,
        Custom as Custom,
        EelLike as EelLike,
        Envelope as Envelope,
        Gait as Gait,
        JointAngles as JointAngles,
        LateralUndulation as LateralUndulation,
        Wave as Wave,
        custom_gait as custom_gait,
        eel_like as eel_like,
        lateral_undulation as lateral_undulation,
        recorded_gait as recorded_gait,
    )
    from laticauda.scenarios.interfaces import (
        Command as Command,
        Controller as Controller,
        Observation as Observation,
        OpenLoop as OpenLoop,
        Start as Start,
    )
    from laticauda.trials.logs import load_trial as load_trial
    from laticauda.values.packaging import __version__ as __version__
    from laticauda.robot import (
        Ground as Ground,
        Parameters as Parameters,
        Robot as Robot,
        Water as Water,
        load_current as load_current,
        load_ground as load_ground,
        load_joint_angles as load_joint_angles,
        load_parameters as load_parameters,
        load_robot as load_robot,
        load_water as load_water,
    )
    from laticauda.scenarios import (
        Planar as Planar,
        Scenario as Scenario,
        Spatial as Spatial,
        load_scenario as load_scenario,
        save_scenario as save_scenario,
        build_scenario as build_scenario,
    )
    from laticauda.models.simulate import (
        Swims as Swims,
        build_plant as build_plant,
        resume as resume,
        run as run,
        swim as swim,
        swim_many as swim_many,
        swim_together as swim_together,
    )
    from laticauda.trials import Trial as Trial, compare as compare, joined as joined

if not os.path.isdir(__path__[0]):
    raise ImportError(
        "laticauda must be installed in a folder: it reads kernels and presets from files, not archives"
    )
moved.accept_former_paths()
_MEANT = {
    "controller": ("PathFollowing", "HeadingController", "OpenLoop"),
    "environment": ("load_water", "load_ground"),
    "fit": ("laticauda.identify.fit",),
    "follow": ("swim with a controller, such as PathFollowing",),
    "gait": ("lateral_undulation", "eel_like", "custom_gait"),
    "gaits": ("lateral_undulation", "eel_like", "custom_gait"),
    "identify_parameters": ("laticauda.identify.fit",),
    "load": ("load_robot", "load_trial", "load_scenario"),
    "load_gait": ("lateral_undulation", "eel_like", "custom_gait"),
    "optimise": ("laticauda.studies.optimize",),
    "optimize": ("laticauda.studies.optimize",),
    "plot": ("Trial.plot, as in trial.plot()",),
    "read": ("load_robot", "load_trial", "load_scenario"),
    "save": ('Trial.save, as in trial.save("run.nc")',),
    "sim": ("swim",),
    "simulation": ("swim",),
    "simulator": ("swim",),
    "sweep": ("laticauda.studies.run_sweep", "swim_many"),
    "undulation": ("lateral_undulation",),
}
"""What is probably meant, by names that people try in vain."""
__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.values.errors": ["ImplausibleWarning", "InfeasibleWarning", "UnitWarning"],
        "laticauda.motion.joints": [
            "Ekeberg",
            "Hill",
            "JointLaw",
            "PD",
            "Prescribed",
            "Servo",
            "SpeedServo",
        ],
        "laticauda.control": [
            "Following",
            "HeadingController",
            "IntegralLineOfSight",
            "LineOfSight",
            "PathFollowing",
            "Polyline",
            "SpatialPathFollowing",
            "Spline",
            "StraightLine",
        ],
        "laticauda.models.dynamics.plant": ["Plant"],
        "laticauda.water.fluid": [
            "CoulombFriction",
            "DragLaw",
            "FunctionDrag",
            "PolynomialDrag",
            "TotalSpeedDrag",
            "ViscousFriction",
        ],
        "laticauda.motion.gaits": [
            "Anguilliform",
            "Custom",
            "EelLike",
            "Envelope",
            "Gait",
            "JointAngles",
            "LateralUndulation",
            "Wave",
            "custom_gait",
            "eel_like",
            "lateral_undulation",
            "recorded_gait",
        ],
        "laticauda.scenarios.interfaces": [
            "Command",
            "Controller",
            "Observation",
            "OpenLoop",
            "Start",
        ],
        "laticauda.trials.logs": ["load_trial"],
        "laticauda.values.packaging": ["__version__"],
        "laticauda.robot": [
            "Ground",
            "Parameters",
            "Robot",
            "Water",
            "load_current",
            "load_ground",
            "load_joint_angles",
            "load_parameters",
            "load_robot",
            "load_water",
        ],
        "laticauda.scenarios": [
            "Planar",
            "Scenario",
            "Spatial",
            "load_scenario",
            "save_scenario",
            "build_scenario",
        ],
        "laticauda.models.simulate": [
            "Swims",
            "build_plant",
            "resume",
            "run",
            "swim",
            "swim_many",
            "swim_together",
        ],
        "laticauda.trials": ["Trial", "compare", "joined"],
    },
    meant=_MEANT,
    renamed={"plant": "build_plant", "scenario": "build_scenario", **moved.FORMER_PACKAGES},
)
