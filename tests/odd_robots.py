"""Robot files that say what nobody means, for tests of what is answered."""

MM_ROBOT = """
kind = "robot"
name = "in mm"
[[modules]]
count = 4
length = 100
mass = 300
[modules.section]
half_height = 30
half_width = 30
[[joints]]
count = 3
"""
