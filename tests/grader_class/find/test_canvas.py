"""Canvas's download of submissions, as its content_zipper.rb names it."""

from tests.files import lay, packed
from tests.grader_class.find.exports import NODE, content, noted

GRADEBOOK = (
    "Student,ID,SIS User ID,SIS Login ID,Section,Spiral (9)\n"
    "    Points Possible,,,,,100.00\n"
    '"Müller, Zoë",1001,z1,zoe,A,\n'
    '"Nobody, Nick",1009,z9,nick,A,\n'
    '"Student, Test",1999,,abc,A,\n'
)


def test_names_say_who_late_and_what_it_was_called(tmp_path, finder):
    export = {
        "müllerzoë_1001_5001_turtle_controller.py": NODE,
        "leebob_LATE_1002_5002_my_pkg_12_34_x.zip": packed({"node.py": NODE}),
        "anon_aB3dE_5003_node.py": NODE,
        "LATE_anon_Zz9yY_5004_node.py": NODE,
        "typer_1005_text.html": "<p>",
        "linker_LATE_1006_link.html": "<p>",
        "van_der_berg_1007_5005_node.py": NODE,
    }
    by_id = finder.by_id(lay(tmp_path / "c", export))
    assert sorted(by_id) == ["1001", "1002", "1005", "1006", "1007", "Zz9yY", "aB3dE"]
    zoe, bob = by_id["1001"], by_id["1002"]
    assert (zoe.name, zoe.filename) == ("müllerzoë", "turtle_controller.py")
    assert zoe.path and zoe.path.name == "turtle_controller.py" and zoe.at is None
    exported = "müllerzoë_1001_5001_turtle_controller.py"
    assert zoe.people[0].columns == {"ID": "1001", "Exported as": exported}
    assert bob.people[0].columns["ID"] == "1002"
    assert bob.filename == "my_pkg_12_34_x.zip"
    assert [id for id, each in by_id.items() if each.is_marked_late] == ["1002", "1006", "Zz9yY"]
    assert str(by_id["1005"].problem) == "Only a text or a link was handed in, and no file."
    assert by_id["1006"].people[0].columns["Exported as"] == "linker_LATE_1006_link.html"
    assert by_id["1007"].name == "van_der_berg"


def test_files_of_one_student_are_one_submission(tmp_path, finder):
    export = {
        "ann_1_11_setup.py": "",
        "ann_1_12_part-1.py": NODE,
        "ann_1_13_part-2.py": NODE,
        "ann_1_14_.DS_Store": "",
        "ann_1_text.html": "",
    }
    ann = finder.by_id(lay(tmp_path / "c", export))["1"]
    assert content(ann) == {"setup.py", "part-1.py", "part-2.py"}
    assert ann.people[0].columns["Exported as"] == "ann_1_11_setup.py"


def test_a_file_that_was_handed_in_again_gets_its_own_name_back(tmp_path, finder):
    export = {
        "ann_1_21_node-1.py": NODE,
        "bob_LATE_2_12_pkg-2.zip": packed({"third.py": NODE}),
        "cy_3_14_pkg-1.tar.gz": b"",
    }
    ann, bob, cy = finder(lay(tmp_path / "c", export)).hand_ins
    assert (ann.filename, bob.filename, cy.filename) == ("node.py", "pkg.zip", "pkg.tar.gz")
    assert (ann.attempt, bob.attempt, cy.attempt) == (2, 3, 2)


def test_the_gradebook_is_a_roster(tmp_path, finder):
    export = {"müllerzoë_1001_5001_node.py": NODE, "leebob_1002_5002_node.py": NODE}
    gradebook = tmp_path / "gradebook.csv"
    gradebook.write_text(GRADEBOOK, encoding="utf-8")
    found = finder(lay(tmp_path / "c", export), roster=gradebook)
    assert [(each.id, each.name, str(each.problem)) for each in found.hand_ins] == [
        ("1001", "Müller, Zoë", ""),
        ("1002", "leebob", ""),
        ("1009", "Nobody, Nick", "Nothing was handed in."),
    ]
    assert found.hand_ins[0].people[0].columns["SIS Login ID"] == "zoe"
    assert noted(found, "Not in gradebook.csv", "leebob")
