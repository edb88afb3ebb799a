"""Writes into the home: a new file, a start-up file, and one that is there."""

import os

import known
from tools import attempt, creates, writes

for home in {os.path.expanduser("~"), known.HOME}:
    for name in ("notes.txt", ".netrc"):
        writes(f"{home}/{name}", "wrote in the home")
if known.HOME:
    creates(f"{known.HOME}/.bash_login", "made a file in the home", b"echo attacked\n")
    with attempt("removed a file of the home"):
        os.unlink(f"{known.HOME}/notes.txt")
    with attempt("made a folder in the home"):
        os.mkdir(f"{known.HOME}/attacked")
    with attempt("renamed a folder of the home"):
        os.rename(f"{known.HOME}/.ssh", f"{known.HOME}/.ssh2")
    with attempt("closed the home"):
        os.chmod(f"{known.HOME}/.netrc", 0o777)
