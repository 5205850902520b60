"""Robots behind ros2_control, motion capture on topics of ROS 2, and scenarios as nodes, for laticauda.

node.py          readers and writers of topics, by DDS
messages.py      the messages of ROS 2 that are used here
bus.py           a robot behind ros2_control, for `laticauda operate`
mocap.py         poses from a topic, for `laticauda operate`
emulator.py      a virtual tank for both
drive.py         from a `Twist` to a command
reports.py       what a simulated robot tells, as messages
vehicle_node.py  the node that serves a scenario
app.py           the command `laticauda-ros2`
"""
