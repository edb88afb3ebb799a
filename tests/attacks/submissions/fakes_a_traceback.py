"""Ends with what looks like a traceback, of lines over which a reader may go to and fro."""

import sys

sys.stderr.write("Traceback (most recent call last):\n")
sys.stderr.write('  File "turtle_controller.py", line 1, in x' + "\n" * 64_000)
sys.stderr.write('  File "' * 4000 + "\n")
sys.exit(1)
