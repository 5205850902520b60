"""The tank: its wires, the virtual tank, and the operation of the robot with its safety."""
