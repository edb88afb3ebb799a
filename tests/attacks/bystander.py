"""Another process of the same user: holds a secret, counts signals, and answers when it is asked.

    python bystander.py bystander SECRET

Prints the address of its buffer; for each line that it reads, what is in there and what it caught.
"""

import ctypes
import signal
import sys

MARK = b"untouched"


def main() -> None:
    buffer = ctypes.create_string_buffer(MARK, 64)
    caught: list[int] = []
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1, signal.SIGCONT):
        signal.signal(number, lambda number, _: caught.append(number))
    print(ctypes.addressof(buffer), flush=True)
    for _ in sys.stdin:
        print(buffer.value == MARK, caught, flush=True)


if __name__ == "__main__":
    main()
