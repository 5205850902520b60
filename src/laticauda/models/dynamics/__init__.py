"""Common parts of both models.

- `plant`: base of their plants; `samples`: states and samples of plants.
- `school`: base of their schools, many robots side by side.
- `joint_table`, `semi_implicit`: the joints in their kernels, and the method of steps with driven ones.
- `shared_laws`: the scalar laws that the kernels of both call; `bounds`: where a run has diverged.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.models.dynamics.plant import Plant as Plant
    from laticauda.models.dynamics.samples import PlantState as PlantState
    from laticauda.models.dynamics.school import Motion as Motion, School as School

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.models.dynamics.plant": ["Plant"],
        "laticauda.models.dynamics.samples": ["PlantState"],
        "laticauda.models.dynamics.school": ["Motion", "School"],
    },
)
