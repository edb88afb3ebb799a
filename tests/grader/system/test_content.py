"""The hash of a folder: of names and contents alone, and the one that sha256sum gives."""

import subprocess

import pytest

from grader.system import content
from tests.files import lay

FILES = {"b.py": "two", "a/x.py": "one", "a b.txt": ""}


@pytest.fixture
def folder(tmp_path):
    """A folder with some files."""
    return lay(tmp_path / "one", FILES)


def test_it_is_what_sha256sum_gives(folder, tmp_path):
    command = (
        "find . -type f -printf '%P\\n' | LC_ALL=C sort | xargs -d '\\n' sha256sum | sha256sum"
    )
    found = subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True)
    assert found.stdout.split()[0] == content.of_folder(folder)
    assert command.rpartition("| ")[2] in (content.__doc__ or "")
    lay(tmp_path / "two", dict(reversed(FILES.items())))
    assert content.of_folder(tmp_path / "two") == content.of_folder(folder)


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: (folder / "b.py").write_text("three"),
        lambda folder: (folder / "b.py").rename(folder / "c.py"),
        lambda folder: (folder / "new.py").touch(),
        lambda folder: (folder / "link").symlink_to("b.py"),
    ],
)
def test_names_and_contents_count(folder, change):
    before = content.of_folder(folder)
    change(folder)
    assert content.of_folder(folder) != before


def test_a_name_with_a_line_end_is_one_name():
    both = {"a": "1" * 64, "b": "2" * 64}
    forged = {f"a\n{'2' * 64}  b": "1" * 64}
    assert content.of_files(forged) != content.of_files(both)
