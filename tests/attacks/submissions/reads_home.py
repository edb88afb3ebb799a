"""Reads the home of whoever started the grader: as HOME says, as passwd says, by its path."""

import os
import pwd

import known
from tools import achieved, attempt, reads

homes = {os.path.expanduser("~"), known.HOME}
with attempt():
    homes.add(pwd.getpwuid(os.getuid()).pw_dir)
for home in homes:
    for name in (".netrc", ".ssh/id_ed25519", "notes.txt"):
        reads(f"{home}/{name}", "read in the home")
    with attempt():
        if ".netrc" in os.listdir(home):
            achieved("listed the home")
