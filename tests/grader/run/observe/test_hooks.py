"""Where rclpy is made otherwise than we know, what a witness has seen counts for nothing."""

import json
import os

import pytest
import rclpy.action.client
import rclpy.publisher

from grader.run.observe import account, hooks
from grader.run.observe.witness import Witness


@pytest.mark.parametrize(
    ("install", "module", "name"),
    [
        (hooks.install, rclpy.publisher, "Publisher"),
        (hooks.install_actions, rclpy.action.client, "ActionClient"),
    ],
)
def test_of_an_unknown_rclpy_a_witness_says_that_it_is_blind(monkeypatch, install, module, name):
    monkeypatch.delattr(module, name)
    page = account.make()
    install(Witness(page, "/", lambda: 0.0, lambda kind, entity: lambda: False))
    assert json.loads(account.read(page)[0])["is_blind"]
    os.close(page)
