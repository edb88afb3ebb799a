"""One graded run: the simulator and the submission, each in a process of its own."""

from grader import face

__getattr__ = face(__name__, __file__)
