"""Mounts: proc, tmpfs, binds, read-only places as writable, by the old and the new calls; chroots."""

import ctypes
import os

from tools import achieved, attempt, call, libc

for source, target, kind, flags in (
    *(("proc", "/proc", "proc", 0), ("none", "/tmp", "tmpfs", 0), ("/", "/mnt", "", 0x1000)),
    *(("none", "/", "", 0x1020), ("none", "/usr", "", 0x1020), ("none", "/", "", 0x44000)),
    *(("none", "/mnt", "overlay", 0), ("none", "/mnt", "sysfs", 0), ("none", "/mnt", "cgroup2", 0)),
    *(("/dev/vda", "/mnt", "ext4", 1), ("none", "/mnt", "debugfs", 0)),
):
    if libc.mount(source.encode(), target.encode(), kind.encode(), ctypes.c_ulong(flags), b"") == 0:
        achieved("mounted", (source, target, kind))
for number, words in (
    *((428, (-100, b"/", 1)), (430, (b"tmpfs", 0)), (433, (-100, b"/", 0))),
    *((442, (-100, b"/", 0, None, 0)), (155, (b".", b"."))),
):
    words = [ctypes.c_char_p(word) if isinstance(word, bytes) else word or 0 for word in words]
    if call(number, *words)[0] >= 0:
        achieved("a call for mounting works", number)
# out of a chroot by another one
with attempt():
    above = os.open("/", os.O_RDONLY)
    os.mkdir("/tmp/attack-root")
    os.chroot("/tmp/attack-root")
    achieved("chroot")
    os.fchdir(above)
    for _ in range(64):
        os.chdir("..")
    os.chroot(".")
