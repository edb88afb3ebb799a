"""An exercise says title, task, checks and tolerances in other languages; slips are told."""

import json

import pytest
import yaml

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.exercise.result import json_file
from grader.exercise.sheet import Start, sheet
from grader.exercise.verdict import Verdict
from grader.recording.recording import Recordings
from grader.scenes.subject import load_subject
from grader.testing import drive
from grader.text.translations import ENGLISH, translate, use
from tests.grader.testing import exercises
from tests.grader.testing.exercises import refusal

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


def written(folder, translations, **changes):
    folder.mkdir(exist_ok=True)
    changes = {"tolerances": {"far_m": 0.5}, "task": TASK} | changes
    path = exercises.write(folder / "ahead", **changes)
    for language, texts in translations.items():
        (path / f"exercise.{language}.yaml").write_text(yaml.safe_dump(texts))
    return path


def sheet_in(language, exercise):
    use(language)
    return sheet(exercise, load_subject(exercise.scene), Start("my_node.py", "", "grader run mine"))


def test_the_sheet_has_the_exercises_words_in_the_users_language(tmp_path):
    text = sheet_in("fr", load_exercise(written(tmp_path, WORDS)))
    assert text.startswith("# Avancer\n\nAvancez de 0.5 m.\n")
    assert "| Il envoie des commandes | `commands` |" in text
    assert "Au moins 0.5 m." in text
    assert "\nfar_m: 0.5  # si loin\n" in text
    text = sheet_in("zh", load_exercise(written(tmp_path, WORDS)))
    assert text.startswith("# 前进\n\nDrive 0.5 m.\n")
    assert "| It sends commands | `commands` |" in text
    assert "\nfar_m: 0.5\n" in text
    one, other = (
        load_exercise(written(tmp_path / name, words)) for name, words in (("a", WORDS), ("b", {}))
    )
    assert sheet_in("en", one) == sheet_in("en", other)
    assert one.sha256 == other.sha256
    assert one.points == other.points


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


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        ("French", ": expected an object, found 'French'"),
        (["x"], ": expected an object, found"),
        ({"titel": "x"}, ": unknown 'titel'; did you mean 'title'?"),
        ({"title": 3}, ", line 1: title: expected a text, found 3"),
        ({"title": " "}, ", line 1: title: expected a text, found ' '"),
        ({"checks": {"fast": "x"}}, ", line 1: checks: unknown 'fast'; there are commands"),
        ({"checks": {"far": 3}}, ", line 2: checks: far: expected a text, found 3"),
        (
            {"checks": {"far": {"rubrik": "x"}}},
            ", line 2: checks: far: unknown 'rubrik'; did you mean 'rubric'?",
        ),
        ({"tolerances": {"far": "x"}}, ", line 1: tolerances: unknown 'far'"),
    ],
)
def test_a_slip_is_told_where_it_stands(tmp_path, texts, words):
    assert f"exercise.fr.yaml{words}" in refusal(written(tmp_path, {"fr": texts}))


def test_a_language_that_there_is_not_is_told(tmp_path):
    said = refusal(written(tmp_path, {"cn": {"title": "前进"}}))
    assert "exercise.cn.yaml: expected one of fr, zh as its language, found cn" in said


def test_an_edited_copy_keeps_the_texts_of_what_it_does_not_change_and_has_its_own(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump({"exercise": "square", "title": "A smaller square"}))
    exercise = load_exercise(path)
    assert translate(exercise.title, "fr") == "A smaller square"
    assert translate(exercise.task, "fr").startswith("Écrivez un nœud")
    (tmp_path / "mine.fr.yaml").write_text("title: Un carré plus petit\ntolerances: {side_m: côté}")
    exercise = load_exercise(path)
    assert translate(exercise.title, "fr") == "Un carré plus petit"
    assert translate(exercise.task, "fr").startswith("Écrivez un nœud")
    assert exercise.explained["fr"]["side_m"] == "côté"
    assert exercise.explained["fr"]["near_m"]
