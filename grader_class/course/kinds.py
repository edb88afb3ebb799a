"""The systems that a course can be graded on, and where each has its files.

In a path, and in the folders below `templates/`, EXERCISE stands for each exercise of the course.
"""

from __future__ import annotations

from dataclasses import dataclass

#: In paths: each exercise.
EXERCISE = "EXERCISE"
GRADE, INSTALL, PUBLISH = "grade.sh", "install.sh", "publish.sh"


@dataclass(frozen=True)
class Kind:
    """A system, and where a repository for it has what all of them have.

    Attributes:
        title: what the system is called.
        starter: the folder of a starter.
        rubric: the exercise that is graded by, an edited copy.
        scripts: the folder of `grade.sh` and `install.sh`.
        unusable: what a submission gets that cannot be used, there.
        failed: what becomes of one where the grader fails.
        log: where the staff reads what the grader said.
        is_copied: whether the starter is a repository of which each student gets a copy.
        slug: what stands for the `_` of an exercise's name.
    """

    title: str
    starter: str
    rubric: str
    scripts: str
    unusable: str
    failed: str
    log: str = "the system's log of the run"
    is_copied: bool = False
    slug: str = "_"


KINDS = {
    "gradescope": Kind(
        "Gradescope",
        "starters/EXERCISE",
        "autograders/EXERCISE/rubric.yaml",
        "autograders/EXERCISE",
        "0, with the message",
        'none; "This is not your fault", and `grader_failed` in `extra_data`',
        "the output that only the staff sees",
    ),
    "classroom50": Kind(
        "Classroom 50",
        "templates/EXERCISE",
        "autograders/EXERCISE/rubric.yaml",
        "autograders/EXERCISE",
        "0, in a release with the message",
        "none; an error",
        is_copied=True,
        slug="-",
    ),
    "github": Kind(
        "GitHub Actions",
        "templates/EXERCISE",
        "templates/EXERCISE/.github/grader/rubric.yaml",
        "templates/EXERCISE/.github/grader",
        '0; the check is red, "0 points: cannot be graded"',
        'none; the job is red, the check "Not graded"',
        "`log.txt` of the artifact",
        is_copied=True,
    ),
    "gitlab": Kind(
        "GitLab CI",
        "templates/EXERCISE",
        "templates/EXERCISE/.gitlab/grader/rubric.yaml",
        "templates/EXERCISE/.gitlab/grader",
        '0; the job is red, "Points: 0", a failed test',
        "none; the job is tried again, then red",
        "`log.txt` of the artifacts",
        is_copied=True,
    ),
}
#: Where PASS_POINTS makes a check green.
HAVE_A_CHECK = ("github", "gitlab")
