"""Whose an exception is."""

import traceback
from collections.abc import Callable
from typing import Any

import pytest

from grader.run.lockstep import faults
from grader.run.lockstep.matching import EndpointRegistry
from grader.text.message import Message


def raised(function: Callable[..., Any], *args: Any) -> Exception:
    with pytest.raises(Exception) as caught:
        function(*args)
    return caught.value


def break_ours() -> None:
    EndpointRegistry(lambda: 0).add_up(None)


def test_an_exception_in_our_code_is_ours():
    # a reader without anything in it
    assert faults.whose(raised(EndpointRegistry.remove, None, [object()])).startswith(
        "AttributeError in matching.py, line "
    )


@pytest.mark.parametrize(
    ("function", "args"),
    [
        (break_ours, ()),  # used wrongly from outside
        (faults.pass_on, (int, "x")),
        (faults.pass_on, (break_ours,)),
        (faults.as_python_does, (ValueError("sleep length must be non-negative"),)),
    ],
)
def test_what_the_program_caused_is_the_program_s(function, args):
    assert faults.whose(raised(function, *args)) == ""


@pytest.mark.parametrize("kind", [RecursionError, MemoryError])
def test_running_out_of_something_is_nobody_s_line(kind, monkeypatch):
    def end(*_: object) -> None:
        raise kind

    monkeypatch.setattr(faults, "_THE_PROGRAMS", frozenset())
    monkeypatch.setattr(faults, "OURS", str(__file__))
    assert faults.whose(raised(end)) == ""


def test_a_fault_is_reported_before_the_program_can_catch_it(monkeypatch):
    told: list[Message] = []
    monkeypatch.setattr(faults, "on_fault", told.append)

    class Registry(EndpointRegistry): ...

    monkeypatch.setattr(Registry, "remove", faults.guarded(EndpointRegistry.remove))
    raised(Registry(lambda: 0).remove, None)
    raised(faults.guarded(faults.pass_on), int, "x")
    assert [str(line).rpartition(" ")[0] for line in told] == [
        "virtual time itself failed (TypeError in matching.py, line"
    ]


def test_tracebacks_go_without_our_frames_through_the_whole_chain():
    def program() -> None:
        try:
            faults.pass_on(int, "x")
        except ValueError as error:
            raise KeyError("y") from error

    error = raised(faults.guarded(program))
    faults.hide_our_frames(error)
    text = "".join(traceback.format_exception(error))
    assert "lockstep/faults.py" not in text
    assert "faults.pass_on(int" in text  # the program's own line
