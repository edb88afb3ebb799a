"""Changes what it handed in, where it lies and where it is run, so that another run differs."""

import os

import known
from tools import creates, writes

writes(known.SOURCE, "wrote into what was handed in")
creates(os.path.join(os.path.dirname(known.SOURCE), "left.py"), "made a file beside it")
writes(os.path.abspath(__file__), "wrote into its own copy")
creates(os.path.join(os.path.dirname(os.path.abspath(__file__)), "left.py"), "made a file in it")
