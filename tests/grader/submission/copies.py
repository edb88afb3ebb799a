"""Hand-ins, and what is found in them: in a copy that goes, but told as it was handed in."""

import pytest

from grader.errors import SubmissionError, UsageError
from grader.run.opening import open_submission

NODE = "import rclpy\n\n\ndef main(args=None):\n    rclpy.init(args=args)\n"
GUARDED = NODE + '\n\nif __name__ == "__main__":\n    main()\n'


def below(folder, files):
    return {f"{folder}/{name}": text for name, text in files.items()}


def found_in(path, executable=None):
    with open_submission(path, executable) as submission:
        return in_place(submission)


def refused(path, executable=None):
    with pytest.raises((SubmissionError, UsageError)) as error, open_submission(path, executable):
        pass
    assert "Traceback" not in str(error.value)
    return str(error.value)


def in_place(submission):
    """The same with the paths that were handed in."""
    copy = submission.copy

    def back(path):
        return copy.origin / path.relative_to(copy.folder)

    return submission.with_paths(back)
