"""What a launch file's error is answered by."""

import pytest

from grader.submission.error_texts import advice


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (
            "SubstitutionFailure: launch configuration 'modell' does not exist",
            "DeclareLaunchArgument",
        ),
        ("ValueError: too many values to unpack (expected 2)", ".items()"),
        ("TypeError: Failed to normalize given item of type '<class 'float'>'", "'0.1'"),
        ("TypeError: Expected 'parameters' given to Node to be one of ['list'], dict", "[{...}]"),
        ("TypeError: launch_setup() returned Node, expected a list of actions", "[node]"),
        (
            "TypeError: Attribute 'if' of Entity 'node' expected to be of type '<class 'str'>', "
            "got '<class 'bool'>'",
            "'true'",
        ),
        ("NameError: name 'x' is not defined", "`ros2 launch` says the same"),
    ],
)
def test_a_usual_error_has_its_own_advice(error, words):
    assert words in str(advice(error))
