"""Reads what others handed in and what they got, changes both, and looks for them everywhere."""

import os

import known
from tools import achieved, attempt, reads, writes

for path in (known.NEIGHBOUR, known.NEIGHBOURS_RESULT):
    reads(path, "read a neighbour's file")
    writes(path, "wrote into a neighbour's file")
    with attempt("removed a neighbour's file"):
        os.unlink(path)
here = os.path.dirname(os.path.abspath(__file__))
for place in (here, os.getcwd(), known.CLASS):
    for step in ("..", "../.."):
        with attempt():
            for name in os.listdir(os.path.join(place, step)):
                if name in ("neighbour", "neighbour.py", "graded"):
                    achieved("saw a neighbour", name)
                    reads(
                        os.path.join(place, step, name, "turtle_controller.py"), "read a neighbour"
                    )
