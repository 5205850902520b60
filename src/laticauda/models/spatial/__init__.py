"""Three-dimensional robot models in MuJoCo, for simulation, for export, and as parts of a custom scene.

Requires the extra `spatial`; MuJoCo is imported on first use.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.models.spatial.mjcf import build_spec as build_spec, write_mjcf as write_mjcf
    from laticauda.models.spatial.water_robot import (
        ground_contact as ground_contact,
        lay_on_ground as lay_on_ground,
        robot_elements as robot_elements,
    )
    from laticauda.models.spatial.appearance import HULL as HULL
    from laticauda.models.spatial.bodies import (
        AXES as AXES,
        Body as Body,
        ballast_of as ballast_of,
        build_bodies as build_bodies,
        straight_center_of_mass as straight_center_of_mass,
    )
    from laticauda.models.spatial.frames import Frames as Frames
    from laticauda.models.spatial.model import SpatialPlant as SpatialPlant
    from laticauda.models.spatial.school import School as School, Together as Together
    from laticauda.models.spatial.urdf import write_urdf as write_urdf

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.models.spatial.mjcf": ["build_spec", "write_mjcf"],
        "laticauda.models.spatial.water_robot": [
            "ground_contact",
            "lay_on_ground",
            "robot_elements",
        ],
    },
    plain={
        "laticauda.models.spatial.appearance": ["HULL"],
        "laticauda.models.spatial.bodies": [
            "AXES",
            "Body",
            "ballast_of",
            "build_bodies",
            "straight_center_of_mass",
        ],
        "laticauda.models.spatial.frames": ["Frames"],
        "laticauda.models.spatial.model": ["SpatialPlant"],
        "laticauda.models.spatial.school": ["School", "Together"],
        "laticauda.models.spatial.urdf": ["write_urdf"],
    },
    renamed={"contact": "ground_contact", "on_ground": "lay_on_ground", "spec": "build_spec"},
)
