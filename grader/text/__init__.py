"""What people read: messages, their translations, and strangers' text made showable."""

from grader import face

__getattr__ = face(__name__, __file__)
