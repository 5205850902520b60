"""Does water attach to models that others wrote, and is what it refuses refused with a way out that works?

Question: of all MJCF files in a folder, or in the packages `mujoco`, `gymnasium` and `dm_control`
where they are installed, on how many does the water act in one line, `attach(file)`?

    python campaigns/zoo.py                        # the table, from zoo.csv
    python campaigns/zoo.py --run                  # every model anew, some minutes of one core; writes zoo.csv
    python campaigns/zoo.py --run --folder models  # those of a folder and what is below it; writes nothing
    python campaigns/zoo.py --one model.xml        # one model

Verdicts: `runs`; `warned` (runs, with a warning); `cured` (refused, and runs once what the message
names is changed); `nothing to wet` (refused: nothing that moves has a volume); `unstable` (its
numbers leave the finite range in water, though not without); `wrong` (a dead end or a traceback);
`not loaded` (MuJoCo itself refuses); `late` (no answer in time). Each model has a process of its own.

What is unstable, and why:

- `testdata/model.xml`: not by the water's loads, but by a contact. Its head, a fifth as heavy as water,
  shoots up at 2 m/s into a leaf of 0.2 g and 0.2 mm, whose soft contacts give way by a hundred times its
  thickness. Without the leaf's contacts, without buoyancy, afloat at a surface 1 m high, or with steps of
  0.1 ms it is stable; with no drag, no added mass, `implicit_drag` or another integrator it is not.
- `fruitfly_v2`: in centimeters and grams (gravity 981), where 1000 is a thousand times water's density;
  `attach` warns of it, and `density` has to be 1.
"""

import argparse
import csv
import json
import re
import subprocess
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import mujoco
import numpy as np

from laticauda.values import BadArgument
from laticauda.water import mujoco as water

STORED = Path(__file__).with_suffix(".csv")
PACKAGES = ("mujoco", "gymnasium", "dm_control")
SWUM = 1.0
"""Time that every model spends in water [s]."""
LONGEST = 10.0
"""Time after which a model's swim is cut short [s]."""
SMALL_STEP = 0.05
"""Share of its own step with which an unstable model is tried again [-]."""
PATIENCE = 90.0
"""Time after which a model counts as late [s]."""


class Answer(NamedTuple):
    """What became of one model."""

    package: str
    model: str
    verdict: str
    detail: str


def cure_solver(model: Any) -> None:
    """Use the solver that the message names."""
    model.opt.solver = mujoco.mjtSolver.mjSOL_NEWTON


def cure_sleep(model: Any) -> None:
    """Let no body sleep."""
    model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)


def cure_tendons(model: Any) -> None:
    """Take the armature from the tendons."""
    model.tendon_armature[:] = 0.0


def cure_integrator(model: Any) -> None:
    """Use an integrator that the message names."""
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST


CURES: dict[str, Callable[[Any], None]] = {
    "must have the solver Newton or CG": cure_solver,
    "must have no sleeping bodies": cure_sleep,
    "must have no tendons with armature": cure_tendons,
    "must have one of the integrators": cure_integrator,
}
"""What a message asks for, by its first words."""
NOTHING_TO_WET = "must have a geom with a volume on a body that can move"


def stays_finite(model: Any) -> bool:
    """Swim, and return whether all numbers stay finite."""
    data = mujoco.MjData(model)
    begin = time.monotonic()
    while data.time < SWUM and time.monotonic() < begin + LONGEST:
        mujoco.mj_step(model, data)
        bad = sum(warning.number for warning in data.warning[4:])
        if bad or not np.all(np.isfinite(data.qpos)):
            return False
    return True


def attach(model: Any) -> tuple[str, list[str], Any]:
    """Attach water; return why it was refused ("": it was not), what was warned of, and the handle."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            handle = water.attach(model)
        except BadArgument as error:
            return str(error), [], None
    return "", [str(one.message) for one in caught], handle


def judge(path: Path) -> tuple[str, str]:
    """Return the verdict on a file, and what was said."""
    try:
        dry = mujoco.MjSpec.from_file(str(path)).compile()
    except Exception as error:  # whatever MuJoCo raises
        return "not loaded", " ".join(str(error).split())[:160]
    if dry.nv == 0:
        return "nothing to wet", "nothing moves"
    refusal, warned, handle = attach(path)
    first_refusal = refusal
    model = None
    while refusal:
        if NOTHING_TO_WET in refusal:
            return "nothing to wet", refusal
        cures = [cure for words, cure in CURES.items() if words in refusal]
        if not cures:
            return "wrong", f"no way out: {refusal}"
        if model is None:
            model = water.compile_spec(mujoco.MjSpec.from_file(str(path)))
        cures[0](model)
        again, warned, handle = attach(model)
        if again == refusal:
            return "wrong", f"the way out does not work: {refusal}"
        refusal = again
    if not stays_finite(handle.model()):
        if not stays_finite(dry):
            return "runs", "unstable without water, too"
        for message in warned:
            limit = re.search(r"steps are stable up to ([\d.e-]+) s", message)
            if limit:
                handle.model().opt.timestep = 0.5 * float(limit[1])
                if stays_finite(handle.model()):
                    return "cured", message
                return "unstable", message
        handle.model().opt.timestep = SMALL_STEP * dry.opt.timestep
        detail = "; ".join(warned)[:300]
        if stays_finite(handle.model()):
            detail = f"stable with a step of {handle.model().opt.timestep:g} s; {detail}"
        return "unstable", detail
    if first_refusal:
        return "cured", first_refusal
    if warned:
        return "warned", "; ".join(warned)[:300]
    return "runs", ""


def judge_in_a_process(package: str, root: Path, path: Path) -> Answer:
    """Judge a file in a process of its own: MuJoCo ends the process where it meets an error."""
    name = path.relative_to(root).as_posix()
    command = [sys.executable, __file__, "--one", str(path)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return Answer(package, name, "late", f"no answer in {PATIENCE:g} s")
    lines = done.stdout.strip().splitlines()
    if done.returncode != 0 or not lines:
        problem = done.stderr.strip().splitlines()[-1:] or ["no words"]
        return Answer(package, name, "wrong", f"exit {done.returncode}: {problem[0]}")
    verdict, detail = json.loads(lines[-1])
    # No paths of this machine.
    return Answer(package, name, verdict, detail.replace(str(root), "").replace("\n", " "))


def folders_of_packages() -> Iterator[tuple[str, Path]]:
    """Return the packages with models that are installed, and their folders."""
    for package in PACKAGES:
        found = find_spec(package)
        if found is not None and found.submodule_search_locations:
            yield package, Path(found.submodule_search_locations[0])


def is_model(path: Path) -> bool:
    """Return whether a file is a model, and not a part that others include."""
    text = path.read_text(encoding="utf-8", errors="replace")
    return "<mujoco" in text and "<worldbody" in text


def judge_folder(package: str, root: Path) -> list[Answer]:
    """Judge all models of a folder."""
    answers: list[Answer] = []
    for path in sorted(root.rglob("*.xml")):
        if is_model(path):
            answer = judge_in_a_process(package, root, path)
            print(*answer, sep=" | ", flush=True)
            answers.append(answer)
    return answers


def stored() -> list[Answer]:
    """Return the last answer."""
    with STORED.open(encoding="utf-8", newline="") as file:
        return [Answer(**row) for row in csv.DictReader(file)]


def table(answers: list[Answer]) -> str:
    """Return how many models of which package have which verdict."""
    verdicts = sorted({answer.verdict for answer in answers})
    lines = ["| package | models | " + " | ".join(verdicts) + " |"]
    lines.append("|---" * (2 + len(verdicts)) + "|")
    for package in sorted({answer.package for answer in answers}):
        counts = Counter(answer.verdict for answer in answers if answer.package == package)
        cells = [package, str(counts.total()), *(str(counts[verdict]) for verdict in verdicts)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--one", type=Path)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(judge(arguments.one)))
        return
    if not arguments.run:
        print(table(stored()))
        return
    answers: list[Answer] = []
    if arguments.folder:
        answers += judge_folder(arguments.folder.name, arguments.folder)
    else:
        for package, root in folders_of_packages():
            answers += judge_folder(package, root)
        with STORED.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(Answer._fields)
            writer.writerows(answers)
    print(table(answers))


if __name__ == "__main__":
    main()
