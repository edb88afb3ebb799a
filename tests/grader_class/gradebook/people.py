"""A class as several course systems know it, with names as they are."""

from datetime import UTC, datetime

from PIL import Image

from grader.exercise.result.result import Result, SubmissionInfo
from grader.system.strict_json import to_json
from grader.text.message import Message
from grader_class.entry import Entry, HandIn, Person
from tests.grader.reports import samples

MAXIMUM = 40.0

#: Names that break what is careless of them.
NAMES = (
    "Zoë Müller-Łukasiewicz",
    'Seán "Seb" O\'Brien; Jr., M.Sc.',
    "李小龙",
    '=HYPERLINK("http://example.org","x")',
    "@anna_b",
    "-2+3+cmd|' /C calc'!A0",
    "two\nlines\tand a tab",
    "Points Possible",
    "../../etc/passwd",
    ".hidden ~file",
    "Anna_77_assignsubmission_file",
    "",
)


def person(number, **columns):
    return Person(f"s{number}", NAMES[number % len(NAMES)], columns)


def in_worksheet(number, **more):
    columns = {
        "Identifier": f"Participant {1000 + number}",
        "Full name": NAMES[number % len(NAMES)],
        "Email address": f"s{number}@example.org",
        "Status": "Submitted for grading",
        "Grade": "",
        "Maximum Grade": "40.00",
        "Grade can be changed": "Yes",
        "Last modified (submission)": "Monday, 2 November 2026, 9:15 AM",
        "Last modified (grade)": "-",
        "Feedback comments": "",
    }
    return person(number, **(columns | more))


def in_canvas(number, **more):
    """As Canvas's exported gradebook has him, with what he has handed in."""
    columns = {
        "Student": NAMES[number % len(NAMES)],
        "ID": str(7000 + number),
        "SIS User ID": f"sis-{number}",
        "SIS Login ID": f"login{number}",
        "Section": "Tuesday, 9 am",
        "Spiral (4711)": "",
        "Exported as": f"obrien_LATE_{7000 + number}_{90000 + number}_my_1_node.zip",
    }
    return person(number, **(columns | more))


def judged(folder, *people, deducted=0.0, **more):
    """Somebody, or a group, with 18.33 of 40 points, and a picture."""
    hand_in = HandIn(people[0].id, people, attempt=2, at=datetime(2026, 11, 2, 9, 15, tzinfo=UTC))
    own = folder / hand_in.id
    own.mkdir(parents=True, exist_ok=True)
    Image.new("RGB", (500, 500), "blue").save(own / "canvas.png")
    (own / "output.txt").write_text("Traceback: <script>alert(1)</script>")
    artifacts = {"canvas": "canvas.png", "output": "output.txt"}
    result = Result.from_json(samples.result(submission=hand_in.name, artifacts=artifacts, **more))
    if deducted:
        late = SubmissionInfo(people[0].id, deducted=deducted)
        result = Result.from_json(result.to_json() | {"handed_in": to_json(late)})
    return Entry(hand_in, "judged", MAXIMUM, result=result, folder=own)


def without_result(state, *people, message=""):
    return Entry(HandIn(people[0].id, people), state, MAXIMUM, message=Message.of(message))
