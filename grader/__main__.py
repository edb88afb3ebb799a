"""The command `grader`: the user's servers do a call where there are some, else this process."""

from __future__ import annotations

import os
import sys
from typing import NoReturn

from grader.servers import client


def main() -> NoReturn:
    """Do the call of this process, and end."""
    words = sys.argv[1:]
    try:
        code, refused = client.called(words), None
    except client.CallRefused as error:
        code, refused = None, error.why
    except client.CallLost:
        from grader import cli

        code, refused = cli.lost(words), None
    if code is not None:
        os._exit(code)
    from grader import cli

    cli.leave(cli.main(words, refused or ""))


if __name__ == "__main__":
    main()
