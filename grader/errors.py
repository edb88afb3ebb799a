"""The ways in which grading fails without a verdict."""


class UsageError(Exception):
    """The call, or what was handed in, cannot be used; the text says what to do (exit code 2)."""


class RecordingError(Exception):
    """The folder holds no recording that can be judged; the text says why."""


class GraderFailure(Exception):
    """The grader itself failed; never the submission's fault (exit code 3)."""
