"""What is said of a class: all of it messages that both languages know, wherever it was made."""

from __future__ import annotations

import json
import pickle
import re
from dataclasses import replace
from pathlib import Path

import pytest

from grader import strict_json
from grader.batch import remote
from grader.batch.class_file import ClassFile
from grader.batch.entry import Person
from grader.batch.find.joining import UNCLEAR
from grader.batch.gradebook.grade import grades
from grader.batch.gradebook.write import notes, write
from grader.batch.pool import Answer, Task
from grader.batch.remote import Unfit
from grader.errors import UsageError
from grader.exercise.sentences import last_error
from grader.message import msg, plain_text
from grader.reports import wording
from grader.translations import translate, use
from tests.grader.batch.gradebook.people import (
    in_canvas,
    in_worksheet,
    judged,
    person,
    without_result,
)
from tests.grader.languages.holes import holes

TRANSLATED = ("fr", "zh")


def lacking(texts, language):
    return [hole for text in texts for hole in holes(text, language)]


def everything_that_an_import_may_lack(out: Path):
    lower = in_worksheet(0, **{"Maximum Grade": "20,00"})
    others = [judged(out, person(number)) for number in range(1, 6)]
    unclear = without_result("nothing", person(8))
    unclear = replace(unclear, hand_in=replace(unclear.hand_in, problem=UNCLEAR))
    twice = [judged(out, replace(in_canvas(9), id=id)) for id in ("a", "b")]
    failed = without_result("failed", in_worksheet(7))
    of_moodle = [judged(out, lower), *others, *twice, failed, unclear]
    of_canvas = [judged(out, Person("x", "Xaver", {"SIS User ID": "sis-9"})), *others]
    of_groups = [judged(out, Person("1", "Team 1", {"Identifier": "Participant 17"}))]
    classes = (of_moodle, of_canvas, of_groups, [judged(out, person(2))])
    return [note for each in classes for note in notes(grades(each), "Spiral")]


@pytest.mark.parametrize("language", TRANSLATED)
def test_the_notes_of_a_gradebook_are_known(tmp_path, language):
    found = everything_that_an_import_may_lack(tmp_path)
    assert len({note.key for note in found}) == 10
    assert lacking(found, language) == []


def test_the_notes_lie_in_the_language_of_the_call_and_are_the_same_each_time(tmp_path):
    use("fr")
    entries = [judged(tmp_path, person(number)) for number in range(5)]
    files = []
    for _ in range(2):
        told_of = write(tmp_path, entries, plain_text("Spiral"))
        files.append((tmp_path / "export/notes.txt").read_text())
    assert files[0] == files[1] == "".join(f"{translate(note)}\n" for note in told_of)
    assert files[0].startswith("Rien n'indique comment Moodle ou Canvas nomment ces personnes")


def test_a_name_that_reads_as_a_word_of_ours_stays_a_name():
    (note,) = notes(grades([without_result("failed", Person("1", "nobody"))]), "Spiral")[:1]
    assert "nobody" in translate(note, "fr")


@pytest.mark.parametrize("language", TRANSLATED)
def test_in_what_two_folders_of_a_class_differ_is_known(language):
    here = ClassFile("spiral", "ab", "virtual", 1, "1", "rclpy 1", "3.12", 0, "limits")
    there = ClassFile("square", "cd", "real", None, "2", "rclpy 2", "3.13", 0, "landlock")
    differences = here.differences(there)
    assert str(differences["seed"]) == "the seed (--seed): there none, here 1"
    assert len(differences) == 8
    assert translate(differences["time"], language).count("real") == 1  # as --time takes it
    assert lacking(differences.values(), language) == []


def failure():
    return msg("the process that graded it ended ({how}), {times} times", how="SIGKILL", times=2)


@pytest.mark.parametrize("state", ["failed", "exercise"])
def test_what_a_worker_says_comes_back_as_a_message(state):
    answer = Answer(state, failure())
    back = strict_json.of_line(Answer, strict_json.line(answer))
    assert back == answer
    assert [lacking([back.why], language) for language in TRANSLATED] == [[], []]


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"message": 1}, "message: expected a message: a key with values; found 1"),
        ({"message": {"code": "1"}}, "message: expected a message: a key with values"),
        ({"message": {"key": "{a}"}}, "message: expected values that fit a message's key"),
        ({"message": [1]}, "message: expected a message"),
        ({"phrases": {}}, "expected an object of state, message, found"),
        ({"more": 1}, "expected an object of state, message, found"),
    ],
)
def test_an_answer_that_is_none_is_refused(changed, why):
    data = {"state": "failed", "message": "x"} | changed
    with pytest.raises(ValueError, match=why):
        strict_json.of_line(Answer, json.dumps(data).encode())


@pytest.mark.parametrize("line", [b"[]", b"1", b"null", b'"x"', b"\xff", b"{"])
def test_a_line_that_is_no_answer_is_refused(line):
    with pytest.raises(ValueError):
        strict_json.of_line(Answer, line)


@pytest.mark.parametrize("language", TRANSLATED)
def test_why_a_worker_is_not_fit_is_known_here(language):
    with pytest.raises(UsageError) as caught:
        remote.check_versions(
            {"rclpy": "1", "ros_distro": ""},
            {"rclpy": "", "ros_distro": "jazzy"},
            msg("the worker {name}", name="box"),
        )
    message = pickle.loads(pickle.dumps(caught.value)).message  # as a cluster hands it on
    assert str(message) == (
        "the worker box has other versions: rclpy none, and 1 where the class is; ros_distro "
        "jazzy, and none where the class is. Install the same on both"
    )
    assert lacking([message], language) == []


@pytest.mark.parametrize("language", TRANSLATED)
def test_why_something_cannot_be_sent_is_known(monkeypatch, tmp_path, language):
    monkeypatch.setattr(remote, "MOST_BYTES", 1)
    (tmp_path / "node.py").write_bytes(b"ab")
    task = Task("a", (), tmp_path, "", "square", "virtual", None, None, tmp_path)
    with pytest.raises(Unfit) as caught:
        remote.packed(task)
    assert lacking(caught.value.args, language) == []


@pytest.mark.parametrize("language", TRANSLATED)
def test_what_ends_a_verdict_about_an_error_is_the_place_in_the_readers_words(language):
    found = last_error('Traceback\n  File "drive.py", line 1234, in f\nKeyError: 4\n')
    assert str(found) == "KeyError: 4 (drive.py, line 1234)"
    assert "line" not in translate(found, language)
    assert "1234" in translate(found, language)
    assert translate(found, language).startswith("KeyError: 4")


ISOLATIONS = (
    "namespaces, private network",
    "landlock (ABI 5, own user), ROS domain 87",
    "limits, private network, process group",
    "ROS domain 3, process tree, recording within reach",
)


@pytest.mark.parametrize("language", TRANSLATED)
@pytest.mark.parametrize("name", ISOLATIONS)
def test_how_a_run_was_confined_is_said_in_the_readers_words(name, language):
    assert wording.isolation(name) == name
    use(language)
    said = re.sub(r"landlock \(ABI 5|ROS|\W(namespaces|limits)\W", "", wording.isolation(name))
    english = re.findall("[a-z]+", name.replace("landlock", ""))
    assert [word for word in english if re.search(rf"\b{word}\b", said)] == []
