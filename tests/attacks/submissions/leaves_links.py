"""Leaves links wherever it may, under the names that others may open, to files that are not its own."""

import os
import tempfile

import known
from tools import attempt

TARGETS = (f"{known.HOME}/notes.txt", known.NEIGHBOUR, known.EXERCISE, known.NEIGHBOURS_RESULT)
NAMES = ("output.txt", "result.json", "recording", "log", "loopback.xml", "canvas.png", "source")
own = os.path.realpath(tempfile.gettempdir())
places = {os.getcwd(), own, os.path.dirname(own), known.OUT, known.TEMP, "/dev/shm"}
for place in sorted(places):
    for index, target in enumerate(TARGETS):
        with attempt("made a hard link"):
            os.link(target, f"{place}/hard-{index}")
        for name in NAMES:
            with attempt():
                os.symlink(target, f"{place}/{name}")
    with attempt():
        os.symlink(known.HOME, f"{place}/folder")
# what is its own gives way to a link: its folder, its source, where it may write
for path, target in (
    (os.path.join(own, "log"), known.HOME),
    (os.path.abspath("turtle_controller.py"), known.NEIGHBOUR),
    (os.getcwd(), known.CLASS),
    (own, known.HOME),
):
    with attempt():
        os.rename(path, path + ".away")
        os.symlink(target, path)
