"""The procedure of an operation as a pure tick, without clock, bus or threads.

state.py             inputs, state and outputs of a tick
intake.py            how inputs become samples and an estimate
clocks.py            the offset of the cameras' clock
preparing.py         the phases before the run
calibration.py       what is measured of the robot that lies straight
stillness.py         whether the robot has been still for long enough
reference_source.py  references of the joints
operator.py          the tick: monitors, prepares, supervises, and orders
"""
