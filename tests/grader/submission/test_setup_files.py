"""Console scripts are read from every usual way to write them down, without running any."""

from pathlib import Path

import pytest

from grader.errors import SubmissionError
from grader.submission.folder import HandedIn
from grader.submission.setup_files import Package, read_package


def read(folder: Path, **files: str) -> Package:
    for name, text in files.items():
        (folder / name.replace("_dot_", ".")).write_text(text)
    package = read_package(folder, HandedIn("pkg", folder))
    assert package is not None
    return package


def scripts(package: Package) -> dict[str, str]:
    return {script.name: f"{script.module}:{script.function}" for script in package.scripts}


@pytest.mark.parametrize(
    "text",
    [
        "setup(entry_points={'console_scripts': ['go = pkg.node:main']})",
        "setup(entry_points={'console_scripts': ('go=pkg.node:main [extra]',)})",
        "setup(entry_points={'console_scripts': 'go = pkg.node:main'})",
        "setuptools.setup(entry_points=dict(console_scripts=['go = pkg.node:main']))",
        "p = 'pkg'\nsetup(entry_points={'console_scripts': [f'go = {p}.node:main']})",
        "p = 'pkg'\nsetup(entry_points={'console_scripts': ['go = ' + p + '.node:main']})",
        "p = 'pkg'\nsetup(entry_points={'console_scripts': ['go = %s.node:main' % p]})",
        "p = 'pkg'\nsetup(entry_points={'console_scripts': ['go = %s.%s:main' % (p, 'node')]})",
        "setup(entry_points={'console_scripts': ['go = %(p)s.node:main' % {'p': 'pkg'}]})",
        "p = 'pkg'\nsetup(entry_points={'console_scripts': ['go = {}.node:main'.format(p)]})",
        "setup(entry_points={'console_scripts': ['go = {p}.{0}:main'.format('node', p='pkg')]})",
        "s = ['go = pkg.node:main']\nsetup(entry_points={'console_scripts': s + []})",
        "e = {'console_scripts': ['go = pkg.node:main']}\nsetup(entry_points=e)",
        "c = dict(entry_points={'console_scripts': ['go = pkg.node:main']})\nsetup(**c)",
        "def f():\n  e: dict = {'console_scripts': ['go=pkg.node:main']}\n  setup(entry_points=e)",
        "setup(entry_points='[gui_scripts]\\nno = a:b\\n[console_scripts]\\n  go = pkg.node:main')",
    ],
)
def test_setup_py(tmp_path: Path, text: str) -> None:
    package = read(tmp_path, setup_dot_py=text)
    assert scripts(package) == {"go": "pkg.node:main"}
    assert package.has_setup_py
    assert not package.unread


@pytest.mark.parametrize(
    "scripts_code",
    [
        "[f'{n} = pkg.{n}:main' for n in names]",
        "['go = pkg.%9d:main' % 1]",
        "['go = {:>9}:main'.format('a')]",
        "['go = {a.b}:main'.format(a='a')]",
        "[p + '.node:main']",
        "unbound",
        "itself",
        "changed",
        "grown",
    ],
)
def test_what_only_a_run_could_tell_is_not_guessed(tmp_path: Path, scripts_code: str) -> None:
    before = (
        "p = 'go = a'\nif x:\n    p = 'go = b'\nitself = itself + []\n"
        "changed = ['go = a:b']\nchanged.append(compute())\n"
        "grown = {'x': ['go = a:b']}\ngrown['y']['z'] = 1\n"
    )
    text = f"{before}setup(entry_points={{'console_scripts': {scripts_code}}})\n"
    package = read(tmp_path, setup_dot_py=text)
    assert scripts(package) == {}
    assert package.unread == (tmp_path / "setup.py",)


def test_a_chain_of_doublings_is_not_followed_to_its_end(tmp_path: Path) -> None:
    lines = ["a0 = 'xxxxxxxx'", *(f"a{i + 1} = a{i} + a{i}" for i in range(60))]
    text = "\n".join([*lines, "setup(entry_points={'console_scripts': [a60]})"])
    assert read(tmp_path, setup_dot_py=text).unread


def test_one_unreadable_entry_does_not_hide_the_others(tmp_path: Path) -> None:
    text = "setup(entry_points={'console_scripts': ['go = pkg.node:main', compute()]})"
    package = read(tmp_path, setup_dot_py=text)
    assert scripts(package) == {"go": "pkg.node:main"}
    assert package.unread


def test_setup_cfg(tmp_path: Path) -> None:
    text = (
        "[options]\npackage_dir =\n    =src\n"
        "[options.packages.find]\nwhere = lib\n"
        "[options.entry_points]\nconsole_scripts =\n    # ours\n    Go = pkg.node:main\n"
    )
    package = read(tmp_path, setup_dot_cfg=text, setup_dot_py="setup()")
    assert scripts(package) == {"Go": "pkg.node:main"}
    assert package.source_folders == ("src", "lib")


def test_pyproject_toml(tmp_path: Path) -> None:
    text = (
        "[project.scripts]\ngo = 'pkg.node:Node.main'\n"
        "[tool.setuptools.packages.find]\nwhere = ['src']\n"
    )
    package = read(tmp_path, pyproject_dot_toml=text)
    assert scripts(package) == {"go": "pkg.node:Node.main"}
    assert package.source_folders == ("src",)
    assert not package.has_setup_py


def test_poetry(tmp_path: Path) -> None:
    text = (
        "[tool.poetry]\npackages = [{include = 'pkg', from = 'lib'}]\n"
        "[tool.poetry.scripts]\na = 'pkg.node:main'\n"
        "b = {reference = 'pkg.node:main', type = 'console'}\n"
        "c = {reference = 'c.sh', type = 'file'}\n"
    )
    package = read(tmp_path, pyproject_dot_toml=text)
    assert scripts(package) == {"a": "pkg.node:main", "b": "pkg.node:main"}
    assert package.source_folders == ("lib",)


def test_pyproject_toml_has_the_last_word_on_a_name(tmp_path: Path) -> None:
    package = read(
        tmp_path,
        setup_dot_py="setup(entry_points={'console_scripts': ['go = old:main', 'b = b:main']})",
        pyproject_dot_toml="[project.scripts]\ngo = 'new:main'\n",
    )
    assert scripts(package) == {"go": "new:main", "b": "b:main"}


def test_a_folder_without_set_up_files_is_no_package(tmp_path: Path) -> None:
    assert read_package(tmp_path, HandedIn("pkg", tmp_path)) is None


def test_a_file_called_setup_py_need_not_be_one(tmp_path: Path) -> None:
    assert not read(tmp_path, setup_dot_py="def main(): ...\n").has_setup_py


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
def test_an_entry_that_no_tool_could_install_is_refused(
    tmp_path: Path, entry: str, words: str
) -> None:
    text = f"setup(entry_points={{'console_scripts': ['{entry}']}})"
    with pytest.raises(SubmissionError) as error:
        read(tmp_path, setup_dot_py=text)
    assert words in str(error.value)
    assert "Expected 'name = package.module:function'" in str(error.value)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("setup.py", "setup(\n"),
        ("setup.py", "\0"),
        ("setup.py", "setup(" + "(" * 5000),
        ("setup.py", "setup(name=" + "+".join(["'a'"] * 50_000) + ")"),
        ("setup.cfg", "no section\n"),
        ("pyproject.toml", "[project\n"),
        ("pyproject.toml", "a = " + "[" * 5000),
        ("setup.py", "#" * 1_000_001),
    ],
)
def test_a_set_up_file_that_cannot_be_read_is_named(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(SubmissionError, match=f"^{name} ") as error:
        read_package(tmp_path, HandedIn("pkg", tmp_path))
    assert str(tmp_path) not in str(error.value)


def test_a_set_up_file_may_hold_bytes_that_are_not_text_in_its_comments_only(
    tmp_path: Path,
) -> None:
    (tmp_path / "setup.cfg").write_bytes(b"\xff")
    with pytest.raises(SubmissionError, match=r"^setup\.cfg cannot be read: 'utf-8'"):
        read_package(tmp_path, HandedIn("pkg", tmp_path))


@pytest.mark.parametrize(
    ("arguments", "roots"),
    [
        ("", (".", "src")),
        ("package_dir={'': 'lib'}", ("lib",)),
        ("package_dir={'pkg': 'lib/pkg'}", ("lib", ".", "src")),
        ("package_dir={'pkg': 'other'}", (".", "src")),
        ("package_dir={'': '..'}", (".",)),
        ("package_dir={'': '/etc'}", (".",)),
        ("packages=find_packages('lib')", ("lib",)),
        ("packages=find_namespace_packages(where='lib')", ("lib",)),
    ],
)
def test_the_folders_to_import_from(tmp_path: Path, arguments: str, roots: tuple[str, ...]) -> None:
    package = read(tmp_path, setup_dot_py=f"setup({arguments})")
    assert package.roots("pkg.node") == [tmp_path / root for root in roots]
