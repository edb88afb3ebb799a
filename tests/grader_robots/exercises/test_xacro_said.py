"""What xacro says comes down to what a student can use."""

import pytest

from grader_robots.exercises.description_package.robots import xacro_advice, xacro_brief

#: What xacro 2.1.1 says of a file, in the package `crab`.
WHEN = "when processing file: /prefix/share/crab/urdf/crab.urdf.xacro"
CHECK = (
    "Check that: - Your XML is well-formed - You have the xacro xmlns declaration: "
    'xmlns:xacro="http://www.ros.org/wiki/xacro"'
)


def test_its_list_of_what_to_check_is_left_out_where_it_only_hides_the_line():
    said = f"xacro: XML parsing error: mismatched tag: line 49, column 2 {WHEN} {CHECK}"
    assert (
        xacro_brief(said, "crab") == "xacro: XML parsing error: mismatched tag: line 49, column 2"
    )


def test_files_are_called_as_in_the_package():
    said = f"xacro: error: No such file or directory: /prefix/share/crab/urdf/legs.xacro {WHEN}"
    assert xacro_brief(said, "crab") == "xacro: No such file or directory: urdf/legs.xacro"


def test_the_macro_in_which_it_happens_stays():
    said = "xacro: error: name 'r' is not defined when instantiating macro: leg (/prefix/a.xacro)"
    assert "when instantiating macro: leg" in xacro_brief(said, "crab")


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
