"""The robot in space, with MuJoCo: models to simulate and to export, and the parts of them for a scene of one's own.

It needs the extra `spatial`; MuJoCo is loaded when it is first needed, and not before.
"""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.spatial.mjcf import spec as spec, write_mjcf as write_mjcf
    from laticauda.spatial.water_robot import contact as contact, on_ground as on_ground
    from laticauda.spatial.water_robot import robot_elements as robot_elements

__getattr__, __dir__, __all__ = lazy_exports()
