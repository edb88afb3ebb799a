"""Forks twice, takes a session of its own, is deaf to all signals, forgets its environment."""

import os

from tools import daemon, for_a_minute

for _ in range(3):
    daemon(for_a_minute, os.fork)
