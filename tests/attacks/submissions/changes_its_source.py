"""Changes what it handed in, where it lies and where it is run, so that another run differs."""

import os

import known
from tools import achieved, attempt, creates, writes

writes(known.SOURCE, "wrote into what was handed in")
creates(os.path.join(os.path.dirname(known.SOURCE), "left.py"), "made a file beside it")
left = os.path.join(os.path.dirname(os.path.abspath(__file__)), "left.py")
if os.path.exists(left):
    achieved("found what another run has left", left)
with attempt(), open(left, "w") as file, open(__file__, "a") as source:
    for each in (file, source):  # it may, as nobody else will ever see it
        each.write("# attacked")
