"""Robots behind ros2_control, and motion capture on topics of ROS 2, for laticauda."""
