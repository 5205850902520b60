"""Places in the water that sonar sees and a robot can touch.

solids.py      boxes, cylinders and spheres, met by rays and touched by points
place.py       what a place is, and all places of a run
structures.py  walls, net pens, pipelines, buoys, the bed
dock.py        a dock and the condition under which it catches a robot
"""

from laticauda.sensing.places.dock import Dock as Dock
from laticauda.sensing.places.place import (
    Place as Place,
    Surroundings as Surroundings,
    surroundings_of as surroundings_of,
)
from laticauda.sensing.places.solids import (
    Hits as Hits,
    Outline as Outline,
    ShapeKind as ShapeKind,
    Solid as Solid,
    Solids as Solids,
    Three as Three,
)
from laticauda.sensing.places.structures import (
    Buoy as Buoy,
    Net as Net,
    Pipeline as Pipeline,
    Seabed as Seabed,
    Wall as Wall,
)
