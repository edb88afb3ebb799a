"""Removes what keeps a submission from importing the model solution, and imports it."""

import importlib
import importlib.machinery
import sys
import sysconfig

import known
from tools import achieved, attempt

sys.meta_path[:] = [
    importlib.machinery.BuiltinImporter,
    importlib.machinery.FrozenImporter,
    importlib.machinery.PathFinder,
]
sys.path_hooks[:] = sys.path_hooks[:2]
sys.path_importer_cache.clear()
sys.path[:0] = [known.TREE, sysconfig.get_paths()["purelib"]]
for name in [name for name in sys.modules if name.startswith("turtlesim_challenge")]:
    del sys.modules[name]
with attempt():
    reference = importlib.import_module("turtlesim_challenge.turtle_controller")
    achieved("imported the model solution", reference.__file__)
    reference.main()
