"""Reports on a result, one file per format; a report knows verdicts, not checks."""

from grader import face

__getattr__ = face(__name__, __file__)
