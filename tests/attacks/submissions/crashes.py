"""Ends by a fault in C, in a thread, while other threads hold what they can."""

import ctypes
import threading

threading.Thread(target=lambda: ctypes.string_at(1)).start()
