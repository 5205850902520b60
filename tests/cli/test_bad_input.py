"""Bad input through the command line: exit status 2, one clear message that names the option, nothing done."""

import re
from pathlib import Path

import pytest

import laticauda as lc
from laticauda.robot.files import to_toml

BAD = {
    # numbers of the gait, in degrees
    "swim --amplitude-deg -3": "--amplitude-deg must be between 0 and 180 deg, got -3.",
    "swim --amplitude-deg nan": "--amplitude-deg must be a finite number in deg, got nan.",
    "swim --frequency-deg-s -1": "--frequency-deg-s must be >= 0 deg/s, got -1.",
    "swim --frequency-deg-s inf": "--frequency-deg-s must be a finite number in deg/s, got inf.",
    "swim --phase-shift-deg inf": "--phase-shift-deg must be a finite number in deg, got inf.",
    "swim --offset-deg nan": "--offset-deg must be a finite number in deg, got nan.",
    "swim --heading-deg nan": "--heading-deg must be a finite number in deg, got nan.",
    "swim --amplitude-deg x": "must be a number, got 'x'.",
    "swim --amplitude-deg": "Missing value for argument '--amplitude-deg'",
    "swim --gait eel": "--gait must be one of",
    "swim --gait custom": "--envelope must be given",
    "swim --envelope 1 1 1 1 1 1 1 1": "--envelope must be given",
    "swim --gait custom --envelope 1 2": "--envelope must have one value per joint",
    "swim --gait custom --envelope 1 2 nan 4 5 6 7 8": "--envelope must be a finite number, got nan.",
    "swim --gait custom --envelope 1 2 c": "must be a number, got 'c'.",
    # the run
    "swim --duration 0": "--duration must be > 0 s, got 0",
    "swim --duration -5": "--duration must be > 0 s, got -5",
    "swim --duration nan": "--duration must be a finite number in s, got nan.",
    "swim --sample-interval 0": "--sample-interval must be > 0 s, got 0",
    "swim --heading-deg 1e300": "--heading-deg must be between -5.72958e+06 and 5.72958e+06 deg, got 1e+300",
    "swim --duration 1e12": "--duration must be between 0 and 1e+06 s",
    "swim --tangential-friction 1e9": "its drag or friction stops one within",
    "swim --dt 0": "--dt must be between 1e-07 and 1000 s, got 0",
    "swim --dt -0.1": "--dt must be between 1e-07 and 1000 s, got -0.1",
    "swim --ramp -1": "--ramp must be >= 0 s, got -1",
    "swim --offset-bandwidth 0": "--offset-bandwidth must be > 0 1/s, got 0",
    "swim --joints servos": "--joints must be one of `prescribed`, `pd`, `servo`, "
    "`ekeberg`, `hill`, `speed-servo`, got 'servos'; did you",
    "swim --model mujoco": "--model",
    # the robot
    "swim --n-links 0": "--n-links must be a whole number >= 1, got 0.",
    "swim --n-links 2.5": "must be a whole number, got '2.5'.",
    "swim --robot mamba-modules --n-links 5": "--n-links must stay 19 for robot `mamba-modules`",
    "swim --robot mambo": "no robot preset named `mambo`; did you mean `mamba`?",
    "swim --robot nofile.toml": "nofile.toml: no such file",
    "swim --robot wrong.toml": "wrong.toml: key `lenght`: is not known",
    "swim --robot range.toml": "range.toml: key `electronics_power`: must be >= 0 W, got -3",
    "swim --robot text.toml": "text.toml: is not valid TOML",
    "swim --robot paper-eel": "no robot preset named `paper-eel`",
    # water and ground
    "swim --water mamba": "no water preset named `mamba`",
    "swim --ground paper-eel": "no ground preset named `paper-eel`",
    "swim --ground viscous --water paper-eel": "--water must not be given with --ground: it applies to water only.",
    "swim --water paper-eel --parameters mine.toml": "--parameters must not be given with --water: both define",
    "swim --ground viscous --parameters mine.toml": "--parameters must not be given with --ground",
    "swim --parameters nofile.toml": "nofile.toml: no such file",
    "swim --parameters wrong.toml": "wrong.toml: key `kind`: must be \"parameters\" here, got 'robot'",
    "follow --parameters wrong.toml": "wrong.toml: key `kind`: must be \"parameters\" here, got 'robot'",
    "swim --resume a.nc --parameters mine.toml": "--parameters must not be given with --resume",
    "swim --ground viscous --density 3": "Unrecognized options: --density",
    "swim --ground viscous --no-linear": "Unrecognized options: --no-linear",
    "swim --density 1e-300": "--density must be >= 1e-09 kg/m^3, got 1e-300",
    "swim --reference-speed 1e7": "--reference-speed must be <= 10000 m/s, got 10000000.0",
    "sweep --vary amplitude-deg=10,20 --output s3://bucket/x": "s3://bucket/x: is an address; give a path on this",
    "optimize --vary amplitude-deg=10:20 --output memory://x": "memory://x: is an address; give a path on this",
    "export web --output memory://x": "memory://x: is an address; give a path on this computer",
    "trial show s3://a/b.nc": "s3://a/b.nc: is an address; give a path on this computer",
    "swim --density 0": "--density must be > 0 kg/m^3, got 0",
    "swim --tangential-friction -1": "--tangential-friction must be >= 0, got -1",
    "swim --normal-drag nan": "--normal-drag must be a finite number, got nan.",
    "swim --added-mass -0.5": "--added-mass must be >= 0, got -0.5.",
    "swim --added-inertia -2": "--added-inertia must be >= 0, got -2",
    "swim --tangential-added-mass -2": "--tangential-added-mass must be >= 0, got -2",
    "swim --reference-speed -1": "--reference-speed must be >= 0 m/s, got -1",
    "swim --depth 0": "--depth must be > 0 m, got 0",
    "swim --depth 0.01": "--depth must be > 0.055 m",
    "swim --current 1": "--current must be two or three numbers in m/s or a Flow, got 1 of them",
    "swim --current vortx": "--current: there is no current preset named `vortx`; did you mean `vortex`?",
    "swim --current nope.toml": "--current: nope.toml: no such file",
    "swim --current text.toml": "--current: text.toml: ",
    "swim --current heigt.toml": "--current: heigt.toml: key `heigt`: is not known; did you mean `height`?",
    "swim --current behind.toml": "no.nc: cannot be read: no such file or directory.",
    "swim --current lake.toml": "lake.toml: key `source`: must be a netCDF file that holds a flow, got",
    "swim --current vortex cor=1": "--current vortex: `cor` is not known; did you mean `core`?",
    "swim --current vortex core=-1": "--current vortex: `core` must be > 0 m, got -1.",
    "swim --current vortex core": "--current must be a preset or a file and NAME=NUMBER ..., such as swell height=0.2",
    "swim --current turbulence seed=0.5": "--current turbulence: `seed` must be a whole number >= 0, got 0.5.",
    "swim --current nomodule:Flow": "--current must be a name or MODULE:CLASS, got nomodule:Flow",
    "swim --current 0.1 vortex": "--current must be a number, got 'vortex'.",
    "swim --ground viscous --current vortex": "--current",
    "sweep --current vortex --vary current-x=0,1": "got 'current-x'; the nearest are",
    "swim --current nan 0": "--current must be a finite number in m/s, got nan.",
    "swim --trailing-edge elongated": "--trailing-edge must be `none` unless --added-mass-form is `kirchhoff`",
    # laws, by name or from a module
    "swim --law nope": "--law must be one of `polynomial-drag`",
    "swim --law nomodule:Law": "--law must be a name or MODULE:CLASS, got nomodule:Law",
    "swim --law math:pi": "--law must be a name or MODULE:CLASS, got math:pi",
    "swim --law polynomial-drag --share 3": "Unrecognized options: --share",
    "swim --rotational none": "('paper', 'strip')",
    "swim --added-mass-form Relative": "('relative', 'kirchhoff', 'classic')",
    # files
    "swim --save nofolder/run.nc": "--save must be a file in a folder that exists, got nofolder/run.nc.",
    "swim --save run.txt": "--save must be a file that ends in .nc or .mcap or .parquet or .mat or .csv, got run.txt.",
    "swim --save folder.nc": "--save must be a file, got the folder folder.nc.",
    "swim --plot picture.jpg": "--plot must be a file that ends in .png or .pdf or .svg, got picture.jpg.",
    "swim --plot nofolder/p.png": "--plot must be a file in a folder that exists, got nofolder/p.png.",
    "swim --resume nofile.nc": "Cannot read nofile.nc: no such file or directory.",
    "swim --resume text.toml": "Cannot load text.toml: it is not a netCDF file",
    "swim --resume a.nc --robot mamba": "--robot must not be given with --resume",
    "swim --resume a.nc --offset-deg 0": "--offset-deg must not be given with --resume",
    "swim --resume a.nc --fps 0": "--fps must be > 0 1/s, got 0.",
    "swim --resume a.nc --sample_interval -1": "--sample-interval must be > 0 s, got -1.",
    "swim --resume a.nc --frames-per-second 3": "--frames-per-second must not be given with --resume",
    "swim --resume a.nc --link-forces": "--link-forces must not be given with --resume",
    # words
    "swim --amplitud-deg 3": "--amplitude-deg deg",
    "swim --trailing-egde none": "--trailing-edge {none,elongated,finite-span}",
    "swim extra": "there is neither a robot nor a file 'extra'; `laticauda robots` lists them",
    "swimm": "there is no command `swimm`; did you mean `swim`?",
    "": "Try first:  laticauda swim mamba",
    "--versio": "Unrecognized options: --versio",
    "robots nope": "NAME must be one of `amphibot`, `chain`, `mamba`,",
    "robots paper-eal": "got 'paper-eal'; did you mean `paper-eel`?",
    "robots nope.toml": "nope.toml: no such file",
    "robots --toml": "--toml must be given with the NAME to print.",
    "robots mamba --toml --json": "--toml must not be given together with --json.",
    "import": "`laticauda import` has one command, farms; `laticauda import farms --help` explains it.",
    "import frams a.yaml": "`laticauda import` has one command, farms;",
    "import farms nofile.yaml": "nofile.yaml: no such file",
    "import farms text.toml": "text.toml: must be an animat of FARMS, a file that ends in .yaml",
    "trial": "Expected one of {show, compare, plot, convert}.",
    "trial shwo a.nc": "Available subcommands: show, compare, plot, convert",
    "trial show": "Missing from laticauda trial show",
    "trial show nofile.nc": "Cannot read nofile.nc: no such file or directory.",
    "trial show text.toml": "Cannot load text.toml: it is not a netCDF file",
    "trial compare": "FILES must hold at least 2 trials to compare, got 0.",
    "trial compare nofile.nc a.nc": "Cannot read nofile.nc",
    "trial convert a.nc out.xlsx": "OUTPUT must be a file that ends in .nc or .mcap or .parquet or .mat or .csv, got",
    "trial convert a.nc nofolder/out.csv": "OUTPUT must be a file in a folder that exists, got nofolder/out.csv.",
    "trial convert text.toml out.csv": "Cannot load text.toml",
}


@pytest.fixture
def with_files(folder: Path) -> Path:
    start = 'kind = "robot"\nextends = "mamba"\nname = "x"\n'
    (folder / "wrong.toml").write_text(start + "lenght = 3\n")
    (folder / "range.toml").write_text(start + "electronics_power = -3\n")
    (folder / "text.toml").write_text("hello\n")
    (folder / "heigt.toml").write_text('kind = "waves"\nheigt = 0.1\n')
    (folder / "behind.toml").write_text('kind = "wake-of-trial"\nsource = "no.nc"\n')
    (folder / "lake.toml").write_text('kind = "gridded"\nsource = "no.nc"\n')
    (folder / "folder.nc").mkdir()
    return folder


@pytest.mark.parametrize("line", BAD)
def test_bad_input_is_refused_with_a_message(run, with_files, line):
    before = sorted(with_files.iterdir())
    done = run(line)
    assert done.status == 2
    assert done.out == ""
    # tyro breaks its lines inside a frame
    message = " ".join(part.strip("│ ") for part in done.err.splitlines())
    assert BAD[line] in message
    assert "Traceback" not in done.err and "?." not in message and "[Errno" not in message
    assert sorted(with_files.iterdir()) == before


@pytest.mark.parametrize("option", ["--save run.nc", "--plot run.png"])
def test_a_folder_without_permission_is_refused_before_the_run(run, monkeypatch, option):
    monkeypatch.setattr("laticauda.cli.output_files.os.access", lambda path, mode: False)
    monkeypatch.setattr(
        "laticauda.models.simulate.swim", lambda *args, **settings: pytest.fail("it swam")
    )
    done = run(f"swim {option}")
    assert done.status == 2
    assert "must be a writable file, got run" in done.err


@pytest.mark.parametrize("flag", ["--robot heavy.toml", "--robot=heavy.toml"])
def test_what_cannot_be_in_a_robot_file_is_named_with_the_file_and_the_key(run, folder, flag):
    text = to_toml(lc.load_robot("mamba-fin"))
    (folder / "heavy.toml").write_text(re.sub(r"(?m)^mass = .*$", "mass = 800.0", text))
    done = run(f"swim --duration 1 {flag}")
    assert done.status == 2
    assert re.search(
        r"laticauda: heavy\.toml: `modules\[0\]\.mass` must be between .* got 800", done.err
    )
