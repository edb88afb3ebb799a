"""Takes open files out of other processes: by pidfd_getfd, by /proc, and by those that it was left."""

import os

from tools import achieved, attempt, call, command_line, processes

for pid in processes():
    pidfd, _ = call(434, pid, 0)
    if pidfd >= 0:
        for number in range(40):
            fd, _ = call(438, pidfd, number, 0)
            if fd >= 0:
                achieved("took a descriptor", (command_line(pid), number))
                with attempt():
                    os.pread(fd, 100, 0)
    with attempt():
        for number in os.listdir(f"/proc/{pid}/fd"):
            target = os.readlink(f"/proc/{pid}/fd/{number}")
            with attempt():
                fd = os.open(f"/proc/{pid}/fd/{number}", os.O_RDWR | os.O_NONBLOCK)
                achieved("opened a descriptor", target)
with attempt():
    for number in os.listdir("/proc/self/fd"):
        target = os.readlink(f"/proc/self/fd/{number}")
        if int(number) > 2 and (
            "/" in target.split(" ")[0]
            and not target.startswith(("/proc", "/dev/null", "/dev/random", "/dev/urandom"))
        ):
            if "memfd:" not in target:  # the page with the tick is one
                achieved("was left a descriptor", target)
