"""Model-predictive guidance, which plans ahead in a current; needs the extra `mpc`.

- planning: the optimal plan of the next seconds, as a problem for a solver
- predictive: the controller, which plans at every instant and carries out the plan's beginning
"""
