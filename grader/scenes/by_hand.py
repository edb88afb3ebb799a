"""The command that starts a student's node by hand, for exercise sheets."""

from __future__ import annotations

from pathlib import PurePath


def command(program: str, package: str) -> str:
    """As it is graded: a package's own modules are found by the package's name.

    Args:
        program: the node's file, below the folder that is handed in.
        package: which it is in; '' for none.
    """
    path = PurePath(program)
    if package and len(path.parts) > 1:
        return f"python3 -m {'.'.join(path.with_suffix('').parts)}"
    return f"python3 {program}"
