from datetime import UTC, datetime

import pytest

from grader.errors import UsageError
from grader.text.message import NOTHING
from grader_class.find.joining import UNCLEAR
from grader_class.find.roster import read_roster
from tests.files import lay
from tests.grader_class.find.exports import NODE, noted

FILES = {"alice.py": NODE, "bob.py": NODE}


def roster(tmp_path, content):
    return read_roster(lay(tmp_path, {"list.csv": content}) / "list.csv")


def who(found):
    return [(member.person.id, member.person.name) for member in found.members]


@pytest.mark.parametrize(
    "content",
    [
        "id,name,section\nz1,Zoë Müller,A\nb2,Bob,B\n",
        "\ufeffID;Name;Section\r\nz1;Zoë Müller;A\r\nb2;Bob;B\r\n",
        'sep=;\n"Name";"ID"\n"Zoë Müller";z1\nBob;b2\n',
        "id\tname\nz1\tZoë Müller\nb2\tBob\n".encode("utf-16"),
        "id;name\nz1;Zoë Müller\nb2;Bob\n".encode("cp1252"),
        '"name, all of it",id,full_name\nx,z1,Zoë Müller\n\n,,\ny,b2,Bob\n',
    ],
    ids=["plain", "bom", "sep", "utf-16", "cp1252", "quotes"],
)
def test_a_table_is_read_however_it_was_saved(tmp_path, content):
    assert who(roster(tmp_path, content)) == [("z1", "Zoë Müller"), ("b2", "Bob")]


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (  # Moodle's worksheet: not everybody has an ID number
            "Identifier,Full name,ID number,Email address\n"
            "Participant 7,Ann,s1,ann@x.org\nParticipant 8,Bob,,bob@x.org\n",
            [("ann@x.org", "Ann"), ("bob@x.org", "Bob")],
        ),
        (  # Moodle's list of participants, in German
            "Vorname;Nachname;ID-Nummer;E-Mail-Adresse;Gruppen\nZoë;Müller;s1;z@x.org;A\n",
            [("s1", "Zoë Müller")],
        ),
        (  # GitHub Classroom
            '"identifier","github_username","github_id","name"\n"ann@x.org","ann-gh","17",""\n',
            [("ann-gh", "")],
        ),
        (  # Classroom 50
            "username,first_name,last_name,email,section,github_id\nann-gh,Ann,Lee,,,17\n",
            [("ann-gh", "Ann Lee")],
        ),
        ("Identifier,Status\nParticipant 7,\nParticipant 8,\n", [("7", ""), ("8", "")]),  # blind
        ("First Name,Last Name,SID,Email\nAnn,Lee,001,a@x.org\n", [("001", "Ann Lee")]),
        ("Name\nAnn Lee\n", [("Ann Lee", "Ann Lee")]),
    ],
)
def test_the_columns_of_course_systems_are_known(tmp_path, content, expected):
    assert who(roster(tmp_path, content)) == expected


def test_a_table_that_is_none_says_so(tmp_path):
    for content, why in (
        ("", "is empty"),
        ("colour,size\nred,1\n", "no column that says who somebody is: it has colour, size"),
        (b"PK\x03\x04\x00\x00", "is no CSV file"),
        ("id,name\n" + "x" * 200_000, "is no table in CSV"),
    ):
        with pytest.raises(UsageError, match=why):
            roster(tmp_path, content)
    with pytest.raises(UsageError, match="cannot read the roster"):
        read_roster(tmp_path / "nothing.csv")


def test_a_roster_adds_names_and_whoever_handed_in_nothing(tmp_path, finder):
    table = "id,name,at\nALICE,Alice A,2026-11-01T12:00:00Z\ncarol,Carol C,\ncarol,Twice,\n,,x\n"
    found = finder(lay(tmp_path / "c", {**FILES, "Roster.csv": table}))
    assert [(each.id, each.name, str(each.problem)) for each in found.hand_ins] == [
        ("ALICE", "Alice A", ""),
        ("bob", "bob", ""),
        ("carol", "Carol C", "Nothing was handed in."),
    ]
    assert found.hand_ins[0].at == datetime(2026, 11, 1, 12, tzinfo=UTC)
    assert noted(found, "2 hand-ins. Missing: 1.")
    assert noted(found, "Not in Roster.csv", "bob")
    assert noted(found, "several rows of the same id", "carol")


def test_names_join_where_one_person_alone_has_them(tmp_path, finder):
    files = {"Zoë Müller.py": NODE, "Ann_Lee.py": NODE, "Lee, Ann.py": NODE, "Bo Lee.py": NODE}
    table = "id,name\ns1,Zoë Müller\ns2,Ann Lee\ns3,Bo Lee\ns4,bo lee\n"
    found = finder(lay(tmp_path / "c", {**files, "roster.csv": table}))
    there = {each.id: each.name for each in found.hand_ins if each.path}
    assert there == {"s1": "Zoë Müller", "s2": "Ann Lee", "Lee-Ann": "Lee, Ann", "Bo-Lee": "Bo Lee"}
    assert noted(found, "Not in roster.csv", "Bo Lee, Lee, Ann")
    assert noted(found, "not clear which hand-in is theirs: Bo Lee (s3), bo lee (s4)")


@pytest.mark.parametrize("names", [("s1.py", "alice@x.org.zip"), ("S1.py", "s1/node.py")])
def test_two_of_one_student_are_kept_apart_where_nothing_tells_which_is_newer(
    tmp_path, finder, names
):
    table = "id,name,email\ns1,Alice,alice@x.org\n"
    files = {**dict.fromkeys(names, NODE), "roster.csv": table}
    found = finder(lay(tmp_path / "c", files))
    assert [each.problem for each in found.hand_ins if each.path] == [NOTHING, NOTHING]
    assert [each.name for each in found.hand_ins if each.problem == UNCLEAR] == ["Alice"]
    assert not noted(found, "Several attempts")
    assert noted(found, "not clear which hand-in is theirs: Alice (s1)")


def test_nobody_gets_anothers_place_by_his_name(tmp_path, finder):
    """Names can be chosen, in Moodle, Canvas and GitHub alike."""
    files = {
        "Ann Lee_1_assignsubmission_file/node.py": NODE,
        "Ann Lee_2_assignsubmission_file/node.py": "import evil",
        "Bob_3_assignsubmission_file/node.py": NODE,
    }
    table = "id,name\na,Ann Lee\nb,Bob\n"
    found = finder(lay(tmp_path / "m", {**files, "roster.csv": table}))
    assert [(each.id, bool(each.path)) for each in found.hand_ins] == [
        ("1", True),
        ("2", True),
        ("a", False),
        ("b", True),
    ]
    assert noted(found, "Not in roster.csv", "Ann Lee, Ann Lee")
    files = {"ann_12_55_x.py": NODE, "eve_12_56_66_x.py": "import evil"}
    found = finder(lay(tmp_path / "c", files))
    assert len(found.hand_ins) == 2
    assert noted(found, "Some ids stand there with several names")


def test_another_table_of_scores_is_no_roster(tmp_path, finder):
    found = finder(lay(tmp_path / "c", {**FILES, "scores.csv": "colour\nred\n"}))
    assert [each.id for each in found.hand_ins] == ["alice", "bob"]


def test_an_absence_never_beats_a_hand_in(tmp_path, finder):
    table = "student number,username,name\nbob,x,Bee\n99,bob,Cee\n"
    found = finder(lay(tmp_path / "c", {"bob.py": NODE, "roster.csv": table}))
    by_id = {each.id: each for each in found.hand_ins}
    assert len(by_id) == 3
    assert (by_id["bob"].filename, by_id["bob"].attempt) == ("bob.py", 1)
    assert {each.name for each in found.hand_ins if each.problem == UNCLEAR} == {"Bee", "Cee"}
    assert noted(found, "not clear which hand-in is theirs: Bee (bob), Cee (99)")
    assert not noted(found, "Several attempts")


def test_an_id_of_the_roster_is_not_the_same_name_of_a_file(tmp_path, finder):
    table = "student number,username,name\n7,zoe,Zed\nbob,7,Bee\n99,bob,Cee\n"
    files = {f"{name}.py": NODE for name in ("7", "bob", "zoe")}
    found = finder(lay(tmp_path / "c", {**files, "roster.csv": table}))
    graded = {each.filename: each.name for each in found.hand_ins if each.path}
    assert graded == {"7.py": "7", "bob.py": "bob", "zoe.py": "Zed"}
    assert noted(found, "not clear which hand-in is theirs: Bee (bob), Cee (99)")


def test_times_that_cannot_be_read_are_told(tmp_path):
    found = roster(tmp_path, "id,at\nzoe,2026-11-30T23:00:00\nbob,yesterday\n7,2026-13-45\nx,\n")
    (note,) = map(str, found.notes)
    assert "bob: yesterday, 7: 2026-13-45" in note
    assert "Expected one such as 2026-11-01T12:30:00+01:00" in note
    assert "local time" in note


def test_moodles_worksheet_says_when_it_was_handed_in(tmp_path):
    title, said = "Last modified (submission)", '"Tuesday, 1 December 2026, 6:00 PM"'
    table = f"Identifier,Full name,{title}\nParticipant 7,Ann,{said}\nParticipant 8,Bob,-\n"
    found = roster(tmp_path, table)
    times = [member.at for member in found.members]
    assert times == [datetime(2026, 12, 1, 18).astimezone(), None]
    assert not found.notes
