"""A forked process is what a started one is: it inherits, ends and dies in the same way."""

import os
import resource
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import psutil
import pytest

from grader.errors import GraderFailure
from grader.run.fork_servers import shadows
from grader.run.processes import fork_server_main, network
from grader.run.processes.fork_server import ForkServer, ServerLost
from grader.run.processes.fork_server_main import ProcessCommand
from grader.run.processes.started_process import (
    NotConfined,
    StartedProcess,
    SubmissionProcess,
    await_ends,
)
from tests.files import lay
from tests.grader.run.processes.conftest import COMMAND, ENV, ROOT, TEXTS, UNPRIVILEGED

#: One that dies over its first order.
DIES = "import socket, sys; s = socket.socket(fileno=int(sys.argv[2])); s.send(b'[]'); s.recv(9)"


@pytest.fixture
def fresh():
    """One that a test may end."""
    made = ForkServer(COMMAND, ENV)
    yield made
    made.close()


def python(code: str, warm: ForkServer | None, **more: Any) -> SubmissionProcess:
    command = ProcessCommand([sys.executable, "-c", code], more.pop("env", ENV), ROOT, **more)
    return SubmissionProcess(command, warm)


def output_of(code: str, warm: ForkServer | None, **more: Any) -> str:
    """What a process prints that ends in good order."""
    student = python(code, warm, **more)
    assert student.wait(20.0) == 0, student.output()
    student.end()
    return student.output()


def read_until(process: StartedProcess, text: str) -> None:
    for _ in range(1000):
        if text in bytes(process._head).decode():
            return
        process.wait(0.02)
    raise AssertionError(process.output())


@pytest.mark.parametrize("network_of", ["the grader", "its own"])
def test_a_forked_process_finds_all_that_a_started_one_does(server, network_of):
    spaces = network.Namespaces() if network_of == "the grader" else network.private_network() or {}
    passed, other = os.pipe()
    portraits = []
    for warm in (None, server):
        command = [sys.executable, "-c", TEXTS["portrait"]]
        env = {**ENV, "MORE": "1"}
        process = SubmissionProcess(ProcessCommand(command, env, ROOT, (passed,), spaces), warm)
        assert process.wait(20.0) == 0, process.output()
        process.end()
        portraits.append(process.output().splitlines())
    for fd in (passed, other):
        os.close(fd)
    for space in spaces.values():
        os.close(space)
    started, forked = portraits
    assert forked == started


@pytest.mark.parametrize("supervised", [True, False])
def test_nothing_of_the_server_or_of_the_grader_is_open_in_a_child(server, supervised):
    code = (
        "import os; print(*[os.readlink('/proc/self/fd/%s' % f) for f in range(64) "
        "if os.path.exists('/proc/self/fd/%s' % f)])"
    )
    kind = SubmissionProcess if supervised else StartedProcess
    process = kind(ProcessCommand(["-c", code], ENV, ROOT), server)
    assert process.wait(20.0) == 0
    process.end()
    inside = process.output().split()
    assert [name.partition(":")[0] for name in inside] == ["/dev/null", "pipe", "pipe"]
    assert inside[1] == inside[2]


def test_descriptors_have_the_numbers_that_the_command_knows(server):
    pipes = [os.pipe() for _ in range(8)]
    fds = tuple(fd for pipe in reversed(pipes) for fd in pipe)
    code = f"import os; [os.write(w, str(w).encode()) for w in {[w for _, w in pipes]}]"
    process = python(code, server, fds=fds)
    assert process.wait(20.0) == 0, process.output()
    assert [os.read(r, 99) for r, _ in pipes] == [str(w).encode() for _, w in pipes]
    process.end()
    for fd in fds:
        os.close(fd)


@pytest.mark.parametrize(
    ("code", "exit_code"),
    [
        ("pass", 0),
        ("raise SystemExit(3)", 3),
        ("import os; os._exit(200)", 200),
        ("import os; os.kill(os.getpid(), 9)", -9),
        ("import os; os.abort()", -6),
    ],
)
def test_the_exit_code_is_told(warm, code, exit_code):
    for kind in (SubmissionProcess, StartedProcess):
        process = kind(ProcessCommand([sys.executable, "-c", code], ENV, ROOT), warm)
        assert process.wait(20.0) == exit_code
        process.end()
        assert process.wait(0.0) == exit_code


def test_a_submission_may_clean_up_when_it_is_asked_to_end(warm):
    student = python(
        "import time\ntry:\n print('up', flush=True)\n time.sleep(1000)\n"
        "except KeyboardInterrupt: print('interrupted')\n",
        warm,
    )
    read_until(student, "up\n")
    student.end()
    assert student.output() == "up\ninterrupted\n"


def test_limits_are_those_that_the_grader_has_now(server):
    server.preloaded()  # it is up
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    code = "import resource; print(resource.getrlimit(resource.RLIMIT_NOFILE)[0])"
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft - 7, hard))
    try:
        assert output_of(code, server) == f"{soft - 7}\n"
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


@pytest.fixture(params=["started", "own namespace", "shared namespace", "no pidfd"])
def namespace(request):
    """Servers that may, and may not, make a process namespace; or have no pidfd; or none."""
    if request.param == "started":
        yield None
        return
    words = UNPRIVILEGED if request.param == "shared namespace" else ()
    *command, program = COMMAND
    if request.param == "no pidfd":
        program = TEXTS["without_pidfd"] + program
    made = ForkServer([*words, *command, program], ENV)
    yield made
    made.close()


@pytest.mark.parametrize("end", ["in good order", "supervisor killed"])
def test_a_hidden_descendant_ends_with_the_run(namespace, end):
    student = python(TEXTS["hides"], namespace)
    read_until(student, "hidden")
    mark = f"{fork_server_main.MARK}={student._mark}".encode()
    family = [p for p in psutil.process_iter() if mark in environment(p)]
    assert len(family) >= 3  # the supervisor, the command and the hidden one
    if end == "supervisor killed":
        student._signal(signal.SIGKILL)
        assert student.wait(20.0) == -signal.SIGKILL
    student.end()
    assert not await_ends(family, 20.0)


def environment(process: psutil.Process) -> bytes:
    try:
        return Path(f"/proc/{process.pid}/environ").read_bytes()
    except OSError:
        return b""


def test_one_run_s_end_leaves_another_alone(server):
    first, second = (python(TEXTS["hides"], server) for _ in range(2))
    for student in (first, second):
        read_until(student, "hidden")
    first.end(gently=False)
    assert second.wait(0.0) is None
    second.end(gently=False)


@pytest.mark.parametrize("prefix", [(), UNPRIVILEGED][: 1 + bool(UNPRIVILEGED)])
def test_a_killed_grader_takes_servers_and_their_children_along(prefix):
    waits = "import time; print('hidden', flush=True); time.sleep(1000)"
    code = TEXTS["grader"].format(root=str(ROOT), command=COMMAND, env=ENV)
    words = [*prefix, sys.executable, "-c", code, waits]
    grader = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert grader.stdout.readline() == "up\n"
    family = psutil.Process(grader.pid).children(recursive=True)
    assert len(family) >= 4  # the server, the supervisor, the command, the other one
    grader.kill()
    grader.communicate()
    assert not await_ends(family, 20.0)


def test_a_server_outlives_the_thread_that_has_started_it():
    made: list[ForkServer] = []
    thread = threading.Thread(target=lambda: made.append(ForkServer(COMMAND, ENV)))
    thread.start()
    thread.join()
    assert output_of("print('here')", made[0]) == "here\n"
    assert made[0].forks == 1
    made[0].close()


def test_a_killed_server_takes_its_children_along_and_gives_no_more(fresh):
    each = [
        kind(ProcessCommand(["-c", "import time; time.sleep(1000)"], ENV, ROOT), fresh)
        for kind in (SubmissionProcess, StartedProcess)
    ]
    family = psutil.Process(fresh.pid).children(recursive=True)
    os.kill(fresh.pid, signal.SIGKILL)
    assert [process.wait(20.0) for process in each] == [-signal.SIGKILL] * 2
    assert not await_ends(family, 20.0)
    with pytest.raises(ServerLost):
        fresh.fork(ProcessCommand(["-c", ""], ENV, ROOT))
    for process in each:
        process.end()
    assert output_of("print('started')", fresh) == "started\n"


def test_a_retired_server_ends_when_its_children_have(fresh):
    student = python("input(); print('heard')", fresh)
    assert student.pid
    fresh.retire()
    assert not fresh.has_ended() or student.wait(0.0) is not None
    student.end()
    assert fresh._process.wait(20.0) == 0


def test_a_server_is_retired_when_it_has_answered_those_who_wait(fresh):
    with ThreadPoolExecutor(4) as pool:
        waiting = [pool.submit(fresh.preloaded) for _ in range(4)]
        fresh.retire()
        for asked in waiting:
            try:
                assert asked.result() == {"numpy"}
            except ServerLost as lost:
                assert str(lost) == "it is gone"
    assert fresh._process.wait(20.0) == 0


def test_a_process_that_may_have_begun_is_not_started_a_second_time():
    server = ForkServer([sys.executable, "-c", DIES], ENV)
    with pytest.raises(GraderFailure, match="has died"):
        python("print('started')", server)
    assert server.is_lost
    server.close()


def test_what_is_refused_is_told_with_its_step_and_the_next_one_is_not(warm):
    nowhere = os.open("/dev/null", os.O_RDONLY)  # no namespace
    for kind in (SubmissionProcess, StartedProcess):
        command = ProcessCommand([sys.executable, "-c", ""], ENV, ROOT, (), {"net": nowhere})
        refused = kind(command, warm)
        with pytest.raises(NotConfined, match="setns: Invalid argument"):
            refused.wait(20.0)
        refused.end()
    os.close(nowhere)
    assert output_of("print('started')", warm) == "started\n"


def test_a_command_that_is_not_there_is_told():
    process = StartedProcess(ProcessCommand(["/nowhere/python"], ENV, ROOT))
    with pytest.raises(NotConfined, match="No such file or directory"):
        process.wait(20.0)
    process.end()


def test_an_order_may_be_long(warm):
    long = {str(number): "x" * 100_000 for number in range(10)}
    assert (
        output_of("import os; print(len(os.environ['9']))", warm, env={**ENV, **long}) == "100000\n"
    )


def test_more_descriptors_than_one_packet_carries_are_refused(server):
    with pytest.raises(ServerLost, match="are more than 64"):
        server.fork(ProcessCommand(["-c", ""], ENV, ROOT, [0] * 62))


def test_many_may_ask_at_once_and_leave_no_descriptor(server):
    def graded(number: int) -> str:
        return output_of(f"print({number})", server)

    server.preloaded()
    before = len(list(Path("/proc/self/fd").iterdir()))
    theirs = psutil.Process(server.pid).num_fds()
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(graded, range(24))) == [f"{number}\n" for number in range(24)]
    assert len(list(Path("/proc/self/fd").iterdir())) <= before
    python("", server).end()  # it has heard of the ends before
    assert psutil.Process(server.pid).num_fds() <= theirs + 2
    assert not [p for p in psutil.Process(server.pid).children() if p.status() == "zombie"][1:]


@pytest.mark.parametrize("command", [["false"], [sys.executable, "-c", "print('nothing')"]])
def test_a_server_that_does_not_come_up_is_done_without(command):
    server = ForkServer(command, ENV)
    with pytest.raises(ServerLost):
        server.preloaded()
    assert output_of("print('started')", server) == "started\n"
    assert server.is_lost
    server.close()


NAMES = frozenset({"numpy", "std_msgs", "resource"})


@pytest.mark.parametrize(
    ("files", "own"),
    [
        (["node.py", "resource/node", "package.xml"], False),
        (["numpy.py"], True),
        (["src/lib/numpy.py"], True),
        (["numpy/__init__.py"], True),
        (["numpy/notes.txt", "numpy.txt", "my_numpy.py"], False),
        (["std_msgs/msg/__init__.py"], False),  # only a namespace: the installed one wins
        (["std_msgs/__init__.py", "std_msgs/msg.py"], True),
        (["numpy.cpython-311-x86_64-linux-gnu.so"], True),
    ],
)
def test_a_submission_s_own_modules_are_found(tmp_path, files, own):
    assert shadows(lay(tmp_path, dict.fromkeys(files, "")), NAMES) == own


def test_a_linked_folder_is_a_module_as_well(tmp_path):
    lay(tmp_path, {"elsewhere/__init__.py": "", "submission/node.py": ""})
    (tmp_path / "submission" / "numpy").symlink_to(tmp_path / "elsewhere")
    assert shadows(tmp_path / "submission", NAMES)


def test_what_is_too_much_to_search_may_have_any(tmp_path, monkeypatch):
    monkeypatch.setattr("grader.run.fork_servers.MOST_FILES", 3)
    lay(tmp_path, {f"{number}.txt": "" for number in range(4)})
    assert shadows(tmp_path, NAMES)


@pytest.mark.applies(os.geteuid() == 0, reason="only root is sure to get a namespace")
def test_the_sandbox_s_place_is_the_command_s_own_process(warm):
    """However it came to be, nothing of the submission runs before `confine`."""
    code = "print(len([n for n in __import__('os').listdir('/proc') if n.isdigit()]))"
    assert output_of(code, warm) == "2\n"  # the namespace's first process, and itself


def test_ctrl_c_is_not_for_a_server(server):
    assert os.getsid(server.pid) == server.pid


def test_the_end_of_a_started_process_is_waited_for(monkeypatch):
    def no_pauses(seconds: float) -> None:
        raise AssertionError("asked again and again")

    monkeypatch.setattr("time.sleep", no_pauses)
    process = StartedProcess(ProcessCommand([sys.executable, "-S", "-c", ""], ENV))
    assert process.wait(20.0) == 0
    process.end()
