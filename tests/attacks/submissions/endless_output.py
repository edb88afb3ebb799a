"""Prints without end, to both streams, with and without lines."""

import os

LINE = b"spam " * 200 + b"\n"
for _ in range(40_000):
    os.write(1, LINE)
    os.write(2, LINE[:-1])
