"""Puts a link, a FIFO, or a foreign folder in the place of the folder where the grader keeps locks."""

import os
import tempfile

import known
from tools import attempt

for home in (f"/tmp/turtlesim-grader-{known.USER}", f"{known.TEMP}/turtlesim-grader-{known.USER}"):
    with attempt():
        os.rename(home, home + ".old")
    with attempt():
        os.symlink(known.HOME, home)
beside = os.path.dirname(tempfile.gettempdir())
with attempt():
    os.rename(beside, beside + ".old")
with attempt():
    os.mkfifo(beside)
