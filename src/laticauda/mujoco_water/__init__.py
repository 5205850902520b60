"""Water for any MuJoCo model: `attach` it, and the model's own steps include its loads.

    from laticauda import mujoco_water as water

    model = water.compiled(spec)          # or mujoco.MjModel.from_xml_path(...), or that of an environment
    handle = water.attach(model)          # or with elements of your own, a surface, a current
    mujoco.mj_step(model, data)           # with drag, exact added mass, buoyancy

Independent of laticauda's robots. Requires the extra `spatial`.
"""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.mujoco_water.checks import stable_step as stable_step
    from laticauda.mujoco_water.elements import (
        Element as Element,
        GeomCoefficients as GeomCoefficients,
        geom_element as geom_element,
        geom_elements as geom_elements,
    )
    from laticauda.mujoco_water.ground import Contact as Contact, Terrain as Terrain
    from laticauda.mujoco_water.water import (
        Water as Water,
        attach as attach,
        attached as attached,
        compile_spec as compile_spec,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.mujoco_water.checks": ["stable_step"],
        "laticauda.mujoco_water.elements": [
            "Element",
            "GeomCoefficients",
            "geom_element",
            "geom_elements",
        ],
        "laticauda.mujoco_water.ground": ["Contact", "Terrain"],
        "laticauda.mujoco_water.water": ["Water", "attach", "attached", "compile_spec"],
    },
    renamed={"compiled": "compile_spec"},
)
