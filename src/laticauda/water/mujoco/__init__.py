"""Water for any MuJoCo model: `attach` it, and the model's own steps include its loads.

    from laticauda.water import mujoco as water

    model = water.compiled(spec)          # or mujoco.MjModel.from_xml_path(...), or that of an environment
    handle = water.attach(model)          # or with elements of your own, a surface, a current
    mujoco.mj_step(model, data)           # with drag, exact added mass, buoyancy

Independent of laticauda's robots. Requires the extra `spatial`.

What the user calls: `water` (attach water to a model), `elements` (pieces of bodies), `geoms`
(elements fitted to shapes), `radiation` (waves that they make), `ground` (contacts), `specs`
(models with room for added mass), `steps` (the largest step), with `lamb`, `bodies`, `checks`,
`advice` and `floating` behind them.
What steps: `callback` and `sensors` (MuJoCo calls them), `element_loads`, `hydrostatics` and
`vectors` (compiled formulas), `law_entry` and `law_functions` (laws and flows by their address).
What both share: `table` (its layout) and `filling`, `currents` (how the water moves), `registry`
(which models have water), `native` (MuJoCo's memory and functions).
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.water.mujoco.elements import Element as Element
    from laticauda.water.mujoco.geoms import (
        GeomCoefficients as GeomCoefficients,
        geom_element as geom_element,
        geom_elements as geom_elements,
    )
    from laticauda.water.mujoco.ground import Contact as Contact, Terrain as Terrain, SINK as SINK
    from laticauda.water.mujoco.radiation import with_radiation as with_radiation
    from laticauda.water.mujoco.specs import compile_spec as compile_spec
    from laticauda.water.mujoco.steps import stable_step as stable_step
    from laticauda.water.mujoco.water import Water as Water, attach as attach, attached as attached
    from laticauda.water.mujoco.checks import choose_right_solver as choose_right_solver
    from laticauda.water.mujoco.flexes import flex_elements as flex_elements
    from laticauda.water.mujoco.native import (
        forces_after as forces_after,
        forward_skip as forward_skip,
        integrate_positions as integrate_positions,
    )
    from laticauda.water.mujoco.table import AT as AT
    from laticauda.water.mujoco.vectors import field as field, numbers as numbers

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.water.mujoco.elements": ["Element"],
        "laticauda.water.mujoco.geoms": ["GeomCoefficients", "geom_element", "geom_elements"],
        "laticauda.water.mujoco.ground": ["Contact", "Terrain"],
        "laticauda.water.mujoco.radiation": ["with_radiation"],
        "laticauda.water.mujoco.specs": ["compile_spec"],
        "laticauda.water.mujoco.steps": ["stable_step"],
        "laticauda.water.mujoco.water": ["Water", "attach", "attached"],
    },
    plain={
        "laticauda.water.mujoco.checks": ["choose_right_solver"],
        "laticauda.water.mujoco.flexes": ["flex_elements"],
        "laticauda.water.mujoco.ground": ["SINK"],
        "laticauda.water.mujoco.native": ["forces_after", "forward_skip", "integrate_positions"],
        "laticauda.water.mujoco.table": ["AT"],
        "laticauda.water.mujoco.vectors": ["field", "numbers"],
    },
    renamed={"compiled": "compile_spec"},
)
