"""An exercise says title, task, checks and tolerances in other languages; slips are told."""

from __future__ import annotations

import json

import pytest
import yaml

from grader.errors import ExerciseError
from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.exercise.sheet import Start, sheet
from grader.exercise.verdict import Verdict
from grader.recording.recording import Recordings
from grader.recording.subject import load_subject
from grader.result import json_file
from grader.testing import drive
from grader.translations import ENGLISH, translate, use
from tests.grader.testing import exercises

WORDS = {
    "fr": {
        "title": "Avancer",
        "task": "Avancez de {far_m} m.",
        "checks": {
            "commands": "Il envoie des commandes",
            "far": {"title": "Il avance d'un demi-mètre", "rubric": "Au moins {far_m} m."},
        },
        "tolerances": {"far_m": "si loin"},
    },
    "zh": {"title": "前进"},
}
TASK = "Drive {far_m} m."


@pytest.fixture(autouse=True)
def english_again():
    yield
    use(ENGLISH)


def written(tmp_path, languages, **changes):
    tmp_path.mkdir(exist_ok=True)
    return exercises.write(
        tmp_path / "ahead", tolerances={"far_m": 0.5}, task=TASK, languages=languages, **changes
    )


def sheet_in(language, exercise):
    use(language)
    return sheet(exercise, load_subject(exercise.scene), Start("my_node.py", "", "grader run mine"))


def test_the_sheet_has_the_exercises_words_in_the_users_language(tmp_path):
    text = sheet_in("fr", load_exercise(written(tmp_path, WORDS)))
    assert text.startswith("# Avancer\n\nAvancez de 0.5 m.\n")
    assert "| Il envoie des commandes | `commands` |" in text
    assert "Au moins 0.5 m." in text
    assert "\nfar_m: 0.5  # si loin\n" in text


def test_what_a_language_leaves_out_is_told_as_the_file_has_it(tmp_path):
    text = sheet_in("zh", load_exercise(written(tmp_path, WORDS)))
    assert text.startswith("# 前进\n\nDrive 0.5 m.\n")
    assert "| It sends commands | `commands` |" in text
    assert "\nfar_m: 0.5\n" in text


def test_in_english_nothing_of_them_shows(tmp_path):
    there, without = written(tmp_path / "a", WORDS), written(tmp_path / "b", {})
    assert sheet_in("en", load_exercise(there)) == sheet_in("en", load_exercise(without))


def test_a_verdict_takes_the_words_of_its_title_with_it(tmp_path):
    exercise = load_exercise(written(tmp_path, WORDS))
    recordings = Recordings(drive(lambda *_: None, 60))
    first, _ = judge(recordings, exercise.checks, exercise.points, exercise.tolerances)
    assert str(first.title) == "It sends commands"
    assert translate(first.title, "fr") == "Il envoie des commandes"
    # ... through a file
    data = json_file.with_phrases(first)
    assert data["title"] == "It sends commands"
    phrases = json.loads(json.dumps(data.pop("phrases")))
    again = json_file.typed(Verdict, data, phrases)
    assert translate(again.title, "fr") == "Il envoie des commandes"
    assert translate(again.title, "zh") == "It sends commands"


def test_words_change_no_hash_and_no_points(tmp_path):
    one, other = (
        load_exercise(written(tmp_path / name, words)) for name, words in (("a", WORDS), ("b", {}))
    )
    assert one.sha256 == other.sha256
    assert one.points == other.points


@pytest.mark.parametrize(
    ("languages", "words"),
    [
        ("French", "languages: expected some of fr, zh, each with its text; found 'French'"),
        ({"de": {"title": "Vorwärts"}}, "languages: unknown 'de'; there are"),
        ({"en": {"title": "Ahead"}}, "languages: unknown 'en'"),
        ({"fr": {"titel": "x"}}, "languages: fr: unknown 'titel'; did you mean 'title'?"),
        ({"fr": {"title": 3}}, "languages: fr: title: expected a text, found 3"),
        ({"fr": {"title": " "}}, "languages: fr: title: expected a text, found ' '"),
        (
            {"fr": {"checks": {"fast": "x"}}},
            "languages: fr: checks: unknown 'fast'; there are commands",
        ),
        ({"fr": {"checks": {"far": 3}}}, "languages: fr: checks: far: expected a text, found 3"),
        (
            {"fr": {"checks": {"far": {"rubrik": "x"}}}},
            "languages: fr: checks: far: unknown 'rubrik'; did you mean 'rubric'?",
        ),
        ({"fr": {"tolerances": {"far": "x"}}}, "languages: fr: tolerances: unknown 'far'"),
        ({"fr": ["x"]}, "languages: fr: expected some of title, task, checks, tolerances"),
    ],
)
def test_a_slip_is_told_where_it_stands(tmp_path, languages, words):
    with pytest.raises(ExerciseError) as error:
        load_exercise(written(tmp_path, languages))
    assert words in str(error.value.message)
    assert "exercise.yaml, line " in str(error.value.message)


def test_an_edited_copy_keeps_the_words_of_what_it_does_not_change(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump({"exercise": "square", "title": "A smaller square"}))
    exercise = load_exercise(path)
    assert translate(exercise.title, "fr") == "A smaller square"
    assert translate(exercise.task, "fr").startswith("Écrivez un nœud")
