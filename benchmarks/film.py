"""What a film costs: 30 s of swimming at 640 x 360, 901 pictures; wall time and processor time, ffmpeg's included.

python benchmarks/film.py                          # this version
python benchmarks/film.py --against ../old/src     # and another one's sources, in turns in the same run: the ratio
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from _timing import print_load

FILM = """
import math, resource, sys, time
import laticauda as lc

gait = lc.eel_like(amplitude=math.radians(30), frequency=math.radians(110), phase_shift=math.radians(40))
trial = lc.swim(lc.load_robot("mamba-modules-fin"), gait, duration=float(sys.argv[2]))
try:
    from laticauda.show.pictures import Film, render_film
except ImportError:  # as it was in 0.2
    from laticauda.pictures.camera import Film
    from laticauda.pictures.render import video as render_film

def processor():
    who = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
    return sum(used.ru_utime + used.ru_stime for used in map(resource.getrusage, who))

began = time.perf_counter(), processor()
render_film(trial, sys.argv[1], Film(size=(640, 360)))
print(time.perf_counter() - began[0], processor() - began[1])
"""


def filmed(sources: str, duration: float) -> tuple[float, float]:
    """Wall time and processor time of one film [s]."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-c", FILM, str(Path(folder) / "film.mp4"), str(duration)]
        done = subprocess.run(
            words, env={**os.environ, "PYTHONPATH": sources}, capture_output=True, text=True
        )
        if done.returncode:
            sys.exit(done.stderr)
        wall, processor = map(float, done.stdout.split()[-2:])
        return wall, processor


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--against", metavar="SRC")
    parser.add_argument("--duration", type=float, default=30.0)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    trees = {
        "now": str(Path(__file__).parents[1] / "src"),
        **({"before": options.against} if options.against else {}),
    }
    best = {name: (float("inf"), float("inf")) for name in trees}
    for _ in range(options.repeats):
        for name, sources in trees.items():
            best[name] = tuple(map(min, best[name], filmed(sources, options.duration)))
    for name, (wall, processor) in best.items():
        print(
            f"{name:8s} {wall:6.1f} s wall, {processor:6.1f} s of processor, for {options.duration:g} s of swimming"
        )
    if "before" in best:
        shares = [
            100.0 * now / before for now, before in zip(best["now"], best["before"], strict=True)
        ]
        print(f"now / before: {shares[0]:.0f} % wall, {shares[1]:.0f} % processor")
    print_load()


if __name__ == "__main__":
    main()
