"""Where a node is stuck."""

import rclpy.executors

from grader.run.student import deadlock, executor


def refusal(message: str, where: str = rclpy.executors.__name__) -> Exception:
    """An exception as newer executors raise it when told to spin within a spin."""
    scope = {"__name__": where}
    exec(f"def enter_spin():\n    raise RuntimeError({message!r})", scope)
    try:
        scope["enter_spin"]()  # type: ignore[operator]
    except RuntimeError as error:
        return error
    raise AssertionError


def test_a_refused_spin_within_a_spin_is_shown_where_it_is() -> None:
    stuck = deadlock.find_refused(refusal("Executor is already spinning"), 1_500_000_000)
    assert stuck is not None
    text = stuck.text
    assert stuck.kind == "callback"
    assert "Your node is stuck here, at 1.50 s" in text
    assert 'scope["enter_spin"]()' in text
    assert "Do not wait in a callback" in text


def test_other_exceptions_are_what_they_are() -> None:
    assert deadlock.find_refused(refusal("Executor is already spinning", "controller"), 0) is None
    assert deadlock.find_refused(refusal("No"), 0) is None


def test_executors_that_refuse_a_spin_within_a_spin_do_not_any_more(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    class Executor:
        _is_spinning = False

        def _enter_spin(self) -> None:
            if self._is_spinning:
                raise RuntimeError("Executor is already spinning")
            self._is_spinning = True

    monkeypatch.setattr(rclpy.executors, "Executor", Executor)
    executor.allow_nested_spins()
    spun = Executor()
    spun._enter_spin()
    spun._enter_spin()
    assert spun._is_spinning
