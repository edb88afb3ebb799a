"""The right console script is chosen, and its module is taken from the submission alone."""

import pytest

from grader.errors import SubmissionError
from grader.recording.subject import Role
from grader.run.opening import open_submission
from grader.submission.program import EntryPoint
from grader.submission.program_source import roles_in
from tests.files import lay
from tests.grader.submission.copies import GUARDED, NODE, below, found_in, refused

SETUP = """
from setuptools import find_packages, setup
package_name = '{package}'
setup(
    name=package_name,
    packages=find_packages(exclude=['test']),
    entry_points={{'console_scripts': [{entries}]}},
)
"""
TARGET = "spiral.turtle_controller:main"


def package(name, *entries, module="turtle_controller"):
    listed = ", ".join(map(repr, entries or (f"turtle_controller = {name}.{module}:main",)))
    return {
        "package.xml": f"<package format='3'><name>{name}</name></package>",
        "setup.py": SETUP.format(package=name, entries=listed),
        "setup.cfg": f"[develop]\nscript_dir=$base/lib/{name}\n",
        f"resource/{name}": "",
        f"{name}/__init__.py": "",
        f"{name}/{module}.py": GUARDED,
        "test/test_flake8.py": "def main():\n    pass\n",
    }


def test_turtle_controller_is_preferred_and_the_only_script_needs_no_particular_name(tmp_path):
    lay(tmp_path / "two", package("spiral", f"a = {TARGET}", f"turtle_controller = {TARGET}"))
    said = "console script {} in setup.py"
    assert str(found_in(tmp_path / "two").found) == said.format("turtle_controller")
    assert str(found_in(tmp_path / "two", "a").found) == said.format("a")
    only = found_in(lay(tmp_path / "one", package("spiral", f"draw = {TARGET}")))
    assert only.entry == EntryPoint("spiral.turtle_controller", "main")


SPIRAL = package("spiral")
TEXT = {"spiral/turtle_controller.py.txt" if "controller" in name else name: text
        for name, text in SPIRAL.items()}  # fmt: skip
TWO = package("spiral", module="draw") | {"spiral/pens.py": GUARDED}
NO_SCRIPTS = {"setup.py": SETUP.format(package="spiral", entries="")}
OTHERS = "class Node: ...\ndef Main(): ...\n"


@pytest.mark.parametrize(
    ("files", "executable", "words"),
    [
        (package("spiral", f"a = {TARGET}", f"b = {TARGET}"), None, "programs to start: a, b"),
        (package("spiral", f"a = {TARGET}", f"b = {TARGET}"), None, "--executable NAME"),
        (SPIRAL, "spirral", "no program spirral; it has: turtle_controller"),
        # a module is never taken from elsewhere
        (package("spiral", "x = json.tool:main"), None, "there is no file json/tool.py"),
        (
            package("spiral", "x = spiral.turtle_controler:main"),
            *(None, "no file spiral/turtle_controler.py. Near: spiral/turtle_controller.py."),
        ),
        (TEXT, None, "Near: spiral/turtle_controller.py.txt."),
        (
            SPIRAL | {"spiral/turtle_controller.py": OTHERS},
            *(None, "turtle_controller.py defines no function main (it defines: Main, Node)"),
        ),
        (TWO | NO_SCRIPTS, None, "setup.py names no console script"),
        (TWO | NO_SCRIPTS, None, "'turtle_controller = my_package.turtle_controller:main'"),
    ],
)
def test_what_names_no_program_of_the_package_is_refused_with_what_there_is(
    tmp_path, files, executable, words
):
    assert words in refused(lay(tmp_path, files), executable)


@pytest.mark.parametrize("script", ["turtle_controller", "draw"])
def test_the_same_script_in_two_packages_is_refused_unless_its_package_is_told(tmp_path, script):
    for name in ("a", "b"):
        entry = f"{script} = {name}.turtle_controller:main"
        lay(tmp_path, below(f"src/{name}", package(name, entry)))
    assert f"{script} more than once: src/a/setup.py, src/b/setup.py" in refused(tmp_path)
    assert found_in(tmp_path, f"b/{script}").entry == EntryPoint("b.turtle_controller", "main")


def test_the_package_is_found_in_a_workspace_and_may_be_called_test(tmp_path):
    lay(tmp_path, below("src/test", package("test")))
    lay(tmp_path, below("install/test", package("test")))
    lay(tmp_path, {"src/msgs/package.xml": "", "src/msgs/CMakeLists.txt": ""})
    submission = found_in(tmp_path)
    assert submission.root == tmp_path / "src/test"
    assert submission.entry == EntryPoint("test.turtle_controller", "main")
    assert str(submission.found) == "console script turtle_controller in src/test/setup.py"


def test_of_several_packages_the_one_with_the_script_is_taken(tmp_path):
    lay(tmp_path, below("src/a", package("a", "helper = a.turtle_controller:main")))
    lay(tmp_path, below("src/b", package("b")))
    assert found_in(tmp_path).root == tmp_path / "src/b"
    assert found_in(tmp_path, "helper").root == tmp_path / "src/a"


def test_a_broken_set_up_file_does_not_matter_beside_a_good_one(tmp_path):
    lay(tmp_path, {"src/bad/setup.py": "setup(\n"} | below("src/good", package("good")))
    assert found_in(tmp_path).root == tmp_path / "src/good"
    assert "no program other; it has: turtle_controller" in refused(tmp_path, "other")


@pytest.mark.parametrize(
    ("setup", "why"),
    [
        ("setup(\n", "SyntaxError: '(' was never closed (setup.py, line 1)"),
        ("import no_such_module\n", "No module named 'no_such_module' (setup.py, line 1)"),
        ("import sys\nsys.exit(3)\n", "SystemExit: 3 (setup.py, line 2)"),
        ("import os\nos._exit(3)\n", "ended the process that it ran in (exit code 3)"),
    ],
)
def test_where_setup_py_cannot_be_evaluated_the_program_is_found_as_without_scripts(
    tmp_path, setup, why
):
    submission = found_in(lay(tmp_path, package("spiral") | {"setup.py": setup}))
    assert submission.entry == EntryPoint("spiral.turtle_controller", "main")
    assert str(submission.notes[0]).startswith("colcon would not build this: setup.py ")
    assert str(submission.notes[0]).endswith(why)
    files = package("spiral", module="draw") | {"spiral/pens.py": GUARDED, "setup.py": setup}
    assert refused(lay(tmp_path / "several", files)).endswith(f"{why}.")


def test_the_one_program_of_a_setup_py_without_scripts_is_started_and_the_line_told(tmp_path):
    submission = found_in(lay(tmp_path, SPIRAL | NO_SCRIPTS))
    assert submission.entry == EntryPoint("spiral.turtle_controller", "main")
    assert submission.root == tmp_path
    (note,) = (note for note in map(str, submission.notes) if note.startswith("setup.py names no"))
    assert "'turtle_controller = spiral.turtle_controller:main'" in note


def test_a_module_of_another_submission_is_out_of_reach(tmp_path):
    setup = SETUP.format(package="alice", entries="'turtle_controller = bob.node:main'")
    setup = setup.replace("name=", "package_dir={'': '../'}, name=")
    lay(tmp_path, {"alice/setup.py": setup, "bob/node.py": NODE})
    assert "no file bob/node.py" in refused(tmp_path / "alice")


def test_a_source_layout_is_imported_from_its_folder(tmp_path):
    setup = SETUP.format(package="s", entries="'turtle_controller = s.node:main'")
    setup = setup.replace("exclude=", "where='src', exclude=")
    lay(tmp_path, {"setup.py": setup, "src/s/__init__.py": "", "src/s/node.py": NODE})
    assert found_in(tmp_path).root == tmp_path / "src"


def test_a_missing_init_file_is_added_to_a_copy(tmp_path):
    files = package("turtlesim_challenge")
    del files["turtlesim_challenge/__init__.py"]
    with open_submission(lay(tmp_path, files)) as submission:
        assert submission.root != tmp_path
        added = submission.root / "turtlesim_challenge"
        assert (added / "__init__.py").read_text() == ""
        assert submission.with_original_paths(f"{added}") == f"{tmp_path / added.name}"
        assert (added / "turtle_controller.py").read_text() == GUARDED
        assert "with the missing turtlesim_challenge/__init__.py added" in str(submission.found)
    assert not submission.root.exists()
    assert not (tmp_path / "turtlesim_challenge/__init__.py").exists()


def publishing(topic):
    return f"def make(node):\n    node.create_publisher(str, {topic!r}, 10)\n\n\n{GUARDED}"


FOUR = {"a": "'topic'", "b": "'/topic'", "c": "'other'", "d": "names[0]"}
SOURCES = {f"spiral/{name}.py": publishing("x").replace("'x'", at) for name, at in FOUR.items()}


@pytest.mark.parametrize(
    ("scripts", "started"), [("acd", "a"), ("dcb", "b"), ("cd", None), ("ab", None), ("ba", None)]
)
def test_of_several_scripts_the_one_that_has_what_the_exercise_names_is_started(
    tmp_path, scripts, started
):
    files = package("spiral", *(f"{each} = spiral.{each}:main" for each in scripts)) | SOURCES
    asked = {"roles": (Role("publisher", "/topic"),), "name": "talker"}
    lay(tmp_path, files)
    if started is not None:
        with open_submission(tmp_path, **asked) as submission:
            assert submission.programs[0].executable == started
    else:
        said = f"several programs to start: {', '.join(scripts)}. Expected one called talker"
        with pytest.raises(SubmissionError, match=said), open_submission(tmp_path, **asked):
            pass


@pytest.mark.parametrize(("wanted", "started"), [("*draw*", "my_draw_node"), ("b", "b")])
def test_an_exercise_may_name_its_program_by_a_pattern(tmp_path, wanted, started):
    scripts = [f"{each} = {TARGET}" for each in ("a", "my_draw_node", "b")]
    lay(tmp_path, package("spiral", *scripts))
    with open_submission(tmp_path, programs=(wanted,)) as submission:
        assert submission.programs[0].executable == started
    with (
        pytest.raises(SubmissionError, match="no program"),
        open_submission(tmp_path, "*d*"),
    ):
        pass


def test_a_pattern_is_one_of_files_too(tmp_path):
    lay(tmp_path, {"a_node.py": GUARDED, "my_draw.py": GUARDED, "other.py": GUARDED})
    with open_submission(tmp_path, programs=("*draw*",)) as submission:
        assert submission.programs[0].executable == "my_draw.py"


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("create_publisher(String, f'/{self.name}/cmd', 10)", "/*/cmd"),
        ("create_publisher(String, 'a' + '/b', qos_profile=10)", "/a/b"),
        ("create_publisher(String, topic='~/c')", "/*/c"),
        ("create_publisher(String, TOPIC, 10)", "/of_a_constant"),
        ("create_publisher(String, topics[0], 10)", "/*"),
    ],
)
def test_a_name_is_read_as_far_as_the_source_has_it(tmp_path, text, name):
    file = tmp_path / "node.py"
    file.write_text(f"TOPIC = 'of_a_constant'\nself.{text}\n")
    assert roles_in([file]) == {Role("publisher", name)}
