"""What a robot does in a phase of a mission.

behaviour.py  what a behaviour is
routes.py     swims straight on, to points, looks for something, rests
walls.py      swims along a net or a pipe by sonar
docking.py    swims into a dock, gives up in time and tries again
station.py    stays at a point, by swimming or by thrusters
"""

from laticauda.missions.behaviours.behaviour import Behaviour as Behaviour, Outcome as Outcome
from laticauda.missions.behaviours.docking import SwimIntoDock as SwimIntoDock
from laticauda.missions.behaviours.routes import (
    Rest as Rest,
    Search as Search,
    SwimRoute as SwimRoute,
    SwimStraight as SwimStraight,
)
from laticauda.missions.behaviours.station import Hover as Hover, KeepStation as KeepStation
from laticauda.missions.behaviours.walls import FollowWall as FollowWall, StandOff as StandOff
