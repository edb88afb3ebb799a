"""Compiles the packages of this environment to byte code, on all cores.

A submission's process may write nowhere: what is not compiled here, each run would compile again.
"""

import importlib.util
import os
import re
import sys
import sysconfig
from compileall import compile_dir
from pathlib import Path


def main() -> None:
    """Compile the packages, and Python's own library where nobody has."""
    cores = len(os.sched_getaffinity(0))
    is_complete = compile_dir(sysconfig.get_path("purelib"), quiet=1, workers=cores)
    # uv's Pythons come so. A module that hardly any program imports tells
    library = Path(sysconfig.get_path("stdlib"))
    rare = importlib.util.cache_from_source(str(library / "antigravity.py"))
    if not Path(rare).exists() and os.access(library, os.W_OK):
        others = re.compile("/(dist-packages|site-packages|idlelib|lib2to3|tests?)/")
        compile_dir(library, quiet=2, workers=cores, rx=others)
    sys.exit(not is_complete)


if __name__ == "__main__":
    main()
