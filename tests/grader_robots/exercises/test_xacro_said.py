"""What xacro says comes down to what a student can use."""

import pytest

from grader_robots.exercises.description_package.robots import xacro_advice, xacro_brief

#: What xacro 2.1.1 says of a file, in the package `crab`.
WHEN = "when processing file: /prefix/share/crab/urdf/crab.urdf.xacro"
CHECK = (
    "Check that: - Your XML is well-formed - You have the xacro xmlns declaration: "
    'xmlns:xacro="http://www.ros.org/wiki/xacro"'
)


@pytest.mark.parametrize(
    ("said", "brief"),
    [
        (
            f"XML parsing error: mismatched tag: line 9 {WHEN} {CHECK}",
            "XML parsing error: mismatched tag: line 9",
        ),
        (
            f"error: No such file or directory: /prefix/share/crab/urdf/legs.xacro {WHEN}",
            "No such file or directory: urdf/legs.xacro",
        ),
        (
            "error: name 'r' is not defined when instantiating macro: leg (/prefix/a.xacro)",
            "name 'r' is not defined when instantiating macro: leg (/prefix/a.xacro)",
        ),
    ],
)
def test_what_only_hides_the_line_is_left_out_and_files_are_called_as_in_the_package(said, brief):
    assert xacro_brief(f"xacro: {said}", "crab") == f"xacro: {brief}"


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("XML parsing error: unbound prefix: line 3, column 2", "<robot xmlns:xacro="),
        ("XML parsing error: mismatched tag: line 49, column 2", "at that line or above"),
        ("error: name 'base_lenght' is not defined", 'name="base_lenght"'),
        ("error: unknown macro name: xacro:weel", "Compare the names"),
        ("error: Undefined parameters [sign]", "NAME:=VALUE"),
        ('error: Invalid parameter "x"', "has no such parameter"),
        ("error: can't multiply sequence by non-int of type 'str'", "not a comma"),
        ("error: what nobody has thought of", "Run xacro by hand"),
    ],
)
def test_each_fault_has_its_own_advice(said, words):
    assert words in str(xacro_advice(f"xacro: {said} {WHEN}"))
