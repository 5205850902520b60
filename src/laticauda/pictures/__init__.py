"""Pictures and videos of trials, and a window to look at them, with MuJoCo's renderer.

It needs the extra `spatial`.
"""
