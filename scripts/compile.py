"""Compiles the packages of this environment to byte code, on all cores.

A submission's process may write nowhere: what is not compiled here, each run would compile again.
"""

import importlib.util
import os
import sysconfig
from compileall import compile_file
from functools import partial
from multiprocessing import Pool
from pathlib import Path

#: Of Python's library: what no submission imports.
LEFT_OUT = {"dist-packages", "site-packages", "idlelib", "lib2to3", "test", "tests"}


def main() -> None:
    """Compile the packages, and Python's own library where nobody has."""
    files = [*Path(sysconfig.get_path("purelib")).rglob("*.py")]
    # uv's Pythons come so. A module that hardly any program imports tells
    library = Path(sysconfig.get_path("stdlib"))
    rare = importlib.util.cache_from_source(str(library / "antigravity.py"))
    if not Path(rare).exists() and os.access(library, os.W_OK):
        files += [path for path in library.rglob("*.py") if LEFT_OUT.isdisjoint(path.parts)]
    # not compileall's own workers: handing over one file at a time costs more than looking at it
    with Pool(len(os.sched_getaffinity(0))) as pool:
        # and, as with pip, a file that is no Python of today's hinders nobody
        pool.map(partial(compile_file, quiet=2), files, chunksize=32)


if __name__ == "__main__":
    main()
