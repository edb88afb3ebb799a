import io
import stat
import tarfile
import zipfile
from dataclasses import replace

import pytest

from grader.errors import UsageError
from grader_class.find import finding
from tests.files import packed
from tests.grader_class.find.exports import NODE, content, noted


def test_one_bad_member_keeps_nobody_else_out(tmp_path, finder):
    archive = tmp_path / "class.zip"
    link = zipfile.ZipInfo("bob/passwd")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(archive, "w") as zip_file:
        zip_file.writestr("alice.py", NODE)
        zip_file.writestr("../outside.py", NODE)
        zip_file.writestr("/etc/absolute.py", NODE)
        zip_file.writestr("C:\\windows.py", NODE)
        zip_file.writestr("bob/node.py", NODE)
        zip_file.writestr("bob/venv/pyvenv.cfg", NODE)
        zip_file.writestr("bob/venv/lib/x.py", NODE)
        zip_file.writestr("bob/node.py/inside.py", NODE)
        zip_file.writestr("carl\x1b[31m\n\u202e.py", NODE)
        zip_file.writestr("__MACOSX/._alice.py", NODE)
        zip_file.writestr(link, "/etc/passwd")
        zip_file.writestr("empty/", "")
    found = finder(archive)
    assert [each.id for each in found.hand_ins] == ["alice", "bob", "carl"]
    assert content(found.hand_ins[1]) == {"node.py"}
    refused = ("../outside.py", "/etc/absolute.py", "C:\\windows.py", "bob/passwd")
    assert noted(found, "is encrypted, a link, no ordinary file", *refused)
    assert noted(found, "cannot be written here", "bob/node.py/inside.py")
    assert not (tmp_path / "outside.py").exists()


def test_links_and_devices_in_a_tar_are_left_out(tmp_path, finder):
    archive = tmp_path / "class.tgz"
    with tarfile.open(archive, "w:gz") as tar:
        for name, kind in (("a", tarfile.SYMTYPE), ("b", tarfile.FIFOTYPE), ("c", tarfile.LNKTYPE)):
            info = tarfile.TarInfo(name)
            info.type, info.linkname = kind, "/etc/passwd"
            tar.addfile(info)
        info = tarfile.TarInfo("Zoë.py")
        info.size = len(NODE)
        tar.addfile(info, io.BytesIO(NODE.encode()))
    found = finder(archive)
    assert [each.name for each in found.hand_ins] == ["Zoë"]
    assert noted(found, "link", "a, b, c")


@pytest.mark.parametrize("code", ["utf-8", "cp437"])
def test_accents_are_read_whoever_has_packed_it(tmp_path, finder, code):
    """UTF-8 that does not say so (macOS), and the letters of DOS (Windows)."""
    name = "Zoë".encode(code)
    instead = "#" * len(name)  # Python's own would say that it is UTF-8
    data = packed({f"{instead}.py": NODE, "plain.py": NODE}).replace(instead.encode(), name)
    (tmp_path / "class.zip").write_bytes(data)
    assert [each.name for each in finder(tmp_path / "class.zip").hand_ins] == ["Zoë", "plain"]


def test_a_damaged_member_stays_as_far_as_it_goes(tmp_path, finder):
    archive = tmp_path / "class.zip"
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as zip_file:
        zip_file.writestr("alice.py", "# 12345678\n")
        zip_file.writestr("bob.py", NODE)
        zip_file.writestr("carl/result.json", "{} 12345678")
    archive.write_bytes(archive.read_bytes().replace(b"12345678", b"abcdefgh"))
    found = finder(archive)
    assert [each.id for each in found.hand_ins] == ["alice", "bob", "carl"]
    assert noted(found, "is damaged", "alice.py", "carl/result.json")


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"", "is empty"),
        (b"PK\x05\x06 no zip", "cannot be unpacked as a zip file: .* Unpack it yourself, and give"),
        (packed({}), "is an empty archive"),
    ],
)
def test_what_is_no_archive_is_refused(tmp_path, finder, data, why):
    archive = tmp_path / "class.zip"
    archive.write_bytes(data)
    with pytest.raises(UsageError, match=why):
        finder(archive)


@pytest.mark.parametrize(
    ("limit", "why"),
    [
        ({"most_bytes": 1000}, "to more than 1e-06 GB, or 500,000 files, the limit for a class"),
        ({"most_files": 3}, "unpacks to more than 50 GB, or 3 files, the limit for a class"),
        ({"list_bytes": 100}, "cannot be unpacked as a zip file: its list has more than"),
    ],
)
def test_a_class_has_limits(tmp_path, finder, monkeypatch, limit, why):
    archive = tmp_path / "class.zip"
    archive.write_bytes(packed({f"student{number}.py": "#" * 500 for number in range(5)}))
    monkeypatch.setattr(finding, "LIMITS", replace(finding.LIMITS, **limit))
    with pytest.raises(UsageError, match=why):
        finder(archive)


def test_names_that_are_too_long_keep_their_ends(tmp_path, finder):
    name = "Zoë" * 60
    archive = tmp_path / "class.zip"
    archive.write_bytes(packed({f"{name}_17_assignsubmission_file_{'ü' * 90}_node.py": NODE}))
    (found,) = finder(archive).hand_ins
    assert found.path and found.path.suffix == ".py"


def test_what_was_unpacked_goes_with_the_context(tmp_path):
    archive = tmp_path / "class.zip"
    archive.write_bytes(packed({"a.py": NODE, "b.py": NODE}))
    with finding.find(archive) as found:
        path = found.hand_ins[0].path
        assert path and path.exists()
    assert not path.exists()
