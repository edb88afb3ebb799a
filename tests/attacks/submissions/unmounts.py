"""Takes mounts away: whatever lies on /proc, /tmp, /dev, its own folder, the root."""

import os

from tools import achieved, libc, processes

places = ["/proc", "/dev/shm", "/tmp", "/dev", "/sys", os.getcwd(), os.path.dirname(__file__), "/"]
with open("/proc/self/mountinfo") as mounts:
    places += [line.split()[4] for line in mounts][::-1]
before = len(processes())
for place in places:
    if libc.umount2(place.encode(), 2) == 0:
        achieved("unmounted", place)
if len(processes()) > before + 1:
    achieved("uncovered other processes")
