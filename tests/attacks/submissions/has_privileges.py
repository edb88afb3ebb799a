"""Looks for rights that it should not have, and for programs that give some."""

import os
import subprocess

import known
from tools import achieved, attempt, libc

with open("/proc/self/status") as file:
    status = dict(line.split(":\t") for line in file.read().splitlines() if ":\t" in line)
for name in ("CapPrm", "CapEff", "CapInh", "CapAmb"):
    if int(status[name], 16):
        achieved("has capabilities", (name, status[name]))
if status["NoNewPrivs"].strip() != "1":
    achieved("may gain privileges")
if libc.setuid(0) == 0 and known.UID != 0 and os.getuid() == 0:
    achieved("became root")
with attempt():
    for program in ("/usr/bin/sudo", "/bin/su", "/usr/bin/newgrp", "/usr/bin/mount"):
        if os.path.exists(program) and os.stat(program).st_mode & 0o4000:
            done = subprocess.run([program, "-n", "true"], capture_output=True, timeout=5)
            if program.endswith("sudo") and done.returncode == 0:
                achieved("ran as root", program)
