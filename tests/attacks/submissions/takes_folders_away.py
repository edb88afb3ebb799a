"""Takes away its own folder and all that it may of temporary files, then drives from nowhere."""

import os
import shutil
from contextlib import suppress

from tools import drive

shutil.rmtree(os.getcwd(), ignore_errors=True)
with suppress(OSError):
    for name in os.listdir("/tmp"):
        shutil.rmtree(os.path.join("/tmp", name), ignore_errors=True)
drive()
