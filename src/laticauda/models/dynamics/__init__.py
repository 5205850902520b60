"""Common parts of both models: the base of their plants, and the joints and time steps of their kernels."""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.models.dynamics.plant import Plant as Plant, PlantState as PlantState
    from laticauda.models.dynamics.school import Motion as Motion, School as School

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.models.dynamics.plant": ["Plant", "PlantState"],
        "laticauda.models.dynamics.school": ["Motion", "School"],
    },
)
