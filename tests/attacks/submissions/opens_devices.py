"""Opens what is behind files: disks, memory, the kernel's settings and log."""

import os

from tools import achieved, attempt

for major, minor in ((254, 0), (253, 0), (8, 0), (259, 0), (1, 1), (1, 11)):
    kind = 0o060000 if major != 1 else 0o020000
    for place in (".", "/tmp", "/dev/shm", "/dev"):
        path = f"{place}/attack-device-{major}-{minor}"
        with attempt():
            os.mknod(path, kind | 0o600, os.makedev(major, minor))
            try:
                fd = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
                achieved("opened a device", (major, minor))
                os.close(fd)
            finally:
                os.unlink(path)
for path in (
    *("/dev/mem", "/dev/kmsg", "/dev/vda", "/dev/sda", "/dev/kvm", "/dev/fuse", "/dev/net/tun"),
    *("/proc/kcore", "/proc/kmsg"),
):
    with attempt():
        os.close(os.open(path, os.O_RDONLY | os.O_NONBLOCK))
        achieved("opened a device", path)
for path in (
    *("/proc/sys/kernel/core_pattern", "/proc/sysrq-trigger", "/proc/sys/kernel/modprobe"),
    *("/sys/kernel/uevent_helper", "/sys/power/state", "/proc/sys/kernel/ns_last_pid"),
    *("/sys/fs/cgroup/cgroup.procs", "/sys/fs/cgroup/memory/cgroup.procs"),
):
    with attempt():
        os.close(os.open(path, os.O_WRONLY | os.O_NONBLOCK))  # opened, and nothing written
        achieved("could change the kernel", path)
