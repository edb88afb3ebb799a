"""Talks to services of this machine: on loopback, by unix sockets, by packets of its own making."""

import known
from tools import achieved, attempt, connect, inet, libc, unix

INET, UNIX, NETLINK, PACKET, VSOCK, ALG = 2, 1, 16, 17, 40, 38
with attempt():
    fd = connect(INET, 1, inet(known.TCP))
    achieved("reached a service by TCP")
    libc.write(fd, b"attacked", 8)
for host in ("127.0.0.1", known.ADDRESS, "255.255.255.255", "239.255.0.1"):
    with attempt():
        fd = connect(INET, 2, inet(known.UDP, host))
        libc.write(fd, b"attacked", 8)
with attempt():
    connect(INET, 1, inet(80, "10.0.2.2"))
    achieved("reached another machine")
for path in (
    known.UNIX,
    b"\0" + known.ABSTRACT.encode(),
    "/run/docker.sock",
    "/run/dbus/system_bus_socket",
):
    with attempt():
        fd = connect(UNIX, 1, unix(path))
        achieved("reached a unix socket", path)
        libc.write(fd, b"attacked", 8)
for name, family, kind in (
    *(("netlink", NETLINK, 3), ("packet", PACKET, 3), ("vsock", VSOCK, 1), ("crypto", ALG, 5)),
    *(("raw", INET, 3), ("bluetooth", 31, 3), ("xdp", 44, 3), ("tipc", 30, 5)),
):
    fd = libc.socket(family, kind, 1 if name == "raw" else 0)
    if fd >= 0 and name != "netlink":
        achieved("has a socket of its own making", name)
