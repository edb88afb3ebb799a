"""A little shell: it runs one program of this checkout on the terminal that is its input.

    python -m tests.shell MODULE ARGUMENTS

Like a real one it leads a session, puts the program in front, takes the terminal back when the
program stops, and continues it when it is told to (SIGUSR1). What happens it says on stderr.
"""

import fcntl
import os
import signal
import subprocess
import sys
import termios


def main() -> int:
    os.setsid()
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    for ignored in (signal.SIGTTOU, signal.SIGINT, signal.SIGQUIT, signal.SIGTSTP):
        signal.signal(ignored, signal.SIG_IGN)
    program = subprocess.Popen(
        [sys.executable, "-m", *sys.argv[1:]], process_group=0, restore_signals=True
    )
    os.tcsetpgrp(0, program.pid)

    def go_on(*_: object) -> None:
        os.tcsetpgrp(0, program.pid)
        os.kill(program.pid, signal.SIGCONT)

    signal.signal(signal.SIGUSR1, go_on)
    signal.signal(signal.SIGTERM, lambda *_: os.kill(program.pid, signal.SIGTERM))
    signal.signal(signal.SIGHUP, lambda *_: os.kill(program.pid, signal.SIGHUP))
    while True:
        _, status = os.waitpid(program.pid, os.WUNTRACED)
        if not os.WIFSTOPPED(status):
            return os.waitstatus_to_exitcode(status)
        os.tcsetpgrp(0, os.getpgrp())
        print("stopped", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
