"""The paper's closed-form planar model: the recursion, the drives and the steps that compute a run.

All numbers of a run stand in one flat array; docs/developing/planar.md is a map of it, and says where
a change goes. A template is a module that is loaded anew for every drag law, joint law and so on.

rows           names of all numbers of the array
sample_format  what a sample of the log and a state vector hold
number_types   what type a number of the kernels can have, and what follows from it
layout         a robot and its environment as that array
loads          forces on the bodies, from water or ground and effectors (template)
recursion      accelerations and joint torques from forces (template)
drives         the reference generator, the joint laws and the work of the joints (template)
prescribed     the same as recursion, faster, where all joints are prescribed (template)
driven         steps of robots with free joints, semi-implicit (template)
stepping       steps in time, by one of two integrators (template)
kept_run       a run that keeps what going back needs (template)
adjoint        derivatives backward in time (template)
adjoint_references  the part of it that goes back through the reference generator (template)
pullbacks      the formulas that both are made of, traced
reverse        driving it, segment by segment
model          a single robot as a `Plant`
lanes_of_runs  which lane of the kernels does which run of a batch
batch          many runs at once
given_motion   loads of a motion that is known, as from a film
fleet          many runs at once that controllers steer
fleet_loads    what their links and joints bear
load_log       loads at the samples of many runs
school         many robots that are commanded step by step
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.models.planar.batch import (
        Block as Block,
        COMMAND as COMMAND,
        FILTERED_COMMAND as FILTERED_COMMAND,
        MOST_BLOCKS_PER_TASK as MOST_BLOCKS_PER_TASK,
        SAMPLES_PER_CALL as SAMPLES_PER_CALL,
        WIDTH as WIDTH,
        aligned as aligned,
        Device as Device,
        PATH_ROWS as PATH_ROWS,
        Run as Run,
        STEP as STEP,
        block_of as block_of,
        columns_of as columns_of,
        kinds_of as kinds_of,
        march_many as march_many,
    )
    from laticauda.models.planar.given_motion import (
        GivenMotion as GivenMotion,
        MotionLoads as MotionLoads,
        evaluate_motion as evaluate_motion,
    )
    from laticauda.models.planar.fleet import (
        Fleet as Fleet,
        LoggedLeg as LoggedLeg,
        NeedsRunOfItsOwn as NeedsRunOfItsOwn,
    )
    from laticauda.models.planar.layout import Layout as Layout, build_layout as build_layout
    from laticauda.models.planar.model import (
        LEAST_DT as LEAST_DT,
        PlanarPlant as PlanarPlant,
        specialize as specialize,
    )
    from laticauda.models.planar.rows import VX as VX, VY as VY

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.models.planar.batch": [
            "Block",
            "COMMAND",
            "FILTERED_COMMAND",
            "MOST_BLOCKS_PER_TASK",
            "SAMPLES_PER_CALL",
            "WIDTH",
            "aligned",
            "Device",
            "PATH_ROWS",
            "Run",
            "STEP",
            "block_of",
            "columns_of",
            "kinds_of",
            "march_many",
        ],
        "laticauda.models.planar.given_motion": ["GivenMotion", "MotionLoads", "evaluate_motion"],
        "laticauda.models.planar.fleet": ["Fleet", "LoggedLeg", "NeedsRunOfItsOwn"],
        "laticauda.models.planar.layout": ["Layout", "build_layout"],
        "laticauda.models.planar.model": ["LEAST_DT", "PlanarPlant", "specialize"],
        "laticauda.models.planar.rows": ["VX", "VY"],
    },
)
