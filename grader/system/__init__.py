"""Files, processes, limits and data: what all rooms use, once each."""

from grader import face

__getattr__ = face(__name__, __file__)
