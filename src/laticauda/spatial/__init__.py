"""Three-dimensional robot models in MuJoCo, for simulation, for export, and as parts of a custom scene.

Requires the extra `spatial`; MuJoCo is imported on first use.
"""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.spatial.mjcf import spec as spec, write_mjcf as write_mjcf
    from laticauda.spatial.water_robot import (
        contact as contact,
        on_ground as on_ground,
        robot_elements as robot_elements,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.spatial.mjcf": ["spec", "write_mjcf"],
        "laticauda.spatial.water_robot": ["contact", "on_ground", "robot_elements"],
    },
)
