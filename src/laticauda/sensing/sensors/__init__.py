"""Sensors as values: what a robot knows of itself and its surroundings, with noise, rate, latency and losses.

sensor.py      what a sensor is, and how the sensors of one robot are read
sonar.py       distances to places: a forward-looking fan, an altimeter
navigation.py  where the robot is and how it moves
condition.py   what it touches, what is left in its battery
loads.py       what its joints and the sides of its links bear
"""

from laticauda.sensing.sensors.condition import (
    BatteryGauge as BatteryGauge,
    ContactSensor as ContactSensor,
)
from laticauda.sensing.sensors.loads import (
    PressureSensor as PressureSensor,
    StrainGauge as StrainGauge,
)
from laticauda.sensing.sensors.navigation import (
    AcousticPosition as AcousticPosition,
    Compass as Compass,
    DepthGauge as DepthGauge,
    DopplerVelocity as DopplerVelocity,
    InertialUnit as InertialUnit,
)
from laticauda.sensing.sensors.sensor import (
    Senses as Senses,
    Sensor as Sensor,
    SensorFault as SensorFault,
    Sight as Sight,
    senses_of as senses_of,
    signals_of_readings as signals_of_readings,
)
from laticauda.sensing.sensors.sonar import Altimeter as Altimeter, Sonar as Sonar
