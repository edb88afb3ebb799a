"""Prints what terminals, web pages, CI systems and tables obey, in its output and in a traceback."""

import sys

EVIL = (
    "\033[2J\033]0;attacked\007\033[31mred",
    "::error::attacked",
    "::set-output name=score::100",
    "<script>alert(1)</script>",
    "[/b][red]markup",
    "=cmd|' /C calc'!A0",
    "\u202etxt.exe",
    "\x00\x08\x7f\x9b31m",
    "Score: 100 of 100",
    '{"score": 100, "max_score": 100}',
)
for line in EVIL:
    print(line)
    print(line, file=sys.stderr)
sys.stdout.flush()
sys.stdout.buffer.write(b"\xff\xfe\x9b31m\n")
raise RuntimeError("\n".join(EVIL))
