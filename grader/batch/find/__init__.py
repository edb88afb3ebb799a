"""What of a class was handed in, and by whom, as course systems export it: `find`."""

from grader.batch.find.finding import Found, find

__all__ = ["Found", "find"]
