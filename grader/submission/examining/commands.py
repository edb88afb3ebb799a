"""Programs whose output a launch file asks for, by `Command`."""

from __future__ import annotations

import difflib
import io
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Final

from grader.submission.examining.steps import it
from grader.text.message import msg
from ros_doubles import NotKnown

#: Exit code, and what is printed to either side.
Ended = tuple[int, str, str]
_COMMAND_S: Final = 20.0
#: A program prints no more to either side, and writes no longer file [bytes].
_MOST_BYTES: Final = 8_000_000
_USUAL: Final = ("xacro", "cat", "ros2", "check_urdf")


def xacro(words: list[str]) -> Ended:
    """What xacro does with these arguments.

    Raises:
        NotKnown: it is not installed here.
    """
    try:
        import xacro as program
    except ImportError:
        raise NotKnown(
            msg("xacro is not installed where this was graded (pip install xacro)")
        ) from None
    out, errors, before = io.StringIO(), io.StringIO(), sys.argv
    sys.argv = ["xacro", *words]
    try:
        with redirect_stdout(out), redirect_stderr(errors):
            program.main()
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    finally:
        sys.argv = before
    return code, out.getvalue(), errors.getvalue()


def other(words: list[str], path: Callable[[str], str]) -> Ended:
    """What another program does.

    Args:
        path: where a file is that is named.

    Raises:
        NotKnown: there is none here, and there may be one elsewhere.
        SubstitutionFailure: there is none anywhere, or it does not end, or prints without end.
    """
    from launch.substitutions import SubstitutionFailure

    program = words[0] if words else ""
    if os.path.basename(program) == "cat":
        texts = [Path(path(word)).read_text(encoding="utf-8") for word in words[1:]]
        return 0, "".join(texts), ""
    try:
        return _run(words)
    except (OSError, IndexError) as error:
        is_slip = difflib.get_close_matches(program, _USUAL, 1, 0.7)
        if program and "/" not in program and not is_slip:
            raise NotKnown(it(msg("runs {name}, which is not here", name=program))) from None
        raise SubstitutionFailure(f"file not found: {error}") from error
    except subprocess.TimeoutExpired:
        raise SubstitutionFailure(f"{program} did not come to an end") from None
    except OverflowError:
        raise SubstitutionFailure(f"{program} prints more than {_MOST_BYTES} bytes") from None


def _run(words: list[str]) -> Ended:
    """Into files, whose length the kernel limits: so much is refused the same way each time."""

    def limit() -> None:
        import resource  # here: Windows has none

        from grader.system import linux

        linux.set_limit(resource.RLIMIT_FSIZE, _MOST_BYTES, _MOST_BYTES)

    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
        code = subprocess.run(
            words, stdout=out, stderr=errors, timeout=_COMMAND_S, check=False, preexec_fn=limit
        ).returncode
        texts = []
        for file in (out, errors):
            if file.seek(0, os.SEEK_END) >= _MOST_BYTES:
                raise OverflowError
            file.seek(0)
            texts.append(file.read().decode("utf-8"))
    return code, texts[0], texts[1]


def ros2(words: list[str], prefix: Callable[[str], str]) -> str | None:
    """What `ros2 ...` prints; None: that is known to a running system alone.

    Args:
        prefix: of a package.
    """
    if words[1:3] == ["pkg", "prefix"]:
        names = [word for word in words[3:] if not word.startswith("-")]
        if len(names) == 1:
            found = prefix(names[0])
            is_share = "--share" in words
            return f"{found}/share/{names[0]}\n" if is_share else f"{found}\n"
    return None
