from typing import get_args

import pytest

from grader import errors
from grader.errors import (
    CheckFailed,
    GraderError,
    GraderFailure,
    NotNow,
    NotOffered,
    SceneFailure,
    SubmissionError,
    Whose,
)
from grader.text.message import Message, msg


def kinds():
    found = [kind for kind in vars(errors).values() if isinstance(kind, type)]
    return {kind for kind in found if issubclass(kind, GraderError)}


def test_every_error_says_whose_turn_it_is_in_one_text():
    for kind in kinds():
        error = kind("what was found")
        assert (str(error.message), str(error)) == ("what was found", "what was found")
        assert error.whose in get_args(Whose)
        assert kind("found {n}", n=2).message == msg("found {n}", n=2)
        assert kind("found {n}").message == Message.of("found {n}")


def test_only_our_own_failure_and_that_of_a_check_exit_with_3():
    ours = {GraderError, GraderFailure, NotNow, NotOffered, SceneFailure}
    assert {kind for kind in kinds() if kind.exit_code == 3} == {*ours, CheckFailed}
    assert {kind for kind in kinds() if kind.whose == "grader"} == ours


@pytest.mark.parametrize(
    ("name", "shown"), [("\x1b[31mred", "?[31mred"), ("a\nb", "a\nb"), ("x\udcff", "x?")]
)
def test_names_of_a_students_files_are_harmless_in_a_terminal(name, shown):
    assert str(SubmissionError(name).message) == shown
    assert str(SubmissionError("there is no {name}", name=name)) == f"there is no {shown}"
