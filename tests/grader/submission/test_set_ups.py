"""What an inspection says of set-up files is held against them."""

import pytest

from grader.errors import SubmissionError
from grader.submission.answer import SetUp, SetUpFacts
from grader.submission.entry_points import find_packages
from grader.submission.folder import SubmissionFolder
from grader.submission.set_ups import read_package
from tests.files import lay


def read(folder, *scripts, package_folders=(), **texts):
    lay(folder, {"setup.py": "", "setup.cfg": "", "pyproject.toml": "", **texts})
    declared = SetUpFacts(scripts=scripts, package_folders=package_folders)
    return read_package(SetUp(".", declared, None), SubmissionFolder("pkg", folder))


@pytest.mark.parametrize(
    ("line", "target"),
    [
        ("go = pkg.node:main", ("pkg.node", "main")),
        ("go=pkg.node:main [extra]", ("pkg.node", "main")),
        (" go  =  node : Node.main ", ("node", "Node.main")),
    ],
)
def test_a_console_script_is_a_name_with_a_module_and_a_function(tmp_path, line, target):
    (script,) = read(tmp_path, line).executables
    assert (script.name, script.module, script.function) == ("go", *target)


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ("pkg.node:main", "'pkg.node:main'"),
        ("go = pkg.node.main", "'go = pkg.node.main'"),
        ("go = pkg.node:main()", "'go = pkg.node:main()'"),
        ("go = my-pkg.node:main", "'go = my-pkg.node:main'"),
        ("go = a:mainstop = b:main", "A comma seems to be missing"),
    ],
)
def test_an_entry_that_no_tool_could_install_is_refused(tmp_path, entry, words):
    with pytest.raises(SubmissionError) as error:
        read(tmp_path, entry)
    assert words in str(error.value)
    assert "Expected 'name = package.module:function'" in str(error.value)


@pytest.mark.parametrize("named", ["setup.cfg", "pyproject.toml", "setup.py"])
def test_a_script_is_told_by_the_file_that_has_its_name(tmp_path, named):
    (script,) = read(tmp_path, "go = pkg.node:main", **{named: "go: pkg.node:main"}).executables
    assert script.file == tmp_path / named


def test_a_script_whose_name_no_file_has_is_of_setup_py(tmp_path):
    (script,) = read(tmp_path, "computed = pkg.node:main").executables
    assert script.file == tmp_path / "setup.py"


@pytest.mark.parametrize(
    ("folders", "roots"),
    [
        ((), (".", "src")),
        (("=lib",), ("lib",)),
        (("pkg=lib/pkg",), ("lib", ".", "src")),
        (("pkg=other",), (".", "src")),
        (("=..",), (".",)),
        (("=/etc",), (".",)),
        (("=a\0b",), (".",)),
    ],
)
def test_the_folders_to_import_from_lie_in_the_package(tmp_path, folders, roots):
    package = read(tmp_path, package_folders=folders)
    assert package.roots("pkg.node") == [tmp_path / root for root in roots]


def test_a_file_that_a_set_up_claims_to_install_is_not_read_through_a_link(tmp_path):
    lay(tmp_path, {"mine/setup.py": "", "theirs/solution.py": "import rclpy\n"})
    (tmp_path / "mine/go.py").symlink_to("../theirs/solution.py")
    submitted = SubmissionFolder("mine", tmp_path / "mine")
    packages = find_packages(submitted, [SetUp(".", installed={"lib/mine/go": "go.py"})])
    (choice,) = packages.every
    with pytest.raises(SubmissionError, match=r"go\.py is a link to a place outside of mine"):
        packages.found(packages.program(*choice))
