"""A zip is unpacked below its folder, within its limits, or refused; none is trusted."""

import stat
import zipfile
from pathlib import Path

import pytest

from grader.errors import SubmissionError
from grader.submission.archive import unpack


def pack(archive: Path, *members: str | zipfile.ZipInfo, data: str = "x") -> Path:
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for member in members:
            packed.writestr(member, data)
    return archive


def special(name: str, kind: int) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name)
    info.external_attr = (kind | 0o777) << 16
    return info


def unpacked(archive: Path) -> set[str]:
    into = archive.parent / "unpacked"
    into.mkdir()
    unpack(archive, into)
    return {str(path.relative_to(into)) for path in into.rglob("*") if path.is_file()}


def refused(archive: Path) -> str:
    with pytest.raises(SubmissionError) as error:
        unpacked(archive)
    assert {path.name for path in archive.parent.iterdir()} == {archive.name, "unpacked"}
    return str(error.value)


def test_the_files_of_a_zip_are_written_with_their_folders(tmp_path: Path) -> None:
    assert unpacked(pack(tmp_path / "a.zip", "a.py", "b/", "b/c/d.py")) == {"a.py", "b/c/d.py"}


def test_backslashes_of_windows_are_folders(tmp_path: Path) -> None:
    assert unpacked(pack(tmp_path / "a.zip", "a\\", "a\\b.py")) == {"a/b.py"}


def test_what_programs_filled_stays_out(tmp_path: Path) -> None:
    generated = [
        *("w/.git/config", "w/__pycache__/a.pyc", "__MACOSX/w/._a.py"),
        *("w/my_env/pyvenv.cfg", "w/my_env/lib/a.py"),
        *("w/install/COLCON_IGNORE", "w/install/s/a.py"),
    ]
    link = special("w/my_env/bin/python", stat.S_IFLNK)
    archive = pack(tmp_path / "a.zip", *generated, link, "w/src/a.py", "w/test/b.py")
    assert unpacked(archive) == {"w/src/a.py", "w/test/b.py"}


@pytest.mark.parametrize(
    "member", ["../a.py", "a/../../b.py", "/etc/a.py", "C:\\a.py", "..\\a.py", ".git/../../a.py"]
)
def test_a_member_that_leaves_the_folder_is_refused(tmp_path: Path, member: str) -> None:
    text = refused(pack(tmp_path / "a.zip", member))
    assert f"a.zip holds {member}, which would be written outside of its own folder" in text


def test_a_symbolic_link_is_refused(tmp_path: Path) -> None:
    archive = pack(tmp_path / "a.zip", special("a.py", stat.S_IFLNK), data="/etc/passwd")
    assert "a.zip holds a.py as a symbolic link" in refused(archive)


def test_a_device_is_refused(tmp_path: Path) -> None:
    archive = pack(tmp_path / "a.zip", special("a.py", stat.S_IFCHR))
    assert "a.py, which is not an ordinary file" in refused(archive)


@pytest.mark.parametrize("members", [[], ["a/"], ["__MACOSX/a"]])
def test_an_empty_zip_is_refused(tmp_path: Path, members: list[str]) -> None:
    assert "a.zip is an empty zip" in refused(pack(tmp_path / "a.zip", *members))


def test_a_zip_of_no_bytes_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.zip").touch()
    assert "a.zip is empty (0 bytes)" in refused(tmp_path / "a.zip")


def test_something_else_called_zip_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.zip").write_text("Rar!")
    assert "a.zip cannot be unpacked as a zip file: File is not a zip file." in refused(
        tmp_path / "a.zip"
    )


@pytest.mark.parametrize(
    "method", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]
)
def test_a_damaged_zip_is_refused(tmp_path: Path, method: int) -> None:
    archive = tmp_path / "a.zip"
    with zipfile.ZipFile(archive, "w", method) as packed:
        packed.writestr("a.py", "".join(map(str, range(1000))))
    data = bytearray(archive.read_bytes())
    data[60:70] = bytes(10)
    archive.write_bytes(data)
    assert "a.zip cannot be unpacked as a zip file" in refused(archive)


def test_a_zip_that_is_cut_off_is_refused(tmp_path: Path) -> None:
    archive = pack(tmp_path / "a.zip", "a.py", "b.py")
    archive.write_bytes(archive.read_bytes()[:-30])
    assert "a.zip cannot be unpacked as a zip file" in refused(archive)


def test_a_zip_that_points_before_its_start_is_refused(tmp_path: Path) -> None:
    archive = pack(tmp_path / "a.zip", "a.py")
    data = bytearray(archive.read_bytes())
    data[data.index(b"PK\x05\x06") + 17] = 255  # where the central directory claims to be
    archive.write_bytes(data)
    assert "a.zip cannot be unpacked as a zip file" in refused(archive)


def test_a_file_in_the_place_of_a_folder_is_refused(tmp_path: Path) -> None:
    assert "cannot be unpacked" in refused(pack(tmp_path / "a.zip", "a", "a/b.py"))


def test_an_encrypted_zip_is_refused(tmp_path: Path) -> None:
    archive = pack(tmp_path / "a.zip", "a.py")
    data = bytearray(archive.read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1  # the flag in the central directory
    data[6] |= 1  # ... and before the data
    archive.write_bytes(data)
    assert "a.zip is encrypted: a.py asks for a password" in refused(archive)


def test_an_unknown_compression_is_refused(tmp_path: Path) -> None:
    archive = pack(tmp_path / "a.zip", "a.py")
    data = bytearray(archive.read_bytes())
    data[data.index(b"PK\x01\x02") + 10] = data[8] = 9  # deflate64, of Windows
    archive.write_bytes(data)
    assert "packed in a way that cannot be read here" in refused(archive)


def test_a_zip_with_too_many_files_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("grader.submission.archive.MAX_MEMBERS", 2)
    assert "a.zip holds 3 files; the limit for a submission is 2" in refused(
        pack(tmp_path / "a.zip", "a", "b", "c")
    )


def test_a_bomb_is_stopped_while_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("grader.submission.archive.MAX_BYTES", 1_000_000)
    archive = pack(tmp_path / "a.zip", "a", "b", "c", data="0" * 400_000)
    assert archive.stat().st_size < 10_000
    assert "a.zip unpacks to more than 1 MB" in refused(archive)


def test_a_zip_that_is_too_large_is_not_even_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("grader.submission.archive.MAX_BYTES", 10)
    assert "the limit for a submission" in refused(pack(tmp_path / "a.zip", "a"))
