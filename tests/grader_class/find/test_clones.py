"""Folders of repositories: Classroom 50, GitHub Classroom, clones; nothing in them is read."""

from tests.files import lay
from tests.grader_class.find.exports import NODE, noted

SCORES = (
    "username,first_name,last_name,email,section,score,max_score,datetime,submission_tag\n"
    "anna-b,Anna,Berg,a@x.org,1,,,,submit/2026-10-30T08-00-00Z\n"
    "anna-b,Anna,Berg,a@x.org,1,,,,submit/2026-10-31T09-00-00Z\n"
    "anna-c,Anna,Cruz,c@x.org,1,,,,submit/2026-10-29T09-00-00Z\n"
    "b,Bo,Bin,b@x.org,1,,,,\n"
)


def clones(root, *names):
    for name in names:
        lay(root / name, {"node.py": NODE, ".git/HEAD": "ref: refs/heads/main\n"})
    return root


def test_a_clone_is_called_by_its_student(tmp_path, finder):
    root = clones(tmp_path / "spiral-submissions", "spiral-anna", "spiral-bob")
    found = finder(lay(root, {"notes.txt": ""}))
    assert [(each.id, each.path, each.at) for each in found.hand_ins] == [
        ("anna", root / "spiral-anna", None),
        ("bob", root / "spiral-bob", None),
    ]
    assert noted(found, "Read as a folder of git repositories: 2 hand-ins.")
    assert noted(found, "All begin with spiral-")
    assert noted(found, "are no repositories", "notes.txt")


def test_classroom_50_says_who_was_to_hand_in_and_when(tmp_path, finder):
    """The longest end counts: `cs-spiral-anna-b` is not the hand-in of `b`."""
    root = tmp_path / "cs-spiral_submissions"
    for user in ("anna-b", "anna-c"):
        lay(root / f"cs-spiral-{user}", {"node.py": NODE, ".classroom50.yml": ""})
    by_id = finder.by_id(lay(root, {"scores.csv": SCORES}))
    assert {id: each.name for id, each in by_id.items()} == {
        "anna-b": "Anna Berg",
        "anna-c": "Anna Cruz",
        "b": "Bo Bin",
    }
    assert str(by_id["anna-b"].at) == "2026-10-31 09:00:00+00:00"
    assert str(by_id["b"].problem) == "Nothing was handed in."


def test_two_repositories_that_may_be_one_students_are_nobodys(tmp_path, finder):
    root = clones(tmp_path / "c", "hw-ann", "hw-x-ann", "hw-bob")
    found = finder(lay(root, {"roster.csv": "username,name\nann,Ann\nbob,Bob\n"}))
    assert sorted(each.name for each in found.hand_ins if each.path) == ["Bob", "ann", "x-ann"]
    assert noted(found, "Not in roster.csv", "ann, x-ann")
    assert noted(found, "not clear which hand-in is theirs: Ann (ann)")
