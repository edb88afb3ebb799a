"""Appends to modules that the grader imports when the run is over, and plants some for next time."""

import os
import sys
import sysconfig

import known
from tools import creates, writes

CODE = b"\nimport os; os.write(2, b'ACHIEVED code in the grader\\n')\n"
places = {known.TREE, sysconfig.get_paths()["purelib"], *filter(None, sys.path)}
# but for its own folder, which nobody else will ever see
for place in places - {os.path.dirname(os.path.abspath(__file__))}:
    for module in (
        "grader/reports/terminal.py",
        "grader/recording/bag.py",
        "backports/zstd/__init__.py",
    ):
        writes(f"{place}/{module}", "changed a module", CODE)
    for name in ("sitecustomize.py", "usercustomize.py", "attack.pth", "grader.py"):
        creates(f"{place}/{name}", "planted a module", CODE)
