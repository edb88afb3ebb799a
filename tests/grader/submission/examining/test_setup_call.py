"""A set-up is what setuptools makes of its three files, of which it runs and fetches nothing."""

import pytest

from grader.submission.answer import DataFiles, SetUpFacts
from grader.submission.examining.setup_call import evaluate, run_setup
from grader.submission.examining.steps import Ended, step
from grader.system.strict_json import from_json

SETUP = "from setuptools import setup\n"
ONLY_CALLS = f"{SETUP}setup()\n"


def told(folder, **files):
    """What is said by files: setup_py, setup_cfg, pyproject_toml, ..."""
    for name, text in files.items():
        (folder / ".".join(name.rsplit("_", 1))).write_text(text)

    def own(path):
        return path.removeprefix(f"{folder}/") if path.startswith(f"{folder}/") else ""

    return from_json(SetUpFacts, step(lambda: run_setup(folder), own))


def test_what_setup_cfg_lists_is_installed(tmp_path):
    (tmp_path / "launch").mkdir()
    (tmp_path / "launch" / "a.launch.py").touch()
    config = """
[metadata]
name = walker
[options]
packages = walker
[options.entry_points]
console_scripts =
    walk = walker.walk:main
[options.data_files]
share/walker = package.xml
share/walker/launch = launch/*
[install]
install_scripts=$base/lib/walker
"""
    assert told(tmp_path, setup_py=ONLY_CALLS, setup_cfg=config) == SetUpFacts(
        name="walker",
        data_files=(
            DataFiles("share/walker", ("package.xml",)),
            DataFiles("share/walker/launch", ("launch/a.launch.py",)),
        ),
        scripts=("walk = walker.walk:main",),
        packages=("walker",),
        scripts_folder="lib/walker",
    )


def test_where_there_is_no_setup_py_what_pyproject_toml_lists_is_installed(tmp_path):
    project = """
[project]
name = "walker"
version = "0.1.0"
scripts = {walk = "walker.walk:Node.main"}
[tool.setuptools]
data-files = {"share/walker" = ["package.xml"]}
[tool.setuptools.packages.find]
where = ["src"]
"""
    (tmp_path / "src" / "walker").mkdir(parents=True)
    (tmp_path / "src" / "walker" / "__init__.py").touch()
    assert told(tmp_path, pyproject_toml=project) == SetUpFacts(
        name="walker",
        data_files=(DataFiles("share/walker", ("package.xml",)),),
        scripts=("walk = walker.walk:Node.main",),
        packages=("walker",),
        package_folders=("=src",),
    )


def test_entry_points_may_be_one_text(tmp_path):
    points = "entry_points='[console_scripts]\\nwalk = walker.walk:main'"
    assert told(tmp_path, setup_py=f"{SETUP}setup({points})").scripts == (
        "walk = walker.walk:main",
    )


def test_the_last_call_counts_and_distutils_may_be_asked(tmp_path):
    text = f"{SETUP}setup(name='a')\nfrom distutils.core import setup\nsetup(name='b')\n"
    assert told(tmp_path, setup_py=text).name == "b"


def test_no_command_is_run_and_no_class_of_the_package_s_own_made(tmp_path):
    text = """
from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

class Fails(build_py):
    def __init__(self, *_):
        raise AssertionError

class Other(Distribution):
    def __init__(self, *_):
        raise AssertionError

setup(name="walker", cmdclass={"build_py": Fails, "install": Fails}, distclass=Other)
"""
    assert told(tmp_path, setup_py=text) == SetUpFacts(name="walker", has_commands=True)


def test_nothing_is_fetched(tmp_path):
    text = f"{SETUP}setup(name='walker', setup_requires=['is_not_there_xyz>=3'])\n"
    config = "[options]\nsetup_requires = is_not_there_xyz\n"
    assert told(tmp_path, setup_py=text, setup_cfg=config).name == "walker"


@pytest.mark.parametrize("group", ["distutils.setup_keywords", "distutils.commands"])
def test_no_plugin_is_loaded(group, tmp_path):
    info = tmp_path / "plugin-1.dist-info"
    info.mkdir()
    groups = (group, "setuptools.finalize_distribution_options")
    lines = [f"[{each}]\nplugin = plugin:fail\n" for each in groups]
    (info / "entry_points.txt").write_text("".join(lines))
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: plugin\nVersion: 1\n")
    text = f"{SETUP}setup(name='walker', plugin=1)\n"
    plugin = "def fail(*_):\n    raise AssertionError\nfail()\n"
    assert told(tmp_path, setup_py=text, plugin_py=plugin).name == "walker"


@pytest.mark.parametrize(
    ("text", "says", "line"),
    [
        (f"{SETUP}setup(\n  name=nmae)", "NameError: name 'nmae' is not defined", 3),
        (f"{SETUP}setup(name='a'", "SyntaxError: '(' was never closed", 2),
        (f"{SETUP}setup(install_requires=['?'])", "", 2),
        (SETUP, "RuntimeError: setup.py never calls setup()", 0),
        (
            f"{SETUP}setup(data_files=['a', ('b', 'c')])",
            "TypeError: data_files: expected a list",
            0,
        ),
    ],
)
def test_how_a_set_up_ends_is_told_with_its_line(text, says, line, tmp_path):
    with pytest.raises(Ended) as ended:
        told(tmp_path, setup_py=text)
    problem = ended.value.problem
    assert str(problem.text).startswith(says)
    assert (problem.file, problem.line) == ("setup.py" if line else "", line)


def test_a_set_up_that_spoils_setuptools_answers_for_itself_alone(tmp_path):
    text = f"import setuptools\nsetuptools.Distribution.__init__ = None\n{ONLY_CALLS}"
    other = tmp_path / "other"
    other.mkdir()
    with pytest.raises(Ended):
        told(other, setup_py=text)
    assert told(tmp_path, setup_py=f"{SETUP}setup(name='walker')").name == "walker"


@pytest.mark.parametrize(
    ("name", "text"), [("pyproject.toml", "[project\n"), ("setup.cfg", "no section\n")]
)
def test_a_file_that_is_not_written_in_its_language_is_named(name, text, tmp_path):
    (tmp_path / name).write_text(text)
    found, problem = evaluate(tmp_path)
    assert found == SetUpFacts()
    assert problem.file == name
