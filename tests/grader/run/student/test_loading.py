"""Lists of numbers in a message take ints and arrays, as where nothing checks them; no more."""

import array

import numpy as np
import pytest

from grader.run.student.loading import convert_lists


def message_class():
    """Checks as a generated message does."""

    class Message:
        @classmethod
        def get_fields_and_field_types(cls):
            return {"position": "sequence<double>", "name": "sequence<string>"}

        @property
        def position(self):
            return self._position

        @position.setter
        def position(self, value):
            if not isinstance(value, array.array):
                assert all(isinstance(each, float) for each in value)
            self._position = array.array("d", value)

    return Message


@pytest.mark.parametrize("value", [[0, 1], (0.0, 1.0), np.array([0, 1]), np.float32([0, 1])])
def test_numbers_become_floats(value):
    kind = message_class()
    convert_lists(kind)
    convert_lists(kind)  # by a second publisher
    message = kind()
    message.position = value
    assert message.position.tolist() == [0.0, 1.0]


@pytest.mark.parametrize("value", [["a"], [None], [[1.0]]])
def test_anything_else_is_still_refused_by_the_message(value):
    kind = message_class()
    convert_lists(kind)
    with pytest.raises(AssertionError):
        kind().position = value
