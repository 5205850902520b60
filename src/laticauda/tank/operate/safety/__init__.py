"""Safety of the robot and of people: reports of the modules, limits, rules, and the supervisor."""
