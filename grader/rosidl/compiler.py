"""The requirements for compiling the interface packages, and the line on what is missing.

interfaces/build.py asks before pip downloads anything. As a program (for scripts/check_setup.sh)
this prints the line, and fails.
"""

import os
import shutil
import sys
import sysconfig
from pathlib import Path


def missing() -> list[str]:
    """Return the missing compilers and headers that this Python's extension modules need."""
    found_nowhere = []
    for variable, usual in (("CC", "gcc"), ("CXX", "g++")):
        # with its first options, as in "gcc -pthread"
        command = os.environ.get(variable) or sysconfig.get_config_var(variable) or usual
        compiler = command.split()[0]
        if not shutil.which(compiler):
            found_nowhere.append(compiler)
    if not Path(sysconfig.get_path("include"), "Python.h").is_file():
        found_nowhere.append(f"Python.h of Python {sysconfig.get_python_version()}")
    return found_nowhere


def complaint() -> str | None:
    """Return a line on what is missing and how to get it; None where nothing is."""
    if not (names := missing()):
        return None
    python = f"python{sysconfig.get_python_version()}"
    return (
        f"Cannot install: missing: {', '.join(names)} "
        f"(Debian, Ubuntu: sudo apt install build-essential {python}-dev; "
        f"Fedora: sudo dnf install gcc gcc-c++ {python}-devel). "
        "Wheels need none of these: pip install 'turtlesim_py[jazzy]'."
    )


if __name__ == "__main__":
    sys.exit(complaint())
