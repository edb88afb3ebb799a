from collections.abc import Callable
from typing import Any

from grader import errors as errors
from grader.errors import GraderError as GraderError
from grader.errors import SubmissionError as SubmissionError
from grader.errors import UsageError as UsageError
from grader.exercise.check import Checks as Checks
from grader.exercise.check import Tolerances as Tolerances
from grader.exercise.exercise import Exercise as Exercise
from grader.exercise.loading import load_exercise as load_exercise
from grader.exercise.result.result import Result as Result
from grader.exercise.result.visible import student_view as student_view
from grader.exercise.verdict import Expected as Expected
from grader.exercise.verdict import Finding as Finding
from grader.exercise.verdict import Verdict as Verdict
from grader.grading import exercise_for as exercise_for
from grader.grading import grade as grade
from grader.grading import record as record
from grader.judging import judge as judge
from grader.judging import load_recordings as load_recordings
from grader.judging import save_recordings as save_recordings
from grader.recording.evidence import Evidence as Evidence
from grader.recording.recording import Recording as Recording
from grader.recording.recording import Recordings as Recordings
from grader.run.opening import open_submission as open_submission
from grader.scenes.turtlesim.driven_path import DrivenPath as DrivenPath

def face(package: str, file: str) -> Callable[[str], Any]: ...
