"""Three-dimensional robot models in MuJoCo, for simulation, for export, and as parts of a custom scene.

Requires the extra `spatial`; MuJoCo is imported on first use. Of the robot:

- `bodies`: its bodies with their frames, joints and masses; `mounts`: poses of its effectors.
- `mjcf`, `mjcf_parts`: the robot as a MuJoCo model; `urdf`: as URDF; `frames`: its links as frames.
- `meshes`, `module_shapes`, `fin_shapes`, `mesh_files`, `appearance`: what it looks like.
- `scene`, `solids`, `surroundings`: what is around it.
- `water_robot`, `ground_robot`: the elements on which water and ground act.

Of the simulation:

- `model`: the robot as a plant; `school`: many robots, and several in one scene.
- `settings`: what a model's settings mean; `twin`: the MuJoCo model of a plant, laid out in `places`.
- `rows`, `states`: layout of the kernels' arrays, and how states move in them; `drives`: drives of
  the joints; `stepping`, `driven`: time steps, those of prescribed and those of free joints.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.models.spatial.ground_robot import (
        ground_contact as ground_contact,
        lay_on_ground as lay_on_ground,
    )
    from laticauda.models.spatial.mjcf import build_spec as build_spec, write_mjcf as write_mjcf
    from laticauda.models.spatial.water_robot import robot_elements as robot_elements
    from laticauda.models.spatial.appearance import HULL as HULL, MATERIALS as MATERIALS
    from laticauda.models.spatial.bodies import (
        AXES as AXES,
        Body as Body,
        ballast_of as ballast_of,
        build_bodies as build_bodies,
        straight_center_of_mass as straight_center_of_mass,
    )
    from laticauda.models.spatial.fin_shapes import (
        Box as Box,
        build_fin_plate as build_fin_plate,
        build_fin_rods as build_fin_rods,
    )
    from laticauda.models.spatial.frames import Frames as Frames
    from laticauda.models.spatial.meshes import Mesh as Mesh, join_meshes as join_meshes
    from laticauda.models.spatial.model import SpatialPlant as SpatialPlant
    from laticauda.models.spatial.module_shapes import choose_builders as choose_builders
    from laticauda.models.spatial.school import School as School, Together as Together
    from laticauda.models.spatial.surroundings import (
        add_places as add_places,
        reporting_scene_errors as reporting_scene_errors,
    )
    from laticauda.models.spatial.urdf import write_urdf as write_urdf

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.models.spatial.ground_robot": ["ground_contact", "lay_on_ground"],
        "laticauda.models.spatial.mjcf": ["build_spec", "write_mjcf"],
        "laticauda.models.spatial.water_robot": ["robot_elements"],
    },
    plain={
        "laticauda.models.spatial.appearance": ["HULL", "MATERIALS"],
        "laticauda.models.spatial.bodies": [
            "AXES",
            "Body",
            "ballast_of",
            "build_bodies",
            "straight_center_of_mass",
        ],
        "laticauda.models.spatial.fin_shapes": ["Box", "build_fin_plate", "build_fin_rods"],
        "laticauda.models.spatial.frames": ["Frames"],
        "laticauda.models.spatial.meshes": ["Mesh", "join_meshes"],
        "laticauda.models.spatial.model": ["SpatialPlant"],
        "laticauda.models.spatial.module_shapes": ["choose_builders"],
        "laticauda.models.spatial.school": ["School", "Together"],
        "laticauda.models.spatial.surroundings": ["add_places", "reporting_scene_errors"],
        "laticauda.models.spatial.urdf": ["write_urdf"],
    },
    renamed={"contact": "ground_contact", "on_ground": "lay_on_ground", "spec": "build_spec"},
)
