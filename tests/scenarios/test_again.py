"""Every simulated trial can be run again from what it stores."""

import functools
import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control import (
    AveragedModel,
    HeadingController,
    LineOfSight,
    ModelPredictive,
    OffsetSteps,
    Polyline,
    Spline,
)
from laticauda.motion.joints.laws import JointLaw
from laticauda.scenarios import Experiment, run_from_toml, run_to_toml
from laticauda.scenarios.interfaces import Controller

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
FOLLOWING = lc.PathFollowing(
    gait=GAIT,
    path=Polyline(waypoints=((0, 0), (1, 1))),
    guidance=LineOfSight(look_ahead_distance=0.2),
    heading=HeadingController(gain=0.4, max_offset=0.3),
)
MOTIONS = {
    "gait": lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7),
    "offset": lc.OpenLoop(command=lc.Command(gait=GAIT, offset=0.1)),
    "following": FOLLOWING,
    "cycle-mean": replace(
        FOLLOWING, path=Spline(waypoints=((0, 0), (1, 1))), heading_estimate="cycle-mean"
    ),
    "steps": OffsetSteps(gait=GAIT, offsets=(0.1, -0.1), interval=0.7),
    "predictive": ModelPredictive(
        gait=GAIT,
        path=lc.StraightLine(),
        model=AveragedModel(
            **dict.fromkeys(("turn_0", "speed_0", "speed_lag", "bend_lag"), 0.02),
            **dict.fromkeys(("turn_1", "bend", "sway", "sway_lag", "power_0", "power_1"), 1.0),
            **{"speed_1": 0.08, "speed_offset": -0.3, "power_exponent": 3.0, "power_offset": 11.0},
        ),
        speed=0.12,
        horizon=4,
    ),
    "spatial": FOLLOWING,
    "spatial-following": lc.SpatialPathFollowing(
        gait=GAIT,
        path=lc.StraightLine(),
        profile=Spline(waypoints=((0.0, -0.5), (2.0, -0.5), (5.0, -1.0))),
        guidance=LineOfSight(look_ahead_distance=0.5),
        climb_guidance=LineOfSight(look_ahead_distance=1.0),
        heading=HeadingController(gain=0.4, max_offset=0.3),
        climb=HeadingController(gain=0.2, max_offset=0.1),
    ),
}
IN_SPACE = {
    "spatial": {"robot": "mamba", "root": "free", "environment": "paper-vortex"},
    "spatial-following": {"robot": "mamba-modules"},
}
LIBRARIES = {"nc": "netCDF4", "mcap": "mcap", "parquet": "pyarrow", "mat": "scipy"}


def same(again, trial):
    assert again.scenario == trial.scenario
    for name in ("time", "center_of_mass", "heading", "joint_torque", "work"):
        np.testing.assert_array_equal(getattr(again, name), getattr(trial, name))


@functools.cache
def swum(motion):
    changes = {"model": "spatial", **IN_SPACE[motion]} if motion in IN_SPACE else {"joints": "pd"}
    robot, start = changes.pop("robot", "mamba"), lc.Start(heading=0.3, velocity=0.1)
    return lc.swim(
        robot, MOTIONS[motion], 1.0 if motion in IN_SPACE else 2.0, start=start, **changes
    )


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("ending", LIBRARIES)
def test_a_trial_from_a_file_is_run_again_to_the_last_bit(motion, ending, tmp_path):
    pytest.importorskip(LIBRARIES[ending])
    if motion in IN_SPACE:
        pytest.importorskip("mujoco")
    if motion == "predictive":
        pytest.importorskip("casadi")
    trial = swum(motion)
    trial.save(tmp_path / f"run.{ending}")
    stored = lc.load_trial(tmp_path / f"run.{ending}")
    assert stored.equals(trial)
    same(lc.swim(stored.scenario), trial)


def test_a_run_that_was_cut_and_one_that_went_on_are_run_again_too():
    body = lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"))
    cut = lc.run(body, FOLLOWING, 7.3, until=lambda seen: seen.time > 1.9)
    same(lc.swim(cut.scenario), cut)
    further = lc.resume(body, cut, 1.0, controller=FOLLOWING)
    same(lc.swim(further.scenario), further)


def test_what_was_measured_says_what_it_lacks():
    known = Experiment(robot=lc.load_robot("mamba"), environment=lc.load_water("paper-eel"))
    with pytest.raises(
        ValueError, match="this one lacks what decided its commands, where it began and a model"
    ):
        lc.swim(known)
    assert run_from_toml(run_to_toml(known)) == known


def test_a_law_that_nobody_here_defines_is_kept_and_only_running_it_is_refused(tmp_path):
    trial = lc.swim("mamba", GAIT, 1.0)
    model = lc.Planar(joints=JointLaw.stand_in("muscle", {"stiffness": 3.0}))
    replace(trial, scenario=replace(trial.scenario, model=model)).save(tmp_path / "run.nc")
    stored = lc.load_trial(tmp_path / "run.nc")
    assert stored.scenario.model == model and stored.settings["joints"] == "muscle"
    assert stored.forward_velocity == trial.forward_velocity
    with pytest.raises(
        ValueError, match="its `muscle` is not defined; import the module that defines it"
    ):
        lc.swim(stored.scenario)


def test_a_controller_that_nobody_here_defines_is_kept_with_its_gait():
    @dataclass(frozen=True, kw_only=True)
    class Wandering(Controller[None]):
        gait: lc.Gait
        interval: float = math.inf

    known = lc.build_scenario("mamba", Wandering(gait=GAIT))
    assert run_from_toml(run_to_toml(known)) == known
    del Controller._members["wandering"]
    stored = run_from_toml(run_to_toml(known))
    assert stored.gait == GAIT
    with pytest.raises(ValueError, match="its `wandering` is not defined"):
        lc.swim(stored)
