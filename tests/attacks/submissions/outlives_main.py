"""Threads, tracing, finalisers and handlers that go on when its work is over."""

import atexit
import sys
import threading

from tools import libc, rest


class Stays:
    def __del__(self):
        rest(0.2)


def go_on(*_):
    while True:
        rest(100)


stays = Stays()
sys.settrace(lambda *_: None)
sys.setprofile(lambda *_: None)
for number in range(1, 65):
    if number not in (9, 19, 11):
        libc.signal(number, 1)
atexit.register(go_on)
threading.Thread(target=go_on, daemon=True).start()
threading.excepthook = sys.excepthook = sys.unraisablehook = go_on
