"""Moodle's download of all submissions, as its downloader.php names it."""

from tests.files import lay, packed
from tests.grader_class.find.exports import NODE, content, noted

FOLDERS = {
    "Zoë Müller-Łukasz_101_assignsubmission_file/turtle_controller.py": NODE,
    "Jean Luc de la Tour_102_assignsubmission_file_/pkg/setup.py": "",  # with the older underscore
    "Jean Luc de la Tour_102_assignsubmission_file_/pkg/pkg/node.py": NODE,
    "Jean Luc de la Tour_102_assignsubmission_onlinetext_/onlinetext.html": "<p>see the zip</p>",
    "Only Text_103_assignsubmission_onlinetext/onlinetext.html": "<p>later</p>",
    "Empty Folder_104_assignsubmission_file/.DS_Store": "",
    "李 小龙_105_assignsubmission_file/lee.zip": packed({"node.py": NODE}),
    "Corrupt Zip_106_assignsubmission_file/c.zip": b"PK\x03\x04 and nothing more",
    ".DS_Store": "x",
}


def test_folders_say_who_and_which_number(tmp_path, finder):
    found = finder(lay(tmp_path / "m", FOLDERS))
    by_id = {each.id: each for each in found.hand_ins}
    assert [(each.id, each.name) for each in found.hand_ins] == [
        ("101", "Zoë Müller-Łukasz"),
        ("102", "Jean Luc de la Tour"),
        ("103", "Only Text"),
        ("104", "Empty Folder"),
        ("105", "李 小龙"),
        ("106", "Corrupt Zip"),
    ]
    assert by_id["101"].people[0].columns == {"Identifier": "Participant 101"}
    assert content(by_id["101"]) == {"turtle_controller.py"}
    assert content(by_id["102"]) == {"pkg/setup.py", "pkg/pkg/node.py"}
    assert (by_id["103"].path, str(by_id["103"].problem)) == (
        None,
        "Only a text was handed in online, and no file.",
    )
    assert str(by_id["104"].problem) == "What was handed in is an empty folder."
    assert by_id["105"].path and by_id["105"].path.name == by_id["105"].filename == "lee.zip"
    assert not by_id["106"].problem and by_id["106"].path  # whoever grades it tells
    assert all(each.at is None for each in found.hand_ins)
    (note,) = map(str, found.notes)
    assert note == "Read as what Moodle's “Download all submissions” makes: 6 hand-ins."


def test_files_without_folders_get_their_own_names_back(tmp_path, finder):
    export = {
        "Ann Lee_7_assignsubmission_file_my_node_v2.py": NODE,
        "Bob_8_assignsubmission_file_setup.py": "",
        "Bob_8_assignsubmission_file_node.py": NODE,
        "Bob_8_assignsubmission_onlinetext_onlinetext.html": "",
        "Eve_9_assignsubmission_file_...py": NODE,
        "Eve_9_assignsubmission_file_..": NODE,
    }
    by_id = finder.by_id(lay(tmp_path / "m", export))
    ann = by_id["7"]
    assert ann.path and ann.path.name == ann.filename == "my_node_v2.py"
    assert ann.path.read_text() == NODE
    assert content(by_id["8"]) == {"setup.py", "node.py"}
    assert by_id["9"].path is None  # hidden files are no hand-in


def test_a_group_is_one_hand_in(tmp_path, finder):
    export = {
        "Team Blue_17_assignsubmission_file/node.py": NODE,
        "Default group_assignsubmission_file/node.py": NODE,
        "Participant_5_assignsubmission_file/node.py": NODE,
    }
    found = finder(lay(tmp_path / "m", export))
    assert [(each.id, each.name) for each in found.hand_ins] == [
        ("17", "Team Blue"),
        ("5", "5"),  # marked blindly: Moodle calls everybody so
        ("Default-group", "Default group"),
    ]


def test_the_members_of_a_group_come_from_the_worksheet(tmp_path, finder):
    worksheet = (
        "\ufeffIdentifier,Full name,ID number,Email address,Status,Group,Grade\n"
        "Participant 17,Ann Lee,s1,ann@x.org,,Team Blue,\n"
        "Participant 18,Bob Lee,s2,bob@x.org,,Team Blue,\n"
        "Participant 19,Cy Lee,s3,cy@x.org,,Team Red,\n"
    )
    # 17 is the group's number here, and has nothing to do with participant 17
    export = {"Team Blue_17_assignsubmission_file/node.py": NODE, "roster.csv": worksheet}
    by_id = finder.by_id(lay(tmp_path / "m", export))
    assert {id: each.name for id, each in by_id.items()} == {
        "s1+s2": "Ann Lee, Bob Lee",
        "s3": "Cy Lee",
    }
    assert str(by_id["s3"].problem) == "Nothing was handed in."


def test_a_group_is_not_taken_for_a_participant_of_its_number(tmp_path, finder):
    worksheet = "Identifier,Full name\nParticipant 17,Ann Lee\n"
    export = {"Team Blue_17_assignsubmission_file/node.py": NODE, "roster.csv": worksheet}
    found = finder(lay(tmp_path / "m", export))
    assert [each.name for each in found.hand_ins] == ["Team Blue", "Ann Lee"]
    assert noted(found, "Not in roster.csv", "Team Blue")


def test_an_archive_of_the_class_is_unpacked(tmp_path, finder):
    archive = tmp_path / "CS101-Turtles-77.zip"
    archive.write_bytes(packed(FOLDERS))
    by_id = finder.by_id(archive)
    assert by_id["101"].name == "Zoë Müller-Łukasz"
    assert content(by_id["105"]) == {"lee.zip"}
