"""What is missing of a system is noticed, and what a run does then is this."""

import ctypes
import os
import signal
import socket
from pathlib import Path

import psutil
import pytest

from grader import system
from grader.run import handover, stage
from grader.run.lockstep import contract
from grader.run.processes import cores, isolation, linux, watched
from grader.scenes import load_scene
from tests.grader.driving import Spiral, drive
from tests.grader.scenes.turtlesim.traces import assert_same_trace


def test_linux_lacks_nothing() -> None:
    assert contract.lacking() == ""
    assert isolation.weakness() == ""
    assert system.has_supervision()


@pytest.mark.parametrize(
    ("owner", "name", "lacks"),
    [
        (socket, "SOCK_SEQPACKET", "SOCK_SEQPACKET"),
        (socket, "AF_UNIX", "SOCK_SEQPACKET"),
    ],
)
def test_virtual_time_says_what_it_lacks(monkeypatch, owner, name, lacks) -> None:
    monkeypatch.delattr(owner, name)
    assert contract.lacking() == f"virtual time needs {lacks}, which this system lacks"


def test_several_things_may_be_missing(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.delattr(socket, "SOCK_SEQPACKET")
    monkeypatch.setattr(system, "PROC", tmp_path)
    lack = "virtual time needs SOCK_SEQPACKET and /proc, which this system lacks"
    assert contract.lacking() == lack


def no_libc(name: str | None, **_: object) -> object:
    raise TypeError("argument of type 'NoneType' is not iterable")  # as Windows says


def libc_without(name: str | None, **_: object) -> object:
    return object()


@pytest.mark.parametrize("load", [no_libc, libc_without])
def test_a_libc_that_knows_nothing_of_linux(monkeypatch, load) -> None:
    from grader.run.processes import parent
    from grader.run.student import main as student_main

    monkeypatch.setattr(ctypes, "CDLL", load)
    assert not system.has_supervision()
    parent.die_with_parent()
    student_main.die_with_parent()
    watched.adopt_orphans()


@pytest.mark.parametrize("libc", [None, object()])
def test_namespaces_that_libc_does_not_know_are_refused(monkeypatch, libc) -> None:
    monkeypatch.setattr(linux, "_libc", libc)
    monkeypatch.setattr(isolation, "_refused", set())
    with pytest.raises(OSError, match=r"unshare \(net\)"):
        linux.unshare(linux.CLONE_NEWNET)
    with pytest.raises(OSError, match=r"unshare \(net\)"):
        isolation._as_root()


@pytest.mark.parametrize("lack", ["memfd_create", "memfd_create and /proc", "descriptors"])
def test_a_recording_goes_through_a_file_without_memfd(monkeypatch, tmp_path, lack) -> None:
    if lack == "descriptors":
        monkeypatch.setattr(system, "inherits_descriptors", lambda: False)
    else:
        monkeypatch.delattr(os, "memfd_create")
    if "/proc" in lack:
        monkeypatch.setattr(system, "PROC", Path("/nowhere"))
    scene = load_scene("turtlesim")
    trace = drive(Spiral(), ticks=50).trace
    with stage.open_stage() as place:
        named = [path for path in place.folder.rglob("*") if path.name.startswith("recording")]
        assert bool(named) == (lack == "descriptors")  # within reach only where it must be
        handover.leave(Path(place.recording_path), scene, trace, ())
        found, _ = handover.fetch(place.recording, scene)
    assert_same_trace(found, trace)


def test_processes_are_found_without_proc(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr(system, "PROC", tmp_path)
    process = watched.Watched(["sleep", "1000"], {"PATH": os.environ["PATH"]})
    assert process.pid in watched._all_processes()
    while psutil.Process(process.pid).name() != "sleep":  # it still has our environment till then
        os.sched_yield()
    assert process._owns(process.pid)
    assert not process._owns(os.getpid())
    process._sweep(20.0)
    assert process.wait(20.0) == -signal.SIGKILL
    process.end()


def test_no_core_is_chosen_where_the_system_chooses(monkeypatch) -> None:
    monkeypatch.setattr(cores, "_getaffinity", None)
    monkeypatch.setattr(cores, "_setaffinity", None)
    assert cores.available() == list(range(os.cpu_count() or 1))
    before = psutil.Process().cpu_affinity()
    with cores.reserve_core(1) as core:
        cores.pin(core)
    assert psutil.Process().cpu_affinity() == before
