"""A fin of finite span in the planar model: against an unsteady vortex lattice, and in all ways of running it.

`tests/data/edge_map.csv` is the lattice's answer for a rigid rectangular plate in heave, in pitch about its root and in
both (`swim`: heave 1, slope -.6 i omega), with rho = u = h = 1 and z = Re[(a + s x) exp(i omega t)]: vortex rings,
harmonic in time, a straight wake, thrust by the energy balance in the far wake, extrapolated in the number of rings.
Its phases are those of complex amplitudes; a side force is positive along z. No law was fitted to it.
"""

import csv
from dataclasses import replace
from functools import cache
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.planar import rows
from laticauda.models.planar.model import PlanarPlant
from laticauda.robot import (
    CaudalFin,
    Joint,
    Module,
    Robot,
    Section,
    Water,
    load_robot,
    load_water,
    wake_mass,
)

MAP = Path(__file__).parents[2] / "data" / "edge_map.csv"
MOTIONS = {
    "heave": lambda omega: (1.0, 0.0),
    "pitchLE": lambda omega: (0.0, 1.0),
    "swim": lambda omega: (1.0, -0.6j * omega),
}
PHASES = 2.0 * np.pi * np.arange(16) / 16.0
GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)
WATER = replace(
    load_water("paper-lateral"), added_mass_form="kirchhoff", trailing_edge="finite-span"
)
FINNED = load_robot("mamba-fin")
BROAD = replace(
    FINNED,
    name="broad",
    caudal_fin=CaudalFin(length=0.06, height=0.2, opening_length=0.0, added_mass=1.0),
)
DRIVEN = replace(BROAD, name="driven", caudal_fin=replace(BROAD.caudal_fin, joint=Joint()))


# ---- the lattice ---------------------------------------------------------------------------------


class RigidPlate:
    """A plate of height 1 m in water of 1 kg/m^3 whose loads are those that the kernels of the package give.

    It is the fin of a robot whose only link has neither mass nor loads worth mentioning.
    """

    def __init__(self, aspect):
        self.chord = 1.0 / aspect
        fin = CaudalFin(
            length=self.chord, height=1.0, opening_length=0.0, thickness=1e-9, density=1e-3
        )
        link = Module(
            length=1e-3, mass=1e-9, inertia=1e-9, section=Section(half_height=1e-6, half_width=1e-6)
        )
        water = Water(
            density=1.0,
            tangential_friction=0.0,
            normal_drag=0.0,
            added_mass=1.0,
            added_mass_form="kirchhoff",
            trailing_edge="finite-span",
            rotational="strip",
        )
        self.plant = PlanarPlant(
            robot=Robot(name="plate", modules=(link,), caudal_fin=fin), environment=water
        )
        self.template = self.plant.layout.template
        self.body = self.template[rows.HEADER_ROWS : rows.HEADER_ROWS + rows.BODY_ROWS]
        self.distance = -self.template[rows.WAKE_POSITION]
        self.lag = self.template[rows.EDGE_LAG]
        self.instant = self.template[rows.EDGE + 4]

    def loads(self, w, turning, memory):
        """Force along, force to the left, moment about the root at u = 1, and dz/dt, without what accelerations add."""
        S = self.template.copy()
        S[rows.VX] = 1.0
        S[rows.VY] = w + turning * self.body[rows.FIRST_MOMENT_SHARE]
        S[rows.HEADING_RATE] = turning
        S[rows.EDGE_MEMORY] = memory
        layout = self.plant.layout
        chain = layout.first_strip, layout.first_plate, np.array([False])
        kernels = self.plant.kernels_of(1)
        kernels.evaluate(S, layout.n_bodies, *chain, layout.tail_link, layout.has_extras)
        b = rows.HEADER_ROWS
        moment, along, across = -S[[b + rows.P0, b + rows.P1, b + rows.P2]]
        return along, across, moment, S[rows.EDGE_MEMORY_RATE]

    def respond(self, omega, heave, slope):
        """Mean thrust, side force and moment about the root of a motion, the last two as complex amplitudes."""
        cycle = np.exp(1j * PHASES)

        def in_time(amplitude):
            return (amplitude * cycle).real

        w_root = 1j * omega * heave + slope
        turning = -1j * omega * slope
        w_edge = w_root - turning * self.distance
        memory = w_edge / (1.0 + 1j * omega * self.lag)
        arguments = zip(in_time(w_root), in_time(turning), in_time(memory), strict=True)
        along, across, moment, memory_rate = np.array([self.loads(*one) for one in arguments]).T
        np.testing.assert_allclose(memory_rate, in_time(1j * omega * memory), atol=1e-9 * omega**2)
        # What accelerations add, by the kernels' own inertia about the root.
        sway = in_time(1j * omega * w_root + turning)  # its axes turn while it swims at 1 m/s
        spin = in_time(1j * omega * turning)
        coupling = self.body[rows.COUPLING]
        across = across - self.body[rows.MASS_N] * sway - coupling * spin
        moment = moment - coupling * sway - self.body[rows.INERTIA] * spin
        thrust = np.mean(along + across * in_time(slope))
        to_amplitude = 2.0 * np.conj(cycle) / PHASES.size
        # The map's moment is about z x x, a turn to the right.
        return thrust, across @ to_amplitude, -moment @ to_amplitude


@cache
def map_errors():
    """The relative errors of thrust, side force and moment at all points of the map."""
    points = list(csv.DictReader(MAP.read_text().splitlines()))
    errors = []
    for aspect, group in groupby(points, key=lambda point: float(point["h_over_c"])):
        plate = RigidPlate(aspect)
        for point in group:
            omega = float(point["omega_h_over_u"])
            thrust, side, moment = plate.respond(omega, *MOTIONS[point["motion"]](omega))
            given_thrust = float(point["thrust_mean"])
            size = max(abs(given_thrust), 0.25 * abs(float(point["power_in_mean"])))
            errors.append(
                (
                    abs(thrust - given_thrust) / size,
                    relative_error(side, point, "side"),
                    relative_error(moment, point, "moment_LE"),
                )
            )
    return np.array(errors).T


def relative_error(value, point, name):
    size = float(point[f"{name}_amp"])
    phase = np.deg2rad(float(point[f"{name}_phase_deg"]))
    return abs(value - size * np.exp(1j * phase)) / size


def test_the_loads_of_a_rigid_plate_are_those_of_the_unsteady_lattice_on_the_whole_map():
    thrust, side, moment = map_errors()
    assert thrust.size == 252
    assert thrust.mean() <= 0.017
    assert thrust.max() <= 0.10
    assert side.mean() <= 0.013
    assert side.max() <= 0.06
    assert moment.mean() <= 0.010
    assert moment.max() <= 0.05


# ---- slender and bodies --------------------------------------------------------------------------


def test_a_body_that_ends_in_an_edge_keeps_lighthills_law_to_the_last_bit():
    robot = load_robot("amphibot")
    finite = lc.swim(robot, GAIT, duration=5.0, environment=WATER)
    elongated = lc.swim(
        robot, GAIT, duration=5.0, environment=replace(WATER, trailing_edge="elongated")
    )
    assert np.array_equal(finite.center_of_mass, elongated.center_of_mass)


def test_a_long_thin_fin_swims_as_with_lighthills_law():
    thin = replace(
        FINNED, caudal_fin=replace(FINNED.caudal_fin, height=0.01, thickness=1e-3, added_mass=10.0)
    )
    paths = [
        lc.swim(
            thin, GAIT, duration=5.0, environment=replace(WATER, trailing_edge=edge)
        ).center_of_mass
        for edge in ("finite-span", "elongated")
    ]
    assert np.abs(paths[0] - paths[1]).max() < 2e-3 * np.abs(paths[1]).max()


def test_the_strips_of_a_fin_have_the_mass_and_the_inertia_of_the_plate():
    strips = lc.models.planar.PlanarPlant(robot=BROAD, environment=WATER).coefficients.fin
    slender = wake_mass(BROAD, WATER) * 0.06
    arm = strips.position + 0.03
    assert strips.mu_n.sum() == pytest.approx(0.2543 * slender, rel=2e-3)  # h/c = 3.33
    inertia = strips.lambda_1.sum() + strips.mu_n @ (arm * arm)
    assert inertia == pytest.approx(0.10636 * slender * 0.06**2 / 12.0, rel=5e-3)


def test_a_fin_that_bends_is_refused_with_the_laws_that_hold_for_it():
    soft = replace(FINNED.caudal_fin, n_hinges=2, flexural_rigidity=2.0)
    with pytest.raises(
        ValueError,
        match=r"`trailing_edge` must be `elongated` or `none` for a fin that bends "
        r"\(`caudal_fin.n_hinges` is 2\), because the law of a finite span is that of a rigid plate",
    ):
        lc.swim(replace(FINNED, caudal_fin=soft), GAIT, environment=WATER)


def test_a_stout_body_without_a_fin_is_refused():
    stout = Robot(
        name="stout",
        modules=(Module(length=0.1, mass=1.0, section=Section(half_height=0.1, half_width=0.1)),),
    )
    with pytest.raises(
        ValueError, match=r"for a body without a fin that is not slender \(its height is 2 times"
    ):
        PlanarPlant(robot=stout, environment=WATER)


def test_a_finite_span_requires_the_form_that_conserves_momentum():
    with pytest.raises(ValueError, match=r"unless `added_mass_form` is `kirchhoff`.*'finite-span'"):
        replace(WATER, added_mass_form="relative")


# ---- ways of running -----------------------------------------------------------------------------

ROBOTS = {
    "rigid": (BROAD, GAIT),
    "driven": (DRIVEN, replace(GAIT, fin=lc.Wave(amplitude=0.4, frequency=2.5))),
}
JOINTS = ("prescribed", "pd", "servo")


@pytest.mark.parametrize("joints", JOINTS)
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_run_that_is_resumed_is_the_same_to_the_last_bit(robot, joints):
    robot, gait = ROBOTS[robot]
    plant = lc.build_plant(robot, WATER, joints=joints)
    command = lc.Command(gait=gait)
    start = plant.init(lc.Start(velocity=0.1), command)
    whole = plant.march(start, command, 2.0, 0.5)
    half = plant.march(start, command, 1.0, 0.5)
    kept = plant.unpack(plant.pack(half.state))
    assert abs(kept.values[rows.EDGE_MEMORY - rows.TIME]) > 1e-3
    rest = plant.march(kept, command, 1.0, 0.5)
    assert np.array_equal(rest.state.values, whole.state.values)


@pytest.mark.parametrize("joints", JOINTS)
def test_a_batch_is_the_single_runs(joints):
    gaits = [replace(GAIT, amplitude=amplitude) for amplitude in (0.2, 0.35, 0.5)]
    swims = lc.swim_many(BROAD, gaits, duration=4.0, environments=WATER, joints=joints)
    for k, gait in enumerate(gaits):
        single = lc.swim(BROAD, gait, duration=4.0, environment=WATER, joints=joints)
        np.testing.assert_allclose(swims.center_of_mass[k], single.center_of_mass[-1], rtol=1e-12)


def test_halving_the_step_changes_nothing_worth_mentioning():
    ends = []
    for joints, dt in (
        ("prescribed", 0.025),
        ("prescribed", 0.0125),
        ("servo", 0.002),
        ("servo", 0.001),
    ):
        trial = lc.swim(BROAD, GAIT, duration=10.0, environment=WATER, joints=joints, dt=dt)
        ends.append(trial.center_of_mass[-1])
    length = np.linalg.norm(ends[1])
    assert np.linalg.norm(ends[0] - ends[1]) < 1e-4 * length
    assert np.linalg.norm(ends[2] - ends[3]) < 1e-4 * np.linalg.norm(ends[3])


def test_a_state_that_an_older_version_stored_continues_with_an_edge_that_remembers_nothing():
    plant = lc.build_plant(BROAD, WATER)
    command = lc.Command(gait=GAIT)
    state = plant.init(lc.Start(velocity=0.1), command)
    older = np.delete(state.values, rows.EDGE_MEMORY - rows.TIME)
    assert np.array_equal(plant.unpack({"planar": older}).values, state.values)
