"""Scenes, which run beside a submission: a folder each."""

from grader import face

__getattr__ = face(__name__, __file__)
