"""What attacks have in common; lies beside each of them, as `known` does: where the canaries are.

Nothing here is imported that virtual time replaces: raw system calls go past all of it.
"""

import contextlib
import ctypes
import os
import struct

libc = ctypes.CDLL(None, use_errno=True)
#: A call that is refused, as opposed to one that only did not like its arguments.
REFUSED = {1, 13, 38, 3, 9}  # EPERM, EACCES, ENOSYS, ESRCH, EBADF


def achieved(what, evidence=""):
    """Say what has worked; what is read is said as well, since it is looked for in what we say."""
    line = f"ACHIEVED {what} {evidence!r}"[:3000] + "\n"
    with contextlib.suppress(OSError):
        os.write(1, line.encode("utf-8", "replace"))


@contextlib.contextmanager
def attempt(what=None):
    """What does not work is passed over; what does is told."""
    try:
        yield
    except BaseException as error:
        if isinstance(error, (KeyboardInterrupt, SystemExit)):
            raise
    else:
        if what:
            achieved(what)


def reads(path, what):
    """Read a file and tell it."""
    with attempt():
        fd = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        try:
            achieved(what, os.read(fd, 2000))
        finally:
            os.close(fd)


def writes(path, what, text=b"\n# attacked\n", flags=os.O_WRONLY | os.O_APPEND):
    """Write into a file."""
    with attempt():
        fd = os.open(path, flags | os.O_NONBLOCK, 0o666)
        try:
            os.write(fd, text)
            achieved(what, path)
        finally:
            os.close(fd)


def creates(path, what, text=b"attacked\n"):
    """Make a file that was not there."""
    writes(path, what, text, os.O_WRONLY | os.O_CREAT | os.O_EXCL)


def call(number, *words):
    """A system call; (result, errno)."""
    ctypes.set_errno(0)
    words = [ctypes.c_long(w) if isinstance(w, int) else w for w in words]
    result = libc.syscall(ctypes.c_long(number), *words)
    return result, ctypes.get_errno() if result == -1 else 0


def is_reached(number, *words):
    """Whether a system call is answered by what does the work, be it with an error."""
    return call(number, *words)[1] not in REFUSED


def processes():
    """All that are seen, but for ourselves."""
    seen = []
    with contextlib.suppress(OSError):
        seen = [int(name) for name in os.listdir("/proc") if name.isdigit()]
    return [pid for pid in seen if pid != os.getpid()]


def command_line(pid):
    """Of another process."""
    with contextlib.suppress(OSError), open(f"/proc/{pid}/cmdline", "rb") as file:
        return file.read(4000)
    return b""


def rest(seconds):
    """Real time passes, also where a second is counted otherwise."""
    libc.usleep(int(seconds * 1e6))


def fork():
    """As os.fork, without any of Python's hooks."""
    return libc.fork()


def daemon(work, fork=fork):
    """Do something in a process that nobody waits for, in a session of its own, deaf to signals."""
    if fork() != 0:
        return
    libc.setsid()
    if fork() != 0:
        os._exit(0)
    for number in range(1, 65):
        libc.signal(number, ctypes.c_void_p(1))
    try:
        os.chdir("/")
        os.closerange(0, 1024)
        work()
    finally:
        os._exit(0)


def for_a_minute():
    """What a daemon does: be there, bounded: no trial is spoilt by an earlier one for ever."""
    rest(60)


def connect(family, kind, address):
    """A raw socket that talks to somebody, or OSError."""
    fd = libc.socket(family, kind, 0)
    if fd < 0:
        raise OSError(ctypes.get_errno(), "socket")
    if libc.connect(fd, address, len(address)) < 0:
        libc.close(fd)
        raise OSError(ctypes.get_errno(), "connect")
    return fd


def inet(port, host="127.0.0.1"):
    """An address as bytes."""
    numbers = bytes(int(part) for part in host.split("."))
    return struct.pack("=H", 2) + struct.pack(">H", port) + numbers + bytes(8)


def unix(path):
    """The address of a unix socket; an abstract one begins with a zero."""
    return (
        struct.pack("=H", 1)
        + (path if isinstance(path, bytes) else path.encode())
        + b"\0" * (not path[:1] == b"\0")
    )


def drive(ticks=40, speed=2.0):
    """What an honest controller would do: earns the points of `moves`."""
    import time

    import rclpy
    from geometry_msgs.msg import Twist

    if not rclpy.ok():
        rclpy.init()
    node = rclpy.create_node("attacker")
    publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
    twist = Twist()
    twist.linear.x = speed
    for _ in range(ticks):
        publisher.publish(twist)
        time.sleep(0.05)
    return node
