"""Observes a submission's process for the diagnosis; knows no clock, and changes nothing.

`grader.run.evidence` reads the page on the grader's side, with `account`, `files` and `ending`.
"""
