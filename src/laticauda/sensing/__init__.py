"""Sensing: what is in the water around a robot, and what the robot measures of it and of itself.

observed.py    what is true of a robot at one moment, and what sensors tell
body_loads.py  what its links and joints bear at that moment

places       nets, pipelines, walls, docks, buoys: what sonar sees and a robot can touch
sensors      what a robot measures, with noise, rate, latency, losses and faults
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.sensing.body_loads import BodyLoads as BodyLoads
    from laticauda.sensing.observed import (
        HeadMotion as HeadMotion,
        Observed as Observed,
        Reading as Reading,
        EVALUATE_LOADS as EVALUATE_LOADS,
    )
    from laticauda.sensing.places import (
        Buoy as Buoy,
        Dock as Dock,
        Net as Net,
        Pipeline as Pipeline,
        Place as Place,
        Seabed as Seabed,
        Solid as Solid,
        Wall as Wall,
        Outline as Outline,
        ShapeKind as ShapeKind,
        Three as Three,
        surroundings_of as surroundings_of,
    )
    from laticauda.sensing.sensors import (
        AcousticPosition as AcousticPosition,
        Altimeter as Altimeter,
        BatteryGauge as BatteryGauge,
        Compass as Compass,
        ContactSensor as ContactSensor,
        DepthGauge as DepthGauge,
        DopplerVelocity as DopplerVelocity,
        InertialUnit as InertialUnit,
        PressureSensor as PressureSensor,
        Sensor as Sensor,
        SensorFault as SensorFault,
        Sight as Sight,
        Sonar as Sonar,
        StrainGauge as StrainGauge,
        Senses as Senses,
        senses_of as senses_of,
        signals_of_readings as signals_of_readings,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.sensing.body_loads": ["BodyLoads"],
        "laticauda.sensing.observed": [
            "HeadMotion",
            "Observed",
            "Reading",
        ],
        "laticauda.sensing.places": [
            "Buoy",
            "Dock",
            "Net",
            "Pipeline",
            "Place",
            "Seabed",
            "Solid",
            "Wall",
        ],
        "laticauda.sensing.sensors": [
            "AcousticPosition",
            "Altimeter",
            "BatteryGauge",
            "Compass",
            "ContactSensor",
            "DepthGauge",
            "DopplerVelocity",
            "InertialUnit",
            "PressureSensor",
            "Sensor",
            "SensorFault",
            "Sight",
            "Sonar",
            "StrainGauge",
            "Senses",
        ],
    },
    plain={
        "laticauda.sensing.observed": ["EVALUATE_LOADS"],
        "laticauda.sensing.places": ["Outline", "ShapeKind", "Three", "surroundings_of"],
        "laticauda.sensing.sensors": ["senses_of", "signals_of_readings"],
    },
)
