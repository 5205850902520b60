"""Pictures and videos of trials, and an interactive window to view them, with MuJoCo's renderer.

Requires the extra `spatial`.
"""
