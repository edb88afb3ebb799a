"""The requirements for compiling interfaces.

As a program (for scripts/install.sh and scripts/release.sh) this prints what is missing, and fails.
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


def main() -> int:
    """Print what is missing and how to get it; return 1 where something is."""
    if not (names := missing()):
        return 0
    python = f"python{sysconfig.get_python_version()}"
    print(
        f"missing: {', '.join(names)} (Debian, Ubuntu: sudo apt install build-essential "
        f"{python}-dev; Fedora: sudo dnf install gcc gcc-c++ {python}-devel)"
    )
    return 1


if __name__ == "__main__":
    sys.exit(main())
