import os
import threading
from pathlib import Path

import pytest

from grader.errors import UsageError
from grader.system import files


def test_a_file_is_written_whole_with_its_folders_and_withdrawn(tmp_path):
    path = tmp_path / "new" / "folder" / "a.txt"
    files.write(path, "ä\r\n")
    assert path.read_bytes() == "ä\r\n".encode()
    assert [p.name for p in path.parent.iterdir()] == ["a.txt"]
    path = tmp_path / "a.txt"
    path.touch()
    files.withdraw(path)
    files.withdraw(path)
    assert not path.exists()


def test_what_cannot_be_written_leaves_what_was_there(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    files.write(path, "old")

    def full(self, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(UsageError, match=r"cannot write .*a\.txt: No space left on device"):
        files.write(path, "new")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_a_link_stays_a_link_and_what_is_withdrawn_is_gone(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "target")
    files.write(tmp_path / "link", "text")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_text() == "text"
    files.withdraw(tmp_path / "link")
    assert (tmp_path / "link").is_symlink()
    assert not (tmp_path / "target").exists()


def test_what_is_no_file_is_simply_written_to(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    heard: list[str] = []
    reader = threading.Thread(target=lambda: heard.append(pipe.read_text()))
    reader.start()
    files.check_writable(pipe)
    files.withdraw(pipe)
    files.write(pipe, "text")
    reader.join()
    assert heard == ["text"]
    assert pipe.is_fifo()
    files.check_writable(Path("/dev/null"))
    files.write(Path("/dev/null"), "text")


@pytest.mark.parametrize("name", ["/dev/fd", "/proc/self/fd"])
def test_a_descriptor_is_written_to_even_where_its_file_cannot_be_opened(tmp_path, name):
    file = tmp_path / "a.txt"
    descriptor = os.open(file, os.O_WRONLY | os.O_CREAT)
    file.unlink()  # nobody can open it now
    copy = os.open(f"/proc/self/fd/{descriptor}", os.O_RDONLY)
    path = Path(name) / str(descriptor)
    files.check_writable(path)
    files.withdraw(path)
    files.write(path, "text")
    os.close(descriptor)
    with os.fdopen(copy) as opened:
        assert opened.read() == "text"
    with pytest.raises(UsageError, match="Bad file descriptor"):
        files.write(path, "more")
    with pytest.raises(UsageError, match="Bad file descriptor"):
        files.check_writable(path)


def test_what_could_not_be_written_is_found_out_beforehand_and_nothing_is_made(tmp_path):
    (tmp_path / "a.txt").touch()
    with (tmp_path / "a.txt").open() as file, pytest.raises(UsageError, match="for reading only"):
        files.check_writable(Path(f"/dev/fd/{file.fileno()}"))
    (tmp_path / "file").touch()
    for path in (tmp_path, tmp_path / "file" / "below"):
        with pytest.raises(UsageError, match=f"cannot write {path}: "):
            files.check_writable(path)
    files.check_writable(tmp_path / "new" / "folder" / "a.txt")
    assert not (tmp_path / "new").exists()


def test_a_folder_has_one_writer_at_a_time(tmp_path):
    with (
        files.sole_writer(tmp_path),
        pytest.raises(UsageError, match=r"another grading writes into .*--out"),
        files.sole_writer(tmp_path),
    ):
        pass
    with files.sole_writer(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []
