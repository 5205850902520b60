"""Is every shape right in every call, and does every example run by itself?

Question: `make test` checks the shapes of the first calls of a function in each test, and of every
call whose number is a power of two; and it runs the examples in a process that has loaded all they
need. Does anything fail if every call is checked, and every example is a program of its own, for
which warnings are errors from its first import on?

    python campaigns/every_check.py                # all tests
    python campaigns/every_check.py tests/tank/lab -x   # some; what follows is for pytest

It takes about twice as long as `make test`.
"""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
PARALLEL = ("-n", "3", "--dist", "worksteal")


def main(arguments: list[str]) -> int:
    """Run pytest and return its exit status."""
    environment = {**os.environ, "LATICAUDA_CHECKS": "all", "LATICAUDA_EXAMPLES": "alone"}
    command = [sys.executable, "-m", "pytest", *PARALLEL, *arguments]
    return subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
