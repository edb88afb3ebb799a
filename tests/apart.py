"""What each session of tests, and each of its workers, has for itself; nothing of it stays behind.

A session has a temporary folder, a worker a ROS domain and a place for log files. At the end the
session fails where a process, a file of that folder or a segment of shared memory is left.
"""

import fcntl
import os
import re
import shutil
import signal
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import psutil
import pytest

SHARED_MEMORY = Path("/dev/shm")
#: A user's for good: the locks of domains and cores, and LTTng's page, which `import rclpy` makes.
#: Fast DDS's: nothing tells whose they are, and other programs on the machine come and go.
STAYS = re.compile(
    r"turtlesim-grader-\w+(/(domain|core)-\d+\.lock|/interfaces-\w+(/.*)?)?"
    r"|lttng-ust-wait-\S+|(sem\.)?(fastrtps|fastdds)_\S+"
)
ROOM, DOOR = "room.lock", "door.lock"
_open, _begun = ExitStack(), ExitStack()


def is_worker(config: pytest.Config) -> bool:
    """Whether this process is one of several that the session's own has started."""
    return hasattr(config, "workerinput")


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    """Take what is this process's own, before anything asks where temporary files lie."""
    # here: the checked message fields have to be asked for before anything of ROS is imported
    from grader.run.processes import network
    from grader.system import scratch

    if not is_worker(config):
        config.pluginmanager.register(Leftovers(), "leftovers")
    # hundreds of processes import this checkout: each would compile it for itself
    sys.dont_write_bytecode = False
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    # `nohup make test &` has them ignored, and so would all that is started here
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    # held among all of this user's sessions, and then among all runs of this one
    number = _open.enter_context(network.reserve_domain())
    if not is_worker(config):
        # where the folders of failing tests stay to be looked at
        os.environ["PYTEST_DEBUG_TEMPROOT"] = tempfile.gettempdir()
        folder = tempfile.mkdtemp(prefix="t")  # short: addresses of sockets end after 107 bytes
        Path(folder).chmod(0o1777)  # as the system's: some tests go on as another user
        _open.callback(shutil.rmtree, folder, ignore_errors=True)
        os.environ["TMPDIR"] = tempfile.tempdir = folder
    os.environ["ROS_DOMAIN_ID"] = str(number)
    os.environ["ROS_LOG_DIR"] = _open.enter_context(tempfile.TemporaryDirectory(prefix="log-"))
    if lock := scratch.acquire_lock(f"domain-{number}"):
        _open.enter_context(lock)


def at_the_end(call: Callable[[], object]) -> None:
    """Do something when this process has run its tests, before anybody looks what is left."""
    _begun.callback(call)


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish() -> None:
    """End what tests have begun for all that come after them."""
    _begun.close()


def pytest_unconfigure() -> None:
    _open.close()


class Leftovers:
    """Looks round at the end of a session, when its workers have gone."""

    def __init__(self) -> None:
        self._segments = set(SHARED_MEMORY.glob("*"))

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Fail for what is left."""
        from grader.system import scratch

        with scratch.make_folder():  # as the next grader: it removes what a killed one has left
            pass
        reporter = session.config.pluginmanager.get_plugin("terminalreporter")
        found = [*_processes(), *_files(), *self._unused_segments()]
        if not found or reporter is None:
            return
        lines = sorted(found)[:20]
        text = "\n".join((f"left behind by the tests, {len(found)} in all:", *lines))
        report = pytest.CollectReport("what the tests leave behind", "failed", text, [])
        reporter.stats.setdefault("error", []).append(report)
        session.exitstatus = session.exitstatus or pytest.ExitCode.TESTS_FAILED

    def _unused_segments(self) -> Iterator[str]:
        used = set()
        for process in Path("/proc").glob("[0-9]*"):
            with suppress(OSError):
                used.update(re.findall(r"/dev/shm/\S+", (process / "maps").read_text()))
                used.update(str(each.readlink()) for each in (process / "fd").iterdir())
        for path in SHARED_MEMORY.glob("*"):
            is_unused = path not in self._segments and str(path) not in used
            if is_unused and not STAYS.fullmatch(path.name):
                yield f"shared memory {path}"


def _processes() -> Iterator[str]:
    """Those that were told where this session's temporary files lie."""
    folder = tempfile.gettempdir()
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            words = " ".join(process.cmdline())
            is_ours = folder in words or folder in " ".join(process.environ().values())
            if is_ours and process.pid != os.getpid() and process.status() != psutil.STATUS_ZOMBIE:
                yield f"process {process.pid}, {process.status()}: {words[:200]}"
                process.kill()


def _files() -> Iterator[str]:
    folder = Path(tempfile.gettempdir())
    ours = {Path(os.environ["ROS_LOG_DIR"]), folder / ROOM, folder / DOOR}
    for path in folder.rglob("*"):
        is_stranger = ours.isdisjoint((path, *path.parents))
        if is_stranger and not STAYS.fullmatch(str(path.relative_to(folder))):
            yield f"file {path}"


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """A test that needs the machine for itself waits until no other runs; none runs beside it."""
    with _turn(is_alone=item.get_closest_marker("alone") is not None):
        return (yield)


@contextmanager
def _turn(is_alone: bool) -> Iterator[None]:
    folder = Path(tempfile.gettempdir())
    with (folder / ROOM).open("w") as room:
        with (folder / DOOR).open("w") as door:  # who waits there keeps all others out
            fcntl.flock(door, fcntl.LOCK_EX)
            fcntl.flock(room, fcntl.LOCK_EX if is_alone else fcntl.LOCK_SH)
        yield
