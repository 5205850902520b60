import json

import pytest

import laticauda as lc
from laticauda.cli import main

mujoco = pytest.importorskip("mujoco")


def test_an_exported_mjcf_file_opens_in_mujoco(run, folder):
    done = run(
        "export mjcf --output robot.xml --robot mamba-modules-fin --scene tank --actuators servo"
    )
    assert (done.status, done.err) == (0, "")
    assert done.out.startswith("robot.xml: mamba-modules-fin, 19 modules, 14.855 kg, 1.71 m (")
    model = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    assert (model.nu, model.nv) == (18, 24)
    assert model.geom("floor").pos[2] == -1.5


def test_an_exported_urdf_file_opens_in_mujoco(run, folder):
    done = run("export urdf --output robot.urdf --robot mamba-fin --json")
    assert json.loads(done.out) == {
        "output": "robot.urdf",
        "robot": "mamba-fin",
        "n_links": 9,
        "mass": lc.load_robot("mamba-fin").mass,
        "length": lc.load_robot("mamba-fin").length,
    }
    assert mujoco.MjModel.from_xml_path(str(folder / "robot.urdf")).nv == 8


def test_a_robot_on_the_ground_is_exported_with_the_ground(run, folder):
    assert (
        run(
            "export mjcf --output robot.xml --ground coulomb --root planar --n-links 5 --robot chain"
        ).status
        == 0
    )
    model = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    assert model.geom("ground").type[0] == mujoco.mjtGeom.mjGEOM_PLANE
    assert model.nv == 3 + 4


def test_an_exported_fmu_swims_in_fmpy_as_the_command_swims(run, folder):
    fmpy = pytest.importorskip("fmpy", exc_type=ImportError)
    done = run(
        "export fmu --output robot.fmu --robot mamba-fin --gait eel-like --normal-drag 1.5 --heading-deg 90"
    )
    assert done.status == 0
    assert done.out.startswith("robot.fmu: mamba-fin, 84 parameters, 6 inputs, 53 outputs (")
    seen = fmpy.simulate_fmu(str(folder / "robot.fmu"), stop_time=5.0, output_interval=0.05)
    options = "--robot mamba-fin --gait eel-like --normal-drag 1.5 --heading-deg 90 --duration 5"
    assert run(f"swim {options} --save run.nc").status == 0
    trial = lc.load_trial(folder / "run.nc")
    assert seen["center_of_mass.y"] == pytest.approx(trial.center_of_mass[:, 1], abs=1e-9)


def test_an_exported_fmu_takes_parameters_and_references(run, folder):
    done = run(
        "export fmu --output robot.fmu --parameters mamba-identified --joints servo --inputs references --fmi 3.0 "
        "--json"
    )
    assert json.loads(done.out) == {
        "output": "robot.fmu",
        "robot": "mamba",
        "n_links": 9,
        "mass": lc.load_robot("mamba").mass,
        "length": lc.load_robot("mamba").length,
        "n_parameters": 138,
        "n_inputs": 10,
        "n_outputs": 55,
    }


def test_a_library_in_c_is_written_beside_its_header(run, folder):
    done = run(
        "export c --output robot.h --robot mamba-fin --heading-deg 90 --joints servo --inputs references --static "
        "--json"
    )
    assert json.loads(done.out)["n_inputs"] == 10
    assert sorted(file.name for file in folder.iterdir()) == ["librobot.a", "robot.h"]
    assert "double references[8];" in (folder / "robot.h").read_text()


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "export mjcf --output robot.txt",
            "--output must be a file that ends in .xml, got robot.txt.",
        ),
        (
            "export urdf --output robot.xml",
            "--output must be a file that ends in .urdf, got robot.xml.",
        ),
        (
            "export mjcf --output no/robot.xml",
            "--output must be a file in a folder that exists, got no/robot.xml.",
        ),
        (
            "export mjcf --output robot.xml --ground coulomb --scene tank",
            "--scene must not be `tank` without water, got",
        ),
        (
            "export mjcf --output robot.xml --ground coulomb --water paper-eel",
            "--water must not be given with --ground.",
        ),
        (
            "export urdf --output robot.urdf --meshes a.stl",
            "--meshes must be one file per module (9) or none, got 1.",
        ),
        (
            "export mjcf --output robot.xml --meshes a.stl",
            "--meshes must be one file per module (9) or none, got 1.",
        ),
        ("export mjcf --output robot.xml --root fixed", "('free', 'planar')"),
        ("export mjcf --output robot.xml --robot mambo", "did you mean"),
        ("export fmu", "Missing from laticauda export fmu"),
        (
            "export fmu --output robot.zip",
            "--output must be a file that ends in .fmu, got robot.zip.",
        ),
        (
            "export fmu --output robot.fmu --ground coulomb",
            "--ground must not be given: the exported robot swims in water.",
        ),
        (
            "export fmu --output robot.fmu --model spatial",
            "--model must be `planar`: the spatial model needs MuJoCo",
        ),
        (
            "export fmu --output robot.fmu --joints prescribed --inputs references",
            "--inputs must be 'gait' for prescribed joints, which cannot jump",
        ),
        (
            "export fmu --output robot.fmu --platform linux64,vax",
            "--platform must be one of `linux64`, ",
        ),
        ("export c --output robot.c", "--output must be a file that ends in .h, got robot.c."),
        ("export c --output robot.h --platform vax", "--platform must be one of `linux64`, "),
        ("export fmu --output robot.fmu --normal-drag -1", "--normal-drag must be >= 0, got -1"),
        ("export", "Expected one of {mjcf, urdf, fmu, c, web}."),
    ],
)
def test_bad_input_is_refused_by_name(run, folder, line, message):
    done = run(line)
    assert done.status == 2
    assert message in " ".join(done.err.replace("│", " ").split())
    assert not list(folder.iterdir())


def test_a_page_without_places_to_show_is_refused(tmp_path, capsys):
    scenario = tmp_path / "swim.toml"
    assert main(["swim", "mamba", "--duration", "1", "--save-scenario", str(scenario)]) == 0
    capsys.readouterr()
    page = str(tmp_path / "page")
    assert main(["export", "web", "--output", page, "--places", str(scenario)]) == 2
    assert "--places must be a scenario with places, got" in capsys.readouterr().err
