"""The command `grader`."""

from __future__ import annotations

from typing import NoReturn

from grader import cli


def main() -> NoReturn:
    """Do the call of this process, and end."""
    cli.leave(cli.main())


if __name__ == "__main__":
    main()
