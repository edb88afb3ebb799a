"""As many processes as it may have, up to 600: each of them waits."""

import os

from tools import achieved, fork, rest

made = 0
for _ in range(600):
    child = fork()
    if child == 0:
        rest(4)
        os._exit(0)
    made += child > 0
if made >= 600:
    achieved("made as many processes as it liked", made)
rest(0.5)
