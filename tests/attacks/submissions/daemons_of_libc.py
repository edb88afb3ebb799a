"""As `daemons`, by C's fork and by the bare call, as a sibling of its own (CLONE_PARENT)."""

import os

from tools import call, daemon, for_a_minute

for _ in range(3):
    daemon(for_a_minute)
CLONE_PARENT = 0x8000
if call(56, CLONE_PARENT | 17, 0, 0, 0, 0)[0] == 0:
    if call(56, CLONE_PARENT, 0, 0, 0, 0)[0] == 0:  # and whose end tells nobody
        for_a_minute()
    os._exit(0)
