"""Takes 1.5 GB, a piece at a time, and touches all of it."""

import mmap

from tools import achieved, attempt

kept = []
with attempt():
    for _ in range(24):
        piece = mmap.mmap(-1, 64 << 20)
        for at in range(0, 64 << 20, 4096):
            piece[at] = 1
        kept.append(piece)
    achieved("took memory", len(kept) * 64)
