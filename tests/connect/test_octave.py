"""The client in real GNU Octave, against the numbers of Python."""

import functools
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.connect import Server, clients_folder
from laticauda.control import HeadingController, LineOfSight, PathFollowing, StraightLine
from laticauda.models.simulate import build_plant, run
from laticauda.motion.gaits.gait import FIRST_GAIT
from laticauda.scenarios.interfaces import Start


@functools.cache
def why_not() -> str:
    """Why Octave cannot be asked; "" if it can."""
    if shutil.which("octave-cli") is None:
        return "GNU Octave is not installed (octave)"
    done = subprocess.run(
        [
            "octave-cli",
            "--quiet",
            "--eval",
            "pkg load instrument-control; jsonencode (1); tcpclient;",
        ],
        capture_output=True,
        text=True,
        timeout=60,
    )
    return (
        "its package is not installed (octave-instrument-control)"
        if "not installed" in done.stderr
        else ""
    )


@pytest.fixture
def octave(server, tmp_path):
    if why_not():
        pytest.skip(why_not())

    def octave(code: str, *more: str, port: int = server.port) -> str:
        script = tmp_path / "script.m"
        words = ", ".join(("'127.0.0.1'", str(port), "30", *more))
        head = f"addpath ('{clients_folder() / 'matlab'}');\nclient = laticauda_client ({words});\n"
        script.write_text(head + code, encoding="utf-8")
        words = ["octave-cli", "--quiet", "--no-init-file", str(script)]
        done = subprocess.run(words, capture_output=True, text=True, timeout=120)
        assert "ended well" in done.stdout, done.stdout + done.stderr
        return done.stdout.replace("ended well\n", "")

    return octave


def test_twenty_trials_swept_from_octave_are_pythons_to_printed_precision(octave):
    out = octave(
        """
        [amplitude, frequency, velocity, power] = laticauda_sweep (client);
        printf ('%.15g %.15g %.9g %.9g\\n', [amplitude, frequency, velocity, power]');
        disp ('ended well')
        """
    )
    rows = [line.split() for line in out.splitlines()]
    assert len(rows) == 20
    robot, phase_shift = lc.load_robot("mamba"), np.deg2rad(40.0)
    for amplitude, frequency, velocity, power in rows:
        gait = lc.lateral_undulation(
            amplitude=float(amplitude), frequency=float(frequency), phase_shift=phase_shift
        )
        trial = lc.swim(robot, gait, duration=30.0)
        assert (velocity, power) == (f"{trial.forward_velocity:.9g}", f"{trial.mean_power:.9g}")


def test_a_path_is_followed_from_octave_as_by_our_own_controller(octave):
    out = octave(
        """
        [time, position, heading] = laticauda_follow (client, 30, [0, 0.5]);
        printf ('%.15g %.15g %.15g %.15g\\n', [time, position, heading]');
        disp ('ended well')
        """
    )
    found = np.loadtxt(out.splitlines())
    gait = lc.lateral_undulation(
        amplitude=np.deg2rad(30), frequency=np.deg2rad(90), phase_shift=np.deg2rad(40)
    )
    controller = PathFollowing(
        gait=gait,
        path=StraightLine(),
        guidance=LineOfSight(look_ahead_distance=0.18),
        heading=HeadingController(gain=0.4, max_offset=np.deg2rad(20)),
        interval=0.05,
    )
    body = build_plant(lc.load_robot("mamba-fin"), lc.load_water("paper-lateral"))
    trial = run(body, controller, 30.0, start=Start(center_of_mass=(0.0, 0.5)))
    np.testing.assert_allclose(found[:, 0], trial.time, atol=1e-9)
    np.testing.assert_allclose(found[:, 1:3], trial.center_of_mass, atol=1e-9)
    np.testing.assert_allclose(found[:, 3], trial.heading, atol=1e-9)
    assert abs(found[-1, 2]) < 0.1  # it came to the path


def test_the_other_requests_and_the_errors_reach_octave(octave):
    out = octave(
        """
        client.reset (struct ('joints', 'servo', 'sample_interval', 0.01));
        reply = client.change (struct ('references', 0.1 * ones (1, 8), 'enabled', true (1, 8)));
        reply = client.step (0.05);
        printf ('%g ', reply.joint_angle_ref); printf ('\\n');
        reply = client.look (struct ('series', {{'time', 'joint_torque'}}));
        printf ('%d ', size (reply.series.joint_torque)); printf ('\\n');
        try
          client.step (-1);
        catch problem
          printf ('%s: %s\\n', problem.identifier, problem.message);
        end
        reply = client.run (60, struct ('series', {{'joint_angle'}}));
        printf ('%d ', size (reply.series.joint_angle)); printf ('\\n');
        client.close ();
        disp ('ended well')
        """
    )
    assert [line.strip() for line in out.splitlines()] == [
        "0.1 0.1 0.1 0.1 0.1 0.1 0.1 0.1",
        "6 8",
        "laticauda:refused: `duration` must be > 0 s, got -1.",
        "1201 8",
    ]


def test_a_robot_swims_in_a_flow_that_octave_says_as_in_one_that_python_says(octave):
    flow = replace(lc.load_current("turbulence"), modes=6, evolution=0.0, seed=3)
    trial = lc.swim("mamba", FIRST_GAIT, 2.0, current=flow)
    x, y = trial.center_of_mass[-1].tolist()
    out = octave(
        """
        flow = struct ('kind', 'turbulence', 'modes', 6, 'mean', [0.1, 0, 0], 'seed', 3);
        client.reset (struct ('robot', 'mamba', 'current', flow));
        reply = client.step (2);
        printf ('%.12g ', reply.observation.center_of_mass); printf ('\\n');
        reply = client.change (struct ('current', 'turbulence'));
        printf ('%s %d\\n', reply.command.current.kind, reply.command.current.modes);
        disp ('ended well')
        """
    )
    assert [line.strip() for line in out.splitlines()] == [f"{x:.12g} {y:.12g}", "turbulence 32"]


def test_octave_shows_the_token_and_a_server_for_others_hears_nobody_without(octave):
    with Server("0.0.0.0", 0) as public:
        code = """
            try
              client.reset (); disp ('answered')
            catch err
              disp (err.message)
            end
            disp ('ended well')
        """
        assert octave(code, f"'{public.access.token}'", port=public.port) == "answered\n"
        assert octave(code, "''", port=public.port).startswith(
            "The first message must hold the `token`"
        )
