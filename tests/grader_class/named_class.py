"""What a class hands in, as Moodle exports it: names of students in all places that have some."""

from grader_class.reports.csv import table
from tests.grader_class.classes import CONTROLLER

AT = "2026-11-01T12:00Z"
#: id, name, group, number in Moodle. The first two hand in the same files, Eve nothing.
MEMBERS = (
    ("zm4711", "Zoë Müller", "", "101"),
    ("bs4712", "Bob Sternberg", "", "102"),
    ("dk4714", "Dan Kowalski", "Team Nord", "104"),
    ("jg4715", "Jürgen Größe", "Team Nord", "105"),
    ("ef4716", "Eve Fontaine", "", "106"),
)


def hand_in(folder):
    """Write the export of a course system, and its roster."""
    folder.mkdir(parents=True)
    columns = ("Identifier", "ID number", "Full name", "Email address", "Group", "at")
    rows = [
        (f"Participant {number}", id, name, f"{id}@uni.example", group, AT)
        for id, name, group, number in MEMBERS
    ]
    (folder / "roster.csv").write_text(table([columns, *rows]), "utf-8")
    for whose in ("Zoë Müller_101", "Bob Sternberg_102"):
        place(folder, whose, {"square.py": CONTROLLER, "notes.md": "notes"})
    said = 'print("written by Zoë Müller", flush=True)\n'
    place(folder, "Team Nord_200", {"drive.py": f"{said}import rclpy\nx = 1 / 0\n"})


def place(folder, whose, files):
    into = folder / f"{whose}_assignsubmission_file"
    into.mkdir()
    for name, text in files.items():
        (into / name).write_text(text, "utf-8")


def with_text(folder, *texts):
    """Return the files of a folder with one of these in their names or bytes."""
    data = [text.encode() for text in texts]
    paths = {path: str(path.relative_to(folder)).encode() for path in sorted(folder.rglob("*"))}
    return [
        str(path.relative_to(folder))
        for path, name in paths.items()
        if any(each in name + (path.read_bytes() if path.is_file() else b"") for each in data)
    ]
