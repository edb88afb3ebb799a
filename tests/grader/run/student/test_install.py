"""What a submission's process has in place of rclpy's own."""

from collections.abc import Callable

import pytest

from grader.recording.recording import Recording
from grader.run.student import executor


@pytest.mark.records("services/executor")
@pytest.mark.skipif(executor.known() is None, reason="this rclpy's own executor is kept")
def test_the_executor_of_a_known_rclpy_is_replaced(recorded: Callable[..., Recording]) -> None:
    # else every run is right, and takes twice as long, which no other test notices
    assert recorded("services/executor").output == "grader.run.student.executor\n"
