"""The paper's closed-form planar model: the recursion, the drives and the steps that compute a run.

All numbers of a run stand in one flat array; docs/developing/planar.md is a map of it.

rows        names of all numbers of the array
layout      a robot and its environment as that array
loads       forces on the bodies, from water or ground and effectors
recursion   accelerations and joint torques from forces
drives      the reference generator and the joint laws
stepping    steps in time
model       a single robot as a `Plant`
batch       many runs at once
school      many robots that are commanded step by step
"""
