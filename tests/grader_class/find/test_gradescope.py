"""Gradescope's export: folders, and Ruby's YAML beside them."""

from datetime import UTC, datetime

from tests.files import lay
from tests.grader_class.find.exports import NODE, content, noted

METADATA = """\
---
submission_101:
  :submitters:
  - :name: Zoë Müller
    :sid: '007'
    :email: zoe@example.org
  :created_at: 2026-11-01 12:30:05.206478000 Z
  :score: 3.0
  :results:
    tests:
    - name: "a"
      output: &deep {x: [{y: [{z: [1, 2, *deep2]}]}]}
  :history: []
submission_102:
  :submitters:
  - :name: Ann
    :sid: 008
    :email: ann@example.org
  - :name: Bob
    :sid: 1e3
    :email: bob@example.org
  :created_at: !ruby/object:ActiveSupport::TimeWithZone
    utc: &1 2026-11-02 08:00:00.000000000 Z
    zone: !ruby/object:ActiveSupport::TimeZone
      name: Europe/Berlin
    time: 2026-11-02 09:00:00.000000000 Z
submission_103:
  :submitters:
  - :name: Ann
    :sid: 008
    :email: ann@example.org
  - :name: Bob
    :sid: 1e3
    :email: bob@example.org
  :created_at: *1
submission_104:
  :submitters:
  - :name: Gone
    :sid:
    :email: gone@example.org
  :created_at:
submission_105:
  :submitters: []
""".replace(", *deep2", "")


def export(root, metadata=METADATA):
    return lay(
        root,
        {
            "assignment_9_export/submission_metadata.yml": metadata,
            "assignment_9_export/submission_101/node.py": NODE,
            "assignment_9_export/submission_102/pkg/setup.py": "",
            "assignment_9_export/submission_102/pkg/pkg/node.py": NODE,
            "assignment_9_export/submission_103/late.py": NODE,
            "assignment_9_export/submission_105/.DS_Store": "",
        },
    )


def test_the_metadata_say_who_and_when(tmp_path, finder):
    found = finder(export(tmp_path / "g"))
    by_id = {each.id: each for each in found.hand_ins}
    assert sorted(by_id) == ["007", "008+1e3", "105", "gone@example.org"]
    zoe, group = by_id["007"], by_id["008+1e3"]
    assert zoe.at == datetime(2026, 11, 1, 12, 30, 5, 206478, tzinfo=UTC)
    assert zoe.people[0].columns == {"SID": "007", "Email": "zoe@example.org"}
    assert content(zoe) == {"node.py"}
    assert [person.name for person in group.people] == ["Ann", "Bob"]
    assert group.at == datetime(2026, 11, 2, 8, tzinfo=UTC)
    assert str(by_id["gone@example.org"].problem).startswith("Gradescope's export holds no file")
    assert str(by_id["105"].problem) == "What was handed in is an empty folder."
    assert noted(found, "Several attempts", "Ann")


def test_damaged_metadata_leave_the_folders(tmp_path, finder):
    found = finder(export(tmp_path / "g", METADATA + "\n  - {"))
    assert [each.id for each in found.hand_ins] == ["101", "102", "103", "105"]
    assert noted(found, "Names, ids and times are missing", "submission_metadata.yml", "line")


def test_no_tag_of_a_stranger_is_followed(tmp_path, finder):
    ran = tmp_path / "ran"
    path = f"!!python/object/apply:pathlib.Path ['{ran}']"
    metadata = (
        "submission_101:\n  :submitters:\n"
        f"  - :name: !!python/object/apply:pathlib.Path.touch [{path}]\n"
        "    :sid: !!python/name:os.system ''\n    :email: a@b.c\n"
    )
    by_id = finder.by_id(export(tmp_path / "g", metadata))
    assert not ran.exists()
    assert by_id["a@b.c"].path


def test_a_member_of_a_group_is_in_his_newest_hand_in_alone(tmp_path, finder):
    ann, bob = "  - :name: Ann\n    :sid: s1\n", "  - :name: Bob\n    :sid: s2\n"

    def told(number, people, day):
        at = f"2026-11-0{day} 12:30:00 Z"
        return f"submission_{number}:\n  :submitters:\n{people}  :created_at: {at}\n"

    for last, table in ((told(3, bob, 1), ""), (told(3, bob, 4), "id,name\ns1,Ann\ns2,Bob\n")):
        folder = tmp_path / f"g{bool(table)}"
        files = {f"submission_{number}/node.py": NODE for number in (1, 2, 3)}
        files["submission_metadata.yml"] = told(1, ann + bob, 2) + told(2, ann, 3) + last
        found = finder(lay(folder, files | ({"roster.csv": table} if table else {})))
        assert [(each.id, each.name, each.at.day) for each in found.hand_ins if each.at] == [
            ("s1", "Ann", 3),
            ("s2", "Bob", 4 if table else 2),
        ]
        assert noted(found, "the newest counts", "Ann")
