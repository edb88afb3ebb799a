import rclpy.executors

from grader.run.clock import executor


def test_an_unknown_rclpy_keeps_its_own_function(monkeypatch):
    original = rclpy.executors.Executor._wait_for_ready_callbacks
    monkeypatch.setattr(executor, "KNOWN", {})
    executor.install()
    assert rclpy.executors.Executor._wait_for_ready_callbacks is original


def test_the_installed_rclpy_is_known(monkeypatch):
    original = rclpy.executors.Executor._wait_for_ready_callbacks
    tracker = rclpy.executors._WorkTracker
    for kind, name in (  # as they are, afterwards too
        (rclpy.executors.Executor, "_wait_for_ready_callbacks"),
        (tracker, "__enter__"),
        (tracker, "__exit__"),
    ):
        monkeypatch.setattr(kind, name, getattr(kind, name))
    executor.install()
    assert rclpy.executors.Executor._wait_for_ready_callbacks is not original
