import pytest

from grader.cli import main
from grader.exercise.places import names
from grader.system import versions as system


def new(folder, *words, kind="github"):
    return main(["course", "new", str(folder), "--for", kind, *words])


def workflow(folder):
    (path,) = folder.rglob("grade.yml")
    return path.read_text(encoding="utf-8")


def test_the_challenge_comes_by_itself(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(system, "grader_version", lambda: "1.2.3+jazzy")
    assert new(tmp_path / "course") == 0
    assert [path.name for path in (tmp_path / "course" / "templates").iterdir()] == [
        "turtlesim_challenge"
    ]
    assert capsys.readouterr().out.splitlines() == [
        f"The course is in {tmp_path / 'course'}.",
        "There, turtlesim_py[jazzy]==1.2.3 is installed.",
        "Nothing is under git yet: README.md says what to do, step by step.",
    ]
    assert 'GRADER_SOURCE: "turtlesim_py[jazzy]==1.2.3"' in workflow(tmp_path)
    assert 'PASS_POINTS: "60"' in workflow(tmp_path)
    assert not list(tmp_path.rglob(".git"))


def test_a_folder_with_something_in_it_stays_as_it_is(tmp_path, capsys):
    (tmp_path / "mine.txt").write_text("mine")
    assert new(tmp_path) == 2
    assert "is not empty; give a new folder, nothing was written" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_a_folder_with_nothing_but_git_in_it_is_filled(tmp_path):
    (tmp_path / ".git").mkdir()
    (tmp_path / ".git" / "HEAD").write_text("theirs")
    assert new(tmp_path) == 0
    assert (tmp_path / "README.md").is_file()
    assert [path.name for path in (tmp_path / ".git").iterdir()] == ["HEAD"]


def test_exercises_between_commas_are_told(tmp_path, capsys):
    assert new(tmp_path / "course", "--exercises", "talker,square") == 2
    assert "--exercises talker,square: separate them by blanks" in capsys.readouterr().err


def test_an_unknown_exercise_is_told_with_those_that_there_are(tmp_path, capsys):
    assert new(tmp_path / "course", "--exercises", "talker", "spiral") == 2
    said = capsys.readouterr().err
    assert "there is no exercise 'spiral'" in said
    assert all(name in said for name in names())
    assert not (tmp_path / "course").exists()


@pytest.mark.parametrize("verb", ["course", "new"])
def test_the_help_lists_the_exercises(capsys, verb):
    with pytest.raises(SystemExit):
        main([verb, "--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert all(name in said for name in names())


def test_release_points_and_language_are_taken_over_and_an_exercise_named_twice_once(tmp_path):
    words = ["--ros", "kilted", "--pass-points", "72.5", "--lang", "fr"]
    once = "turtlesim_challenge"
    assert new(tmp_path, *words, "--exercises", once, once) == 0
    assert "turtlesim_py[kilted]==" in workflow(tmp_path)
    assert 'PASS_POINTS: "72.5"' in workflow(tmp_path)
    readme, sheet = (tmp_path / name / "README.md" for name in (".", f"templates/{once}"))
    assert readme.read_text().count(f"| `{once}` |") == 1
    assert "## The first week" in readme.read_text()  # steps are in English, sheets are not
    assert "Comment l'essayer" in sheet.read_text()
    (starter,) = tmp_path.rglob("turtle_controller.py")
    assert "turtlesim_msgs" in starter.read_text()


@pytest.mark.parametrize(
    ("said", "installed"),
    [
        ("./release", "{here}/release[jazzy]"),
        ("/opt/release[kilted]", "/opt/release[kilted]"),
        (
            "git+https://host.invalid/g.git@v1",
            "turtlesim_py[jazzy] @ git+https://host.invalid/g.git@v1",
        ),
        ("turtlesim_py[kilted]==1.0", "turtlesim_py[kilted]==1.0"),
        ("turtlesim_py==1.0", "turtlesim_py[jazzy]==1.0"),
        ("mine[x] @ git+ssh://git@host.invalid/g@v1", "mine[x] @ git+ssh://git@host.invalid/g@v1"),
        ("git+file:///srv/g@v1#egg=x", "turtlesim_py[jazzy] @ git+file:///srv/g@v1#egg=x"),
        (
            "https://host.invalid/g-1.tar.gz",
            "turtlesim_py[jazzy] @ https://host.invalid/g-1.tar.gz",
        ),
    ],
)
def test_a_source_is_given_whole_and_with_ros(tmp_path, capsys, monkeypatch, said, installed):
    monkeypatch.chdir(tmp_path)
    assert new(tmp_path / "course", "--source", said) == 0
    assert f'GRADER_SOURCE: "{installed.format(here=tmp_path)}"' in workflow(tmp_path)
    is_path = "it has to be the same where it is installed" in capsys.readouterr().out
    assert is_path == installed.startswith(("{", "/"))


@pytest.mark.parametrize(
    "source",
    [
        *('x"; rm -rf /', "$(id)", "`id`", "--index-url=x", "", "a\nb", "it's", "a\\b"),
        *("https://host.invalid/me/x", "x @ https://host.invalid/me/x.git", "turtlesim_py"),
        *("git+https://host.invalid/g.git", "git+https://host.invalid/g.git@"),
        *("git+ssh://git@host.invalid/g", "git+https://host.invalid/g@v1?token=x"),
    ],
)
def test_what_would_be_more_than_a_source_is_refused(tmp_path, capsys, source):
    assert new(tmp_path / "course", f"--source={source}") == 2
    assert "expected what pip installs" in capsys.readouterr().err
    assert not (tmp_path / "course").exists()


@pytest.mark.parametrize(
    "source",
    [
        *("git+https://hunter2@host.invalid/g.git@v1", "x @ https://me:hunter2@host.invalid/x.whl"),
        "git+ssh://git:hunter2@host.invalid/g@v1",
    ],
)
def test_a_secret_in_the_source_is_refused_and_not_repeated(tmp_path, capsys, source):
    assert new(tmp_path / "course", "--source", source) == 2
    said = capsys.readouterr().err
    assert "the CI's secret GRADER_SOURCE (github, gitlab)" in said and "hunter2" not in said
    assert not (tmp_path / "course").exists()


def test_where_the_version_is_unknown_the_source_has_to_be_said(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(system, "grader_version", lambda: system.UNKNOWN)
    assert new(tmp_path / "course") == 2
    assert "say with --source what to install" in capsys.readouterr().err
    assert new(tmp_path / "course", "--source", "git+https://host.invalid/g.git@v1") == 0


@pytest.mark.parametrize(
    ("kind", "words", "why"),
    [
        ("github", ["--pass-points", "101"], "expected 0 to 100"),
        ("github", ["--pass-points", "nan"], "expected 0 to 100"),
        ("gradescope", ["--pass-points", "60"], "gradescope has no check"),
    ],
)
def test_an_option_that_cannot_be_used_is_told(tmp_path, capsys, kind, words, why):
    assert new(tmp_path / "course", *words, kind=kind) == 2
    assert why in capsys.readouterr().err
    assert not (tmp_path / "course").exists()
