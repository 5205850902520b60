"""How long does `laticauda swim` take from the shell, and `import laticauda`?

Question: under 2.5 s once the compiled code is cached, under 20 s the very first time; the import
under 0.4 s. Ratios are to an empty Python process in the same call.

Last answer (2 shared cores, AMD EPYC, 2026-11-21):
    python -c pass                          0.01 s
    import laticauda                        0.02 s
    laticauda swim, nothing compiled        9    s (12 s on a busy machine)
    laticauda swim, compiled                0.80 s
    laticauda --help                        0.12 s (import tyro: 0.10 s)
"""

import os
import subprocess
import sys
import tempfile
import time

SWIM = ["swim", "--gait", "lateral-undulation", "--amplitude-deg", "30", "--frequency-deg-s", "130"]


def wall(command: list[str], runs: int, **environment: str) -> float:
    """Median wall time of a command [s]."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True, env={**os.environ, **environment})
        times.append(time.perf_counter() - start)
    return sorted(times)[runs // 2]


def main() -> None:
    """Print the table."""
    program = "from laticauda.cli import main; main()"
    empty = wall([sys.executable, "-c", "pass"], 7)
    swim = [sys.executable, "-c", program, *SWIM]
    rows = [
        ("python -c pass", empty),
        ("import laticauda", wall([sys.executable, "-c", "import laticauda"], 7)),
    ]
    with tempfile.TemporaryDirectory() as folder:
        rows.append(("laticauda swim, nothing compiled", wall(swim, 1, NUMBA_CACHE_DIR=folder)))
        rows.append(("laticauda swim, compiled", wall(swim, 5, NUMBA_CACHE_DIR=folder)))
    rows.append(("laticauda --help", wall([sys.executable, "-c", program, "--help"], 5)))
    print(f"{'command':<36}{'time [s]':>10}{'/ empty':>10}")
    for name, seconds in rows:
        print(f"{name:<36}{seconds:>10.2f}{f'x{seconds / empty:.0f}':>10}")


if __name__ == "__main__":
    main()
