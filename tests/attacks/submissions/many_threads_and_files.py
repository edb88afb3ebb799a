"""As many threads and open files as it may have, up to 5,000."""

import os

from tools import achieved, attempt

kept = []
with attempt():
    for _ in range(5000):
        kept += os.pipe()
    achieved("opened as many files as it liked", len(kept))
