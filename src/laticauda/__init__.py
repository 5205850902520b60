"""laticauda: simulate, identify, optimize and operate swimming snake robots, with and without a caudal fin.

    import laticauda as lc
    trial = lc.swim(lc.load_robot("mamba"), lc.lateral_undulation(amplitude=0.52, frequency=2.27, phase_shift=0.70))

Names are imported when they are first used, so that ``import laticauda`` stays fast and loads no
heavy library.
"""

import os
from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.actuation import (
        PD as PD,
        JointLaw as JointLaw,
        Prescribed as Prescribed,
        Servo as Servo,
    )
    from laticauda.actuation import SpeedServo as SpeedServo
    from laticauda.control import (
        HeadingController as HeadingController,
        IntegralLineOfSight as IntegralLineOfSight,
    )
    from laticauda.control import (
        LineOfSight as LineOfSight,
        Following as Following,
        PathFollowing as PathFollowing,
    )
    from laticauda.control import (
        Polyline as Polyline,
        SpatialPathFollowing as SpatialPathFollowing,
        Spline as Spline,
    )
    from laticauda.control import StraightLine as StraightLine
    from laticauda.dynamics.plant import Plant as Plant
    from laticauda.fluid import (
        CoulombFriction as CoulombFriction,
        DragLaw as DragLaw,
        FunctionDrag as FunctionDrag,
    )
    from laticauda.fluid import PolynomialDrag as PolynomialDrag, TotalSpeedDrag as TotalSpeedDrag
    from laticauda.fluid import ViscousFriction as ViscousFriction
    from laticauda.gaits import (
        Anguilliform as Anguilliform,
        Custom as Custom,
        EelLike as EelLike,
        Envelope as Envelope,
    )
    from laticauda.gaits import (
        Gait as Gait,
        JointAngles as JointAngles,
        LateralUndulation as LateralUndulation,
    )
    from laticauda.gaits import Wave as Wave, custom_gait as custom_gait, eel_like as eel_like
    from laticauda.gaits import (
        lateral_undulation as lateral_undulation,
        recorded_gait as recorded_gait,
    )
    from laticauda.interfaces import (
        Command as Command,
        Controller as Controller,
        Observation as Observation,
    )
    from laticauda.interfaces import OpenLoop as OpenLoop, Start as Start
    from laticauda.logs import load_trial as load_trial
    from laticauda.packaging import __version__ as __version__
    from laticauda.robot import (
        Ground as Ground,
        Parameters as Parameters,
        Robot as Robot,
        Water as Water,
    )
    from laticauda.robot import load_current as load_current, load_ground as load_ground
    from laticauda.robot import load_joint_angles as load_joint_angles
    from laticauda.robot import (
        load_parameters as load_parameters,
        load_robot as load_robot,
        load_water as load_water,
    )
    from laticauda.scenarios import Planar as Planar, Scenario as Scenario, Spatial as Spatial
    from laticauda.scenarios import (
        load_scenario as load_scenario,
        save_scenario as save_scenario,
        scenario as scenario,
    )
    from laticauda.simulate import (
        Swims as Swims,
        plant as plant,
        resume as resume,
        run as run,
        swim as swim,
    )
    from laticauda.simulate import swim_many as swim_many, swim_together as swim_together
    from laticauda.trial import Trial as Trial, compare as compare, joined as joined

if not os.path.isdir(__path__[0]):
    raise ImportError(
        "laticauda must be installed in a folder: it reads kernels and presets from files, not archives"
    )
__getattr__, __dir__, __all__ = lazy_exports()
