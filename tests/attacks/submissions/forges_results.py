"""Writes the files in which the result will be, makes links of them, and takes the folder away."""

import json
import os

import known
from tools import attempt, creates, daemon, rest, writes

RESULT = json.dumps({"score": 100, "max_score": 100, "verdicts": []}).encode()


def forge():
    for name in ("result.json", "report.html", "output.txt", "canvas.png"):
        path = f"{known.OUT}/{name}"
        writes(path, "wrote a result")
        creates(path, "made a result", RESULT)
    with attempt("made a link for a result"):
        os.symlink(f"{known.HOME}/notes.txt", f"{known.OUT}/output.txt.new")
    with attempt("made a folder for results"):
        os.makedirs(f"{known.OUT}/recording")


with attempt("made the folder for results"):
    os.makedirs(known.OUT)
forge()


def again():
    for _ in range(300):
        rest(0.01)
        forge()


daemon(again)
