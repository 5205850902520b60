"""What a place is: something solid in the water, with a name, that sonar sees and a robot can touch."""

from functools import lru_cache

import numpy as np
from jaxtyping import Float

from laticauda.sensing.places.solids import Outline, Solid, Solids
from laticauda.values import BadArgument, Extensible, check_label, option, value_class


@value_class
class Place(Extensible, group="places"):
    """Base of places: nets, pipes, walls, docks and buoys. A place of one's own is a subclass with `solids`.

    World axes: z is up, 0 at the surface of still water. A place is at rest. In space the robot
    touches it; the planar model lets it pass through, and only tells how near it came
    (`Surroundings.distances`).
    """

    name: str = option("Name in messages, pictures and models", check=check_label)

    def solids(self) -> tuple[Solid, ...]:
        """Return the solid shapes of which it consists."""
        raise NotImplementedError

    def outlines(self) -> tuple[Outline, ...]:
        """Return the outline of every shape as seen from above, for maps [m]."""
        return tuple(solid.outline() for solid in self.solids())


class Surroundings:
    """All places of a run, seen by sensors.

    Args:
        places: The places; none for open water.
    """

    def __init__(self, places: tuple[Place, ...]) -> None:
        self.places = places
        all_solids: list[Solid] = []
        self._solids_of_places: dict[str, Solids] = {}
        for place in places:
            solids = place.solids()
            all_solids += solids
            self._solids_of_places[place.name] = Solids(solids)
        self.solids = Solids(all_solids)

    def distances(
        self, points: Float[np.ndarray, "n_points 3"], place: str | None = None
    ) -> Float[np.ndarray, " n_points"]:
        """Return how far points are from the nearest surface, negative inside; infinite in open water [m].

        Args:
            points: The points, world axes [m].
            place: Name of the only place that counts; None: all.

        Raises:
            ValueError: If there is no place of that name.
        """
        if place is None:
            return self.solids.distances(points)
        if place not in self._solids_of_places:
            names = ", ".join(f"`{name}`" for name in self._solids_of_places) or "none"
            raise BadArgument("place", f"must be the name of a place, {names}, got {place!r}")
        return self._solids_of_places[place].distances(points)


@lru_cache(maxsize=256)
def surroundings_of(places: tuple[Place, ...]) -> Surroundings:
    """Return the surroundings of some places, made once.

    Args:
        places: The places.
    """
    return Surroundings(places)
