"""Where rclpy is made otherwise than we know, what a witness has seen counts for nothing."""

from __future__ import annotations

from collections.abc import Callable

import pytest
import rclpy.action.client
import rclpy.publisher

from grader.run.student import hooks
from grader.run.student.telling import Teller
from grader.run.student.witness import Witness


class Listener(Teller):
    """Keeps what is told instead of sending it."""

    def __init__(self) -> None:
        self.told: list[tuple[str, object, bool]] = []

    def tell(self, what: str, value: object, *, is_last: bool = False) -> None:
        self.told.append((what, value, is_last))


@pytest.mark.parametrize(
    ("install", "module", "name"),
    [
        (hooks.install, rclpy.publisher, "Publisher"),
        (hooks.install_actions, rclpy.action.client, "ActionClient"),
    ],
)
def test_of_an_unknown_rclpy_a_witness_says_that_it_is_blind(
    monkeypatch: pytest.MonkeyPatch,
    install: Callable[[Witness], None],
    module: object,
    name: str,
) -> None:
    monkeypatch.delattr(module, name)
    listener = Listener()
    install(Witness(listener, lambda kind, entity: lambda: False))
    assert listener.told == [("blind", True, True)]  # there is always room for that
