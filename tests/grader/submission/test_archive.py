"""An archive is unpacked below its folder, within its limits, or refused; none is trusted."""

import gzip
import io
import stat
import tarfile
import zipfile
from pathlib import Path

import pytest

from grader.errors import SubmissionError
from grader.submission.archive import unpack
from grader.submission.safe_members import ArchiveLimits, Budget


def pack(archive: Path, *members: str | zipfile.ZipInfo, data: str = "x") -> Path:
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for member in members:
            packed.writestr(member, data)
    return archive


def special(name: str, kind: int) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name)
    info.external_attr = (kind | 0o777) << 16
    return info


def unpacked(archive: Path, budget: Budget | None = None) -> set[str]:
    into = archive.parent / "unpacked"
    into.mkdir()
    unpack(archive, into, budget or Budget())
    return {str(path.relative_to(into)) for path in into.rglob("*") if path.is_file()}


def refused(archive: Path, budget: Budget | None = None) -> str:
    with pytest.raises(SubmissionError) as error:
        unpacked(archive, budget)
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


def test_what_an_earlier_grading_has_left_stays_out(tmp_path: Path) -> None:
    result = '{"schema": "turtlesim-grader/result/v1"}'
    archive = pack(tmp_path / "a.zip", "w/graded/w/result.json", "w/b/result.json", data=result)
    with zipfile.ZipFile(archive, "a") as packed:
        packed.writestr("w/graded/w/recording/trace.npz", "x")
        packed.writestr("w/b/node.py", "x")
        packed.writestr("w/c/result.json", "{}")
    assert unpacked(archive) == {"w/b/node.py", "w/b/result.json", "w/c/result.json"}


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
    assert "a.zip is an empty archive" in refused(pack(tmp_path / "a.zip", *members))


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


def test_a_zip_with_too_many_files_is_refused(tmp_path: Path) -> None:
    assert "a.zip holds 3 files; the limit for a submission is 2" in refused(
        pack(tmp_path / "a.zip", "a", "b", "c"), Budget(ArchiveLimits(most_files=2))
    )


def test_a_bomb_is_stopped_while_it_is_read(tmp_path: Path) -> None:
    archive = pack(tmp_path / "a.zip", "a", "b", "c", data="0" * 400_000)
    assert archive.stat().st_size < 10_000
    assert "a.zip unpacks to more than 1 MB" in refused(archive, Budget(ArchiveLimits(1_000_000)))


def test_a_zip_that_is_too_large_is_not_even_opened(tmp_path: Path) -> None:
    archive = pack(tmp_path / "a.zip", "a")
    text = refused(archive, Budget(ArchiveLimits(10)))
    assert "a.zip has more than 1e-05 MB, the limit for a submission" in text


def test_several_archives_of_a_submission_have_one_limit(tmp_path: Path) -> None:
    budget = Budget(ArchiveLimits(1_000_000))
    unpack(pack(tmp_path / "a.zip", "a", data="0" * 600_000), tmp_path, budget)
    assert "b.zip unpacks to more than 1 MB" in refused_after(
        pack(tmp_path / "b.zip", "b", data="0" * 600_000), budget
    )


def refused_after(archive: Path, budget: Budget) -> str:
    into = archive.parent / "unpacked"
    into.mkdir()
    with pytest.raises(SubmissionError) as error:
        unpack(archive, into, budget)
    return str(error.value)


# tars


def tar(archive: Path, *members: str | tarfile.TarInfo, data: bytes = b"x") -> Path:
    mode = "w" if archive.suffix == ".tar" else "w:gz"
    with tarfile.open(archive, mode) as packed:  # type: ignore[call-overload]
        for member in members:
            info = tarfile.TarInfo(member) if isinstance(member, str) else member
            info.size = len(data) if info.isreg() else 0
            packed.addfile(info, io.BytesIO(data))
    return archive


def other(name: str, kind: bytes, target: str = "") -> tarfile.TarInfo:
    info = tarfile.TarInfo(name)
    info.type, info.linkname = kind, target
    return info


@pytest.mark.parametrize("name", ["a.tar", "a.tar.gz", "a.tgz", "A.TGZ"])
def test_the_files_of_a_tar_are_written_with_their_folders(tmp_path: Path, name: str) -> None:
    members = ("./a.py", other("b", tarfile.DIRTYPE), "b/c/d.py", "b/" + 120 * "e" + ".py")
    archive = tar(tmp_path / name, *members)
    assert unpacked(archive) == {"a.py", "b/c/d.py", "b/" + 120 * "e" + ".py"}
    assert (tmp_path / "unpacked/a.py").read_bytes() == b"x"
    assert {path.name for path in tmp_path.iterdir()} == {name, "unpacked"}


def test_what_programs_filled_stays_out_of_a_tar_too(tmp_path: Path) -> None:
    link = other("w/venv/bin/python", tarfile.SYMTYPE, "/usr/bin/python3")
    archive = tar(tmp_path / "a.tgz", "w/venv/pyvenv.cfg", link, "w/.git/x", "w/src/a.py")
    assert unpacked(archive) == {"w/src/a.py"}


@pytest.mark.parametrize("member", ["../a.py", "a/../../b.py", "/etc/a.py"])
def test_a_member_of_a_tar_that_leaves_the_folder_is_refused(tmp_path: Path, member: str) -> None:
    text = refused(tar(tmp_path / "a.tar", member))
    assert f"a.tar holds {member}, which would be written outside of its own folder" in text


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        (tarfile.SYMTYPE, "a.py as a link"),
        (tarfile.LNKTYPE, "a.py as a link"),
        (tarfile.CHRTYPE, "a.py, which is not an ordinary file"),
        (tarfile.BLKTYPE, "a.py, which is not an ordinary file"),
        (tarfile.FIFOTYPE, "a.py, which is not an ordinary file"),
        (b"?", "a.py, which is not an ordinary file"),
    ],
)
def test_a_member_of_a_tar_that_is_no_file_is_refused(
    tmp_path: Path, kind: bytes, words: str
) -> None:
    assert words in refused(tar(tmp_path / "a.tar", other("a.py", kind, "/etc/passwd")))


def test_a_link_is_no_way_for_the_members_after_it(tmp_path: Path) -> None:
    link = other("sub", tarfile.SYMTYPE, str(tmp_path))
    assert "as a link" in refused(tar(tmp_path / "a.tar", link, "sub/a.py"))


def test_a_bomb_in_a_tar_is_stopped_while_it_is_read(tmp_path: Path) -> None:
    archive = tar(tmp_path / "a.tgz", "a", "b", "c", data=b"0" * 400_000)
    assert archive.stat().st_size < 10_000
    assert "a.tgz unpacks to more than 1 MB" in refused(archive, Budget(ArchiveLimits(1_000_000)))
    assert {path.name for path in tmp_path.iterdir()} == {"a.tgz", "unpacked"}


def test_a_bomb_around_a_tar_is_stopped_while_it_is_read(tmp_path: Path) -> None:
    (tmp_path / "a.tgz").write_bytes(gzip.compress(bytes(200_000)))
    assert "a.tgz unpacks to more than 0.1 MB" in refused(
        tmp_path / "a.tgz", Budget(ArchiveLimits(100_000))
    )


def test_a_sparse_member_has_no_size_for_nothing(tmp_path: Path) -> None:
    info = tarfile.TarInfo("a.py")
    info.pax_headers = {"GNU.sparse.map": "0,1", "GNU.sparse.size": "100000000000"}
    assert "not an ordinary file" in refused(tar(tmp_path / "a.tar", info))


def test_headers_without_end_are_refused(tmp_path: Path) -> None:
    info = tarfile.TarInfo("a.py")
    info.pax_headers = {"comment": "x" * 200_000}
    long = "a.tar lists too many files, or too long names: one of its headers has more than 100 kB"
    assert long in refused(tar(tmp_path / "a.tar", info))
    (tmp_path / "again").mkdir()
    many = tar(tmp_path / "again" / "b.tar", "a", "b", "c")
    assert "it has more than 2 entries" in refused(many, Budget(ArchiveLimits(headers=2)))


@pytest.mark.parametrize("data", [b"Rar!", b"\x1f\x8bRar!", bytes(10_240), b"x" * 600])
def test_something_else_called_tar_is_refused(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "a.tar.gz").write_bytes(data)
    text = refused(tmp_path / "a.tar.gz")
    assert "cannot be unpacked as a tar file" in text or "is an empty archive" in text


@pytest.mark.parametrize("cut", [30, 300])
def test_a_tar_that_is_cut_off_is_refused(tmp_path: Path, cut: int) -> None:
    archive = tar(tmp_path / "a.tar.gz", "a.py", data=bytes(range(256)) * 16)
    archive.write_bytes(archive.read_bytes()[:cut])
    assert "cannot be unpacked as a tar file" in refused(archive)


def test_a_tar_that_ends_within_a_file_is_refused(tmp_path: Path) -> None:
    archive = tar(tmp_path / "a.tar", "a.py", data=b"x" * 5000)
    archive.write_bytes(archive.read_bytes()[:2000])
    assert "cannot be unpacked as a tar file" in refused(archive)
