"""Water for any MuJoCo model: `attach` it, and the model's own steps feel it.

    from laticauda import mujoco_water as water

    model = water.compiled(spec)                  # or mujoco.MjModel.from_xml_path(...)
    element = water.geom_element(model, "hull", coefficients)
    handle = water.attach(model, [element], density=1000.0, surface=0.0)
    mujoco.mj_step(model, data)                   # with drag, exact added mass, buoyancy

It knows no robot of laticauda's. It needs the extra `spatial`.
"""

from laticauda.mujoco_water.checks import stable_step
from laticauda.mujoco_water.elements import Element, GeomCoefficients, geom_element
from laticauda.mujoco_water.ground import Contact, Terrain
from laticauda.mujoco_water.water import Water, attach, compiled

__all__ = [
    "Contact",
    "Element",
    "GeomCoefficients",
    "Terrain",
    "Water",
    "attach",
    "compiled",
    "geom_element",
    "stable_step",
]
