"""By which model a robot swims: the closed form in the plane, or MuJoCo in space."""

from typing import Literal, TypeAlias

from laticauda.actuation.laws import JointLaw, Prescribed
from laticauda.extensions import Unknown, name_of
from laticauda.quantities import option, quantity, value
from laticauda.robot import Ground


@value
class _Model:
    """What both models have."""

    joints: JointLaw = option("How the joints follow their references", default=Prescribed())
    dt: float | None = quantity("s", "Largest time step; None takes a converged one", default=None, ge=1e-7, le=1e3)
    offset_bandwidth: float = quantity("1/s", "Of the reference generator's filters", default=10.0, gt=0.0)
    ramp: float | None = quantity(
        "s", "Duration of the smooth start; None: 1 s for prescribed joints, none for the others", default=None, ge=0.0
    )


@value
class Planar(_Model):
    """The closed-form model in the plane; a robot's pitch joints are held straight.

    Raises:
        ValueError: If a field is out of its range.
    """


@value
class Spatial(_Model):
    """MuJoCo in space, with our loads of the water; it needs the extra `spatial`.

    Raises:
        ValueError: If a field is out of its range.
    """

    root: Literal["free", "planar"] | None = option(
        "Of the tail module: free, or planar for one whose height and tilt are fixed; None: planar for a robot whose "
        "joints all turn about the vertical axis, else free",
        default=None,
    )
    gravity: bool = option("Whether there is weight and buoyancy; they do nothing to a planar root", default=True)
    ballast_depth: float = quantity(
        "m",
        "How far the modules' centers of mass lie below their axes, for a free root with gravity: without it nothing "
        "keeps a robot upright. Mamba's is not known; the default is an assumption",
        default=0.005,
    )
    tank: bool = option("Whether the tank's floor and walls are there", default=False)
    shore: Ground | None = option(
        "The ground of a shore that leads down into the water, on which the robot begins; None: there is no land",
        default=None,
    )


Model: TypeAlias = Planar | Spatial
MODELS: dict[str, type[Planar] | type[Spatial]] = {"planar": Planar, "spatial": Spatial}
"""The models by what texts call them."""


def settings_of(model: Model) -> dict[str, str | float | bool | None]:
    """A model in texts and numbers, for people.

    Args:
        model: Any.
    """
    plain = {name: one for name, one in vars(model).items() if not isinstance(one, JointLaw | Ground)}
    joints = model.joints.kind if isinstance(model.joints, Unknown) else name_of(type(model.joints))
    shore = {} if isinstance(model, Planar) or model.shore is None else {"ground": "ramp", "shore": model.shore.name}
    return {"model": name_of(type(model)), "joints": joints, **plain, **shore}
