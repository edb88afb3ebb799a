"""An archive is unpacked below its folder, within its limits, or refused; none is trusted."""

import gzip
import io
import stat
import tarfile
import zipfile
from dataclasses import replace

import pytest

from grader.errors import SubmissionError
from grader.submission.safe_members import Budget
from grader.submission.unpacking import unpack

LIMITS = Budget()


def zipped(*members, data="x", method=zipfile.ZIP_DEFLATED):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", method) as packed:
        for member in members:
            packed.writestr(member, data)
    return buffer.getvalue()


def special(name, kind):
    info = zipfile.ZipInfo(name)
    info.external_attr = (kind | 0o777) << 16
    return info


def tarred(*members, data=b"x", mode="w"):
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode=mode) as packed:
        for member in members:
            info = tarfile.TarInfo(member) if isinstance(member, str) else member
            info.size = len(data) if info.isreg() else 0
            packed.addfile(info, io.BytesIO(data))
    return buffer.getvalue()


def other(name, kind=tarfile.REGTYPE, target="", **pax):
    info = tarfile.TarInfo(name)
    info.type, info.linkname, info.pax_headers = kind, target, pax
    return info


def unpacked(folder, name, data, limits=LIMITS):
    into = folder / "unpacked"
    into.mkdir()
    (folder / name).write_bytes(data)
    unpack(folder / name, into, replace(limits))
    return {str(path.relative_to(into)) for path in into.rglob("*") if path.is_file()}


def refused(folder, name, data, limits=LIMITS):
    with pytest.raises(SubmissionError) as error:
        unpacked(folder, name, data, limits)
    assert {path.name for path in folder.iterdir()} == {name, "unpacked"}
    return str(error.value)


def test_the_files_of_a_zip_are_written_with_their_folders(tmp_path):
    # backslashes are those of Windows
    data = zipped("a.py", "b/", "b/c/d.py", "e\\", "e\\f.py")
    assert unpacked(tmp_path, "a.zip", data) == {"a.py", "b/c/d.py", "e/f.py"}


@pytest.mark.parametrize(
    ("name", "mode"), [("a.tar", "w"), ("a.tar.gz", "w:gz"), ("A.TGZ", "w:gz")]
)
def test_the_files_of_a_tar_are_written_with_their_folders(tmp_path, name, mode):
    long = "b/" + 120 * "e" + ".py"
    data = tarred("./a.py", other("b", tarfile.DIRTYPE), "b/c/d.py", long, mode=mode)
    assert unpacked(tmp_path, name, data) == {"a.py", "b/c/d.py", long}
    assert (tmp_path / "unpacked/a.py").read_bytes() == b"x"
    assert {path.name for path in tmp_path.iterdir()} == {name, "unpacked"}


def test_what_programs_filled_stays_out(tmp_path):
    generated = [
        *("w/.git/config", "w/__pycache__/a.pyc", "__MACOSX/w/._a.py"),
        *("w/my_env/pyvenv.cfg", "w/my_env/lib/a.py"),
        *("w/install/COLCON_IGNORE", "w/install/s/a.py"),
    ]
    link = special("w/my_env/bin/python", stat.S_IFLNK)
    data = zipped(*generated, link, "w/src/a.py", "w/test/b.py")
    assert unpacked(tmp_path, "a.zip", data) == {"w/src/a.py", "w/test/b.py"}
    link_of_tar = other("w/my_env/bin/python", tarfile.SYMTYPE, "/usr/bin/python3")
    (tmp_path / "tar").mkdir()
    data = tarred(*generated, link_of_tar, "w/src/a.py", mode="w:gz")
    assert unpacked(tmp_path / "tar", "a.tgz", data) == {"w/src/a.py"}


def test_what_an_earlier_grading_has_left_stays_out(tmp_path):
    result = '{"schema": "turtlesim-grader/result/v1"}'
    buffer = io.BytesIO(zipped("w/graded/w/result.json", "w/b/result.json", data=result))
    with zipfile.ZipFile(buffer, "a") as packed:
        packed.writestr("w/graded/w/recording/trace.npz", "x")
        packed.writestr("w/b/node.py", "x")
        packed.writestr("w/c/result.json", "{}")
    found = unpacked(tmp_path, "a.zip", buffer.getvalue())
    assert found == {"w/b/node.py", "w/b/result.json", "w/c/result.json"}


@pytest.mark.parametrize(
    "member", ["../a.py", "a/../../b.py", "/etc/a.py", "C:\\a.py", "..\\a.py", ".git/../../a.py"]
)
def test_a_member_that_leaves_the_folder_is_refused(tmp_path, member):
    words = f"holds {member}, which would be written outside of its own folder"
    assert f"a.zip {words}" in refused(tmp_path, "a.zip", zipped(member))
    if "\\" not in member and ".git" not in member:
        (tmp_path / "tar").mkdir()
        assert f"a.tar {words}" in refused(tmp_path / "tar", "a.tar", tarred(member))


def changed(data, mark, at, *values):
    """The bytes with others so far behind a mark."""
    start = data.index(mark) + at
    return data[:start] + bytes(values) + data[start + len(values) :]


def words_alone(value):
    """The name of a parameter: bytes of an archive hold the time."""
    return value if isinstance(value, str) else ""


#: The places where a zip says how a file is packed: before it, and in the central directory.
FILE, DIRECTORY, END = b"PK\x03\x04", b"PK\x01\x02", b"PK\x05\x06"
ENCRYPTED = changed(changed(zipped("a.py"), FILE, 6, 1), DIRECTORY, 8, 1)
DEFLATE64 = changed(changed(zipped("a.py"), FILE, 8, 9), DIRECTORY, 10, 9)  # of Windows
NUMBERS = "".join(map(str, range(1000)))
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)
NO_ZIP, NO_TAR = "a.zip cannot be unpacked as a zip file", "cannot be unpacked as a tar file"
SPARSE = {"GNU.sparse.map": "0,1", "GNU.sparse.size": "100000000000"}
CUT = tarred("a.py", data=bytes(range(256)) * 16, mode="w:gz")


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("a.zip", zipped(special("a.py", stat.S_IFLNK)), "a.zip holds a.py as a link"),
        ("a.zip", zipped(special("a.py", stat.S_IFCHR)), "a.py, which is not an ordinary file"),
        *(("a.zip", zipped(*m), "a.zip is an empty archive") for m in ([], ["a/"], ["__MACOSX/a"])),
        ("a.zip", b"", "a.zip is empty (0 bytes)"),
        ("a.zip", b"Rar!", f"{NO_ZIP}: File is not a zip file."),
        *(
            ("a.zip", changed(zipped("a.py", data=NUMBERS, method=m), FILE, 60, *bytes(10)), NO_ZIP)
            for m in METHODS
        ),
        ("a.zip", zipped("a.py", "b.py")[:-30], NO_ZIP),
        ("a.zip", changed(zipped("a.py"), END, 17, 255), NO_ZIP),  # its directory begins before it
        ("a.zip", zipped("a", "a/b.py"), "cannot be unpacked"),
        ("a.zip", ENCRYPTED, "a.zip is encrypted: a.py asks for a password"),
        ("a.zip", DEFLATE64, "cannot be unpacked as a zip file: "),
        *(
            ("a.tar", tarred(other("a.py", kind, "/etc/passwd")), "a.py as a link")
            for kind in (tarfile.SYMTYPE, tarfile.LNKTYPE)
        ),
        *(
            ("a.tar", tarred(other("a.py", kind)), "a.py, which is not an ordinary file")
            for kind in (tarfile.CHRTYPE, tarfile.BLKTYPE, tarfile.FIFOTYPE, b"?")
        ),
        ("a.tar", tarred(other("a.py", **SPARSE)), "not an ordinary file"),
        *(("a.tar.gz", data, NO_TAR) for data in (b"Rar!", b"\x1f\x8bRar!", b"x" * 600)),
        ("a.tar.gz", bytes(10_240), "is an empty archive"),
        *(("a.tar.gz", CUT[:length], NO_TAR) for length in (30, 300)),
        ("a.tar", tarred("a.py", data=b"x" * 5000)[:2000], NO_TAR),
    ],
    ids=words_alone,
)
def test_what_is_no_plain_archive_of_files_is_refused(tmp_path, name, data, words):
    assert words in refused(tmp_path, name, data)


@pytest.mark.parametrize(
    ("name", "data", "limits", "words"),
    [
        (
            *("a.zip", zipped("a", "b", "c"), Budget(most_files=2)),
            "a.zip holds 3 files; the limit for a submission is 2",
        ),
        (
            *("a.zip", zipped("a", "b", "c", data="0" * 400_000), Budget(1_000_000)),
            "a.zip holds more than 1 MB",
        ),
        (
            *("a.zip", zipped("a"), Budget(10)),
            "a.zip holds more than 1e-05 MB, the limit for a submission",
        ),
        (
            "a.tgz",
            tarred("a", "b", "c", data=b"0" * 400_000, mode="w:gz"),
            Budget(1_000_000),
            "a.tgz holds more than 1 MB",
        ),
        (
            *("a.tgz", gzip.compress(bytes(200_000)), Budget(100_000)),
            "a.tgz holds more than 0.1 MB",
        ),
        (
            *("a.tar", tarred(other("a.py", comment="x" * 200_000)), LIMITS),
            "cannot be unpacked as a tar file: one of its headers has more than 100 kB",
        ),
        (*("a.tar", tarred("a", "b", "c"), Budget(headers=2)), "it has more than 2 entries"),
    ],
    ids=words_alone,
)
def test_what_exceeds_a_limit_is_stopped_while_it_is_read(tmp_path, name, data, limits, words):
    assert len(data) < 300_000
    assert words in refused(tmp_path, name, data, limits)


def test_several_archives_of_a_submission_have_one_limit(tmp_path):
    budget = Budget(1_000_000)
    for name in ("a.zip", "b.zip"):
        (tmp_path / name).write_bytes(zipped("a", data="0" * 600_000))
    unpack(tmp_path / "a.zip", tmp_path, budget)
    with pytest.raises(SubmissionError, match=r"b\.zip holds more than 1 MB"):
        unpack(tmp_path / "b.zip", tmp_path, budget)
