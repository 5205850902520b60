"""Robots of laticauda behind ArduPilot: its JSON SITL protocol, in lock step, over any scenario.

packets.py    servo packets in, lines of sensor readings out
mixing.py     what every servo output does, in TOML
battery.py    voltage and current of the battery from the robot's power
attitude.py   axes of the robot and of the autopilot
vehicle.py    a scenario that is stepped by servo outputs
lock_step.py  which packet advances time: lost, doubled, late packets and restarts
server.py     the UDP socket
app.py        the command `laticauda-ardupilot`
emulator.py   stands for ArduPilot: the other side of the protocol, and a pilot with PID loops
"""

from laticauda_ardupilot.battery import Battery as Battery
from laticauda_ardupilot.lock_step import LockStep as LockStep
from laticauda_ardupilot.mixing import Mixing as Mixing, load_mixing as load_mixing
from laticauda_ardupilot.server import PORT as PORT, Server as Server
from laticauda_ardupilot.vehicle import Vehicle as Vehicle
