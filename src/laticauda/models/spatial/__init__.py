"""Three-dimensional robot models in MuJoCo, for simulation, for export, and as parts of a custom scene.

Requires the extra `spatial`; MuJoCo is imported on first use.
"""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.models.spatial.mjcf import build_spec as build_spec, write_mjcf as write_mjcf
    from laticauda.models.spatial.water_robot import (
        ground_contact as ground_contact,
        lay_on_ground as lay_on_ground,
        robot_elements as robot_elements,
    )

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
    renamed={"contact": "ground_contact", "on_ground": "lay_on_ground", "spec": "build_spec"},
)
