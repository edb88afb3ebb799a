"""Makes namespaces of its own, in which it is root, and enters those of others."""

import os

from tools import achieved, attempt, call, fork, libc, processes

KINDS = {"user": 0x10000000, "mnt": 0x20000, "pid": 0x20000000, "net": 0x40000000}
KINDS |= {"ipc": 0x08000000, "uts": 0x04000000, "cgroup": 0x02000000, "time": 0x80}
for name, kind in KINDS.items():
    child = fork()
    if child == 0:
        if libc.unshare(kind) == 0:
            achieved("made a namespace", name)
        os._exit(0)
    os.waitpid(child, 0)
    # clone; of its flags the lowest byte is a signal
    child = call(56, kind | 17, 0, 0, 0, 0)[0] if kind > 0xFF else -1
    if child == 0:
        os._exit(0)
    if child > 0:
        achieved("cloned into a namespace", name)
for pid in [os.getppid(), 1, *processes()]:
    for name, kind in KINDS.items():
        with attempt():
            fd = os.open(f"/proc/{pid}/ns/{name}", os.O_RDONLY)
            same = os.fstat(fd).st_ino == os.stat(f"/proc/self/ns/{name}").st_ino
            if libc.setns(fd, kind) == 0 and not same:
                achieved("entered a namespace", name)
            os.close(fd)
    pidfd, _ = call(434, pid, 0)
    if pidfd >= 0 and libc.setns(pidfd, KINDS["net"] | KINDS["mnt"]) == 0:
        achieved("entered a process", pid)
