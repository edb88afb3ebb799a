"""Has the kernel tell it of files, or keep others waiting for them: inotify, fanotify, leases."""

import os
import signal
import tempfile

import known
from tools import achieved, attempt, call

FCNTL, X32 = 72, 1 << 30
INOTIFY_INIT, INOTIFY_ADD_WATCH, INOTIFY_INIT1 = 253, 254, 294
FANOTIFY_INIT, FAN_REPORT_FID = 300, 0x200
F_SETLEASE, F_NOTIFY, F_SETDELEG = 1024, 1026, 1040
ALL_EVENTS, DN_CREATE, F_RDLCK = 0xFFF, 4, 0

signal.signal(signal.SIGIO, signal.SIG_IGN)  # what F_NOTIFY would send
own = os.path.join(tempfile.gettempdir(), "watched")
with open(own, "w"):
    pass
for path in (own, os.__file__, os.path.dirname(own), "/", known.HOME, known.SOURCE):
    with attempt():
        fd = os.open(path, os.O_RDONLY)
        for name, command, word in (
            ("a lease", F_SETLEASE, F_RDLCK),
            ("F_NOTIFY", F_NOTIFY, DN_CREATE),
            ("F_SETDELEG", F_SETDELEG, 0),
        ):
            for number in (FCNTL, X32 | FCNTL):
                for more in (0, 1 << 32):  # the kernel looks at half of the word
                    if call(number, fd, command | more, word)[0] == 0:
                        achieved(name, path)
instances = [call(INOTIFY_INIT)[0], *(call(INOTIFY_INIT1, 0)[0] for _ in range(200))]
if (most := sum(fd >= 0 for fd in instances)) > 0:
    achieved("inotify instances", most)
for path in ("/", "/usr", "/tmp", known.HOME, known.CLASS, known.TEMP, os.getcwd()):
    if call(INOTIFY_ADD_WATCH, max(instances), path.encode() + b"\0", ALL_EVENTS)[0] >= 0:
        achieved("inotify is told of", path)
if call(FANOTIFY_INIT, FAN_REPORT_FID, 0)[0] >= 0:
    achieved("fanotify")
