import subprocess
import sys

from laticauda.cli import main


def test_python_runs_the_package_as_the_command_line(capsys):
    done = subprocess.run(
        [sys.executable, "-m", "laticauda", "robots"], capture_output=True, text=True, check=True
    )
    assert main(["robots"]) == 0
    assert done.stdout == capsys.readouterr().out
    assert "mamba" in done.stdout


def test_its_exit_status_is_the_commands():
    done = subprocess.run(
        [sys.executable, "-m", "laticauda", "nosuch"], capture_output=True, text=True
    )
    assert done.returncode == 2 and "nosuch" in done.stderr
