"""Does something in a process of its own, which may be confined or killed by it."""

import json
import os
import traceback
import warnings
from collections.abc import Callable
from typing import Any, NoReturn

#: A user that has no process and no file.
NOBODYS_UID = 61_471


def in_child(function: Callable[..., Any], *arguments: Any) -> Any:
    """What a function returns in a fork of this process, as JSON has it.

    Raises:
        AssertionError: it raised something, or its process was killed; the text says what.
    """
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        # other threads are the tests' own, and hold nothing that a child needs
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if not child:
        _be_child(writing, function, arguments)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        told = pipe.read()
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if not told:
        raise AssertionError(f"the child ended with {code} and told nothing")
    result, error = json.loads(told)
    if error:
        raise AssertionError(f"in the child:\n{error}")
    return result


def error_of(function: Callable[..., Any], *arguments: Any) -> int:
    """The number of the system's error that a call ends with; 0 if it works."""
    try:
        function(*arguments)
    except OSError as error:
        return error.errno or -1
    return 0


def _be_child(writing: int, function: Callable[..., Any], arguments: tuple[Any, ...]) -> NoReturn:
    try:
        try:
            told = [function(*arguments), ""]
        except BaseException:
            told = [None, traceback.format_exc()]
        os.write(writing, json.dumps(told).encode())
    finally:
        os._exit(0)
