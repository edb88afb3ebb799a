#!/usr/bin/env python3
"""Install a wheel into a bare Python, use it, and print the seconds of each step.

    scripts/try_wheel.py PYTHON WHEEL

In an empty environment made with PYTHON, without a compiler: the wheel and what it requires from
the package index, then turtlesim_node until it is up, tf2, then the reference controller, graded.
"""

import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

REFERENCE = "import turtlesim_challenge as c; print(c.__path__[0] + '/turtle_controller.py')"
# what a shell with ROS, or a Python with the ROS wheels, has left
LEFT_OUT = ("AMENT_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")


def bare(venv: Path) -> dict[str, str]:
    """An environment that finds the programs of `venv` and no others, so no compiler either."""
    env = {name: value for name, value in os.environ.items() if name not in LEFT_OUT}
    return env | {"PATH": str(venv / "bin"), "CC": "/nonexistent", "CXX": "/nonexistent"}


@contextmanager
def step(name: str) -> Iterator[None]:
    """Print how long a step took: by the clock, and in processor time."""
    clock, work = time.monotonic(), _cpu_s()
    yield
    seconds = time.monotonic() - clock
    print(f"   {name}: {seconds:.1f} s ({_cpu_s() - work:.1f} s of processor time)", flush=True)


def _cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def call(*command: str | Path, env: dict[str, str], cwd: Path) -> str:
    """Run a command to its end, and return its output; if it fails, exit with all of it."""
    done = subprocess.run(command, env=env, cwd=cwd, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{done.stdout}{done.stderr}\nfailed: {' '.join(map(str, command))}")
    return done.stdout


def start_and_stop(program: Path, env: dict[str, str], cwd: Path) -> None:
    """Run the simulator until it prints that it is up, and end it as Ctrl-C does."""
    process = subprocess.Popen([program], env=env, cwd=cwd, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    output = ""
    for line in process.stderr:
        output += line
        if "Starting turtlesim" in line:
            process.send_signal(signal.SIGINT)
    if process.wait() != 0 or "Starting turtlesim" not in output:
        sys.exit(f"{output}\nfailed: {program}")


def main() -> None:
    """All steps, in a folder that is gone afterwards."""
    python, wheel = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        programs = folder / "venv" / "bin"
        env = bare(folder / "venv")
        with step("an empty environment"):
            call(python, "-m", "venv", folder / "venv", env=env, cwd=folder)
        with step("pip install, nothing in its cache"):
            pip = [programs / "python", "-m", "pip", "install", "--no-cache-dir"]
            call(*pip, Path(wheel).resolve(), env=env, cwd=folder)
        with step("turtlesim_node, up and down again"):
            start_and_stop(programs / "turtlesim_node", env, folder)
        with step("tf2_ros, imported"):
            call(programs / "python", "-c", "import tf2_ros", env=env, cwd=folder)
        with step("grader run, the reference"):
            reference = call(programs / "python", "-c", REFERENCE, env=env, cwd=folder).strip()
            run = [programs / "grader", "run", reference, "--out", folder / "graded"]
            call(*run, "--fail-under", "100", env=env, cwd=folder)


if __name__ == "__main__":
    main()
