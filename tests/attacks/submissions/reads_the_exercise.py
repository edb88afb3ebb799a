"""Reads what is asked for: the edited exercise of the course, and the checks that came along."""

import glob
import sysconfig

import known
from tools import reads

reads(known.EXERCISE, "read the exercise")
for place in (known.TREE, sysconfig.get_paths()["purelib"]):
    for path in glob.glob(f"{place}/grader/exercises/*/*.yaml") + glob.glob(
        f"{place}/grader/exercises/*/checks*"
    ):
        reads(path, "read an exercise of the grader's")
