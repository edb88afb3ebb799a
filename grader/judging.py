"""Judge recordings, on any system: this runs nothing."""

from __future__ import annotations

import os
from pathlib import Path

from grader.exercise import check
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.result.diagnosis import diagnose
from grader.exercise.result.result import Result, build
from grader.recording import reading, saving
from grader.recording.recording import Recording, Recordings
from grader.system.extensions import DEFAULT_EXERCISE

AnyPath = str | os.PathLike[str]


def judge(
    recordings: Recordings, exercise: AnyPath | Exercise = DEFAULT_EXERCISE, *, submission: str = ""
) -> Result:
    """Judge recordings, as often as needed.

    Args:
        submission: its name, for the result.

    Raises:
        ExerciseError: there is no such exercise, or it cannot be used.
    """
    asked = loaded(exercise)
    verdicts = check.judge(recordings, asked.checks, asked.points, asked.tolerances)
    cause = diagnose(asked, recordings, verdicts)
    return build(submission, asked, recordings, verdicts, cause)


def load_recordings(folder: AnyPath) -> Recordings:
    """Load the recordings in the folder `recording` of a graded run.

    Raises:
        RecordingError: there are none that can be judged.
    """
    return reading.load_all(Path(folder))


def save_recordings(recordings: Recordings, folder: AnyPath) -> None:
    """Write recordings into a folder, as `grader run` does.

    Raises:
        OSError: it cannot be written.
    """
    saving.save_all(recordings, Path(folder))


def judge_nominal(nominal: Recording, exercise: Exercise, *, submission: str = "") -> Result:
    """Judge the nominal run alone; return a result without the other verdicts."""
    verdicts = check.judge_nominal(nominal, exercise.checks, exercise.points, exercise.tolerances)
    alone = Recordings(nominal)
    cause = diagnose(exercise, alone, verdicts)
    return build(submission, exercise, alone, verdicts, cause)


def loaded(exercise: AnyPath | Exercise) -> Exercise:
    """Return an exercise, loaded if it is not yet."""
    return exercise if isinstance(exercise, Exercise) else load_exercise(exercise)
