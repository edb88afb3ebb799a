"""The kernel's limits of a process: each is struck in a child."""

import errno
import mmap
import os
import resource
import signal
import threading
from contextlib import suppress
from pathlib import Path

import pytest

from grader.run import limits
from grader.run.limits import GIB, LIMITS, MIB, RunLimits
from grader.run.processes import supervisor
from grader.system import linux
from tests.children import NOBODYS_UID, error_of, in_child


def apply(chosen: RunLimits = LIMITS, *, is_alone: bool = True) -> None:
    """Limit this process as a submission's is."""
    for each in limits.rlimits(chosen, is_alone=is_alone):
        linux.lower_limit(*each)


def test_private_memory():
    def act() -> str:
        apply(RunLimits(data_bytes=GIB // 2), is_alone=False)
        try:
            bytearray(GIB)
        except MemoryError:
            return "refused"
        return "given"

    assert in_child(act) == "refused"


def test_shared_memory_counts_as_addresses():
    def act() -> list[int]:
        has = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        apply(RunLimits(address_bytes=has + 2 * GIB), is_alone=False)
        return [error_of(mmap.mmap, -1, 4 * GIB), error_of(mmap.mmap, -1, MIB)]

    assert in_child(act) == [errno.ENOMEM, 0]


def test_open_files():
    def act() -> list[int]:
        apply(RunLimits(open_files=40), is_alone=False)
        kept: list[int] = []
        while not (found := error_of(lambda: kept.append(os.dup(0)))):
            pass
        return [found, len(kept) < 40]

    assert in_child(act) == [errno.EMFILE, True]


def test_the_length_of_a_file(tmp_path):
    def act() -> list[int]:
        apply(RunLimits(file_bytes=MIB), is_alone=False)
        with (tmp_path / "file").open("wb", buffering=0) as file:
            written = file.write(bytes(2 * MIB))
            return [written, error_of(file.write, b"x"), error_of(file.truncate, 2 * MIB)]

    assert in_child(act) == [MIB, errno.EFBIG, errno.EFBIG]


def test_processor_time():
    child = os.fork()
    if not child:
        apply(RunLimits(cpu_s=1))
        while True:
            pass
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGXCPU


def _start_many(give_up_at: int) -> int:
    """How many processes could be started, up to a number; they have ended."""
    reading, writing = os.pipe()
    started: list[int] = []
    with suppress(BlockingIOError):
        while len(started) < give_up_at:
            child = os.fork()
            if not child:
                os.close(writing)
                os.read(reading, 1)  # until the first lets it go
                os._exit(0)
            started.append(child)
    os.close(writing)
    for child in started:
        os.waitpid(child, 0)
    return len(started)


def _start_threads(give_up_at: int) -> int:
    """How many threads could be started, up to a number."""
    end = threading.Event()
    for count in range(give_up_at):
        try:
            threading.Thread(target=end.wait, daemon=True).start()
        except RuntimeError as error:
            assert str(error) == "can't start new thread"
            return count
    return give_up_at


@pytest.mark.applies(os.getuid() == 0, reason="root alone can be a user without processes")
@pytest.mark.parametrize("start", [_start_many, _start_threads])
def test_processes_and_threads_count(start):
    def act() -> int:
        apply(RunLimits(tasks=20))
        os.setresuid(*[NOBODYS_UID] * 3)
        return start(100)

    assert in_child(act) == 19


def test_a_user_with_other_processes_may_start_some_more():
    def act() -> list[int]:
        apply(RunLimits(tasks=200), is_alone=False)
        return [resource.getrlimit(resource.RLIMIT_NPROC)[0] > 200, _start_many(50)]

    assert in_child(act) == [True, 50]


def _all_limits() -> dict[str, list[int]]:
    return {
        name: list(resource.getrlimit(getattr(resource, name)))
        for name in dir(resource)
        if name.startswith("RLIMIT_")
    }


def test_all_limits_are_hard_and_there_is_no_core_dump():
    def act() -> dict[str, list[int]]:
        apply()
        return _all_limits()

    found = in_child(act)
    assert found["RLIMIT_CORE"] == found["RLIMIT_MSGQUEUE"] == [0, 0]
    assert found["RLIMIT_DATA"] == [2 * GIB, 2 * GIB]
    assert found["RLIMIT_CPU"] == [600, 605]  # told by the one, ended by the other
    assert found["RLIMIT_STACK"] == [8 * MIB, 64 * MIB]


def test_nothing_is_raised():
    lower = {"RLIMIT_CPU": [3, 4], "RLIMIT_NOFILE": [50, 60], "RLIMIT_DATA": [GIB, GIB]}

    def act() -> dict[str, list[int]]:
        for name, (soft, hard) in lower.items():
            resource.setrlimit(getattr(resource, name), (soft, hard))
        apply()
        return {name: both for name, both in _all_limits().items() if name in lower}

    assert in_child(act) == lower


def test_what_is_limited_cannot_raise_it_again():
    def act() -> str:
        apply()
        if os.getuid() == 0:
            os.setresuid(*[NOBODYS_UID] * 3)
        try:
            resource.setrlimit(resource.RLIMIT_NOFILE, (4096, 4096))
        except ValueError as error:
            return str(error)
        return "raised"

    assert in_child(act) == "not allowed to raise maximum limit"


def test_sizes_are_told_in_the_largest_unit_that_fits():
    told = [limits.size(number) for number in (2 * GIB, 64 * MIB, 3 * GIB // 2)]
    assert told == ["2 GiB", "64 MiB", "1536 MiB"]


def test_shared_memory_is_as_large_with_a_root_of_its_own_as_without():
    assert supervisor.SHARED_MEMORY.startswith(f"size={limits.SCRATCH['/dev/shm'][0]}m,")
