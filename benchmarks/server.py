"""How many round trips per second does the server make?

Question: can a controller on the other side of a socket run far faster than the 20 Hz of a control
loop? Every request is a step of 0.05 s of Mamba in the plane, with another offset; server and
client share this machine. From Octave, if it is installed with its package instrument-control.
"""

import itertools
import json
import shutil
import socket
import subprocess
import time

from _timing import print_load

from laticauda.connect import Server, clients_folder

COUNT = 500
OCTAVE = """
addpath ('{folder}');
client = laticauda_client ('127.0.0.1', {port}, 30);
client.reset (struct ('joints', '{joints}'));
client.step (0.05);
tic;
for i = 1:{count}, client.step (0.05, struct ('offset', 0.01 * mod (i, 10))); end
printf ('%g\\n', {count} / toc);
"""


def from_python(port: int, joints: str) -> float:
    """Round trips per second of a client of standard Python."""
    with socket.create_connection(("127.0.0.1", port)) as wire, wire.makefile("rwb") as stream:

        def ask(**message: object) -> object:
            stream.write(json.dumps(message).encode() + b"\n")
            stream.flush()
            return json.loads(stream.readline())

        ask(do="reset", joints=joints)
        ask(do="step", duration=0.05)
        begun = time.perf_counter()
        for offset in itertools.islice(itertools.cycle(0.01 * i for i in range(10)), COUNT):
            ask(do="step", duration=0.05, offset=offset)
        return COUNT / (time.perf_counter() - begun)


def from_octave(port: int, joints: str) -> float | None:
    """The same of Octave; None where it is not installed."""
    if shutil.which("octave-cli") is None:
        return None
    code = OCTAVE.format(folder=clients_folder() / "matlab", port=port, joints=joints, count=COUNT)
    process = subprocess.run(
        ["octave-cli", "--quiet", "--eval", code], capture_output=True, text=True, timeout=300
    )
    try:
        return float(process.stdout)
    except ValueError:
        return None


def main() -> None:
    """Print the table."""
    print_load()
    print(f"{'joints':<12}{'from Python [1/s]':>20}{'from Octave [1/s]':>20}")
    with Server(port=0) as server:
        for joints in ("prescribed", "servo"):
            octave = "not installed"
            rate_of_octave = from_octave(server.port, joints)
            if rate_of_octave is not None:
                octave = f"{rate_of_octave:.0f}"
            print(f"{joints:<12}{from_python(server.port, joints):>20.0f}{octave:>20}")


if __name__ == "__main__":
    main()
