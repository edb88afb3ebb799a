"""Real submissions with a beginner's mistake: the first line of the report names the cause."""

import pytest

from grader.exercise.loading import load_exercise
from grader.exercise.result.diagnosis import CHECK
from grader.exercise.verdict import Verdict
from grader.recording.recording import Recordings
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.scenes.scene import Limits
from grader.text.message import Message
from grader_diagnosis import standstill
from grader_diagnosis.case import Case
from grader_diagnosis.diagnose import diagnose
from tests import hand_ins, runs
from tests.grader.run.conftest import LIMITS
from tests.grader.test_fixture_verdicts import SPOILT
from tests.grader.test_interfaces import FOLDER, JUDGED, OTHERWISE, graded, run
from tests.grader_diagnosis.cases import expect_said
from tests.tiers import others_are_more

PLAN = Plan(Limits(first_motion_s=3, rest_s=1, total_s=10))
#: What loops for ever is not waited for as long as a student's imports would be.
PATIENCE = Patience(stall_cpu_s=0.5, start_cpu_s=1.5)
OTHERS = "test_rules.py has what such runs leave; of each rule one is run for real, of checks all"

#: Mutants whose runs show what is wrong, whatever was asked for.
SHOWS_BY_ITSELF = {
    **dict.fromkeys(("wrong_topic", "wrong_type", "wrong_turtle"), "publishes_to_nobody"),
    **dict.fromkeys(("crashes_after_six_seconds", "crashes_after_ten_seconds"), "crashed"),
    "never_spins": "never_spins",
}

LOSING = [name for name, row in JUDGED.items() if "says" in row]
WITHOUT_A_RUN = "tests/grader/submission/test_interfaces.py finds them without a run"
WRONG = hand_ins.read("interfaces")["wrong"]
LOST = [Verdict("check", Message.of("Check"), "failed", 0, 20, Message.of("It lacks something."))]


def said_of(group):
    """Programs of which a group says the first line -> what it says; some are of other groups."""
    rows = {name: row for name, row in hand_ins.read(group).items() if "says" in row}
    return {name if "/" in name else f"{group}/{name}": row for name, row in rows.items()}


def first_of_each_rule(rows, without=()):
    rules = {row["key"]: name for name, row in reversed(rows.items())}
    return [name for rule, name in rules.items() if rule not in without]


MISTAKES, TUTORIALS = said_of("first_lines"), said_of("first_lines/tutorials")
FIRST = first_of_each_rule(MISTAKES)
OF_CHECKS = [name for name, row in MISTAKES.items() if row["key"] == CHECK]
WITH_PEERS = first_of_each_rule(TUTORIALS, without=[MISTAKES[name]["key"] for name in FIRST])


@pytest.mark.parametrize("name", others_are_more(OTHERS, MISTAKES, *FIRST, *OF_CHECKS))
def test_the_first_line_is_the_cause(name):
    row, lost = MISTAKES[name], []
    if "check" in row:  # what it found
        texts = map(Message.of, row["check"])
        lost = [Verdict("check", Message.of("Check"), "failed", 0, 20, *texts)]
    expect_said(diagnose(Recordings(runs.recorded(name, PLAN, PATIENCE)), lost), row)


@pytest.mark.parametrize("name", others_are_more(OTHERS, TUTORIALS, *WITH_PEERS))
def test_the_first_line_names_the_mistake_in_a_program_with_peers(name):
    row = TUTORIALS[name]
    expect_said(runs.graded(name, load_exercise(row["exercise"])).diagnosis, row)


@pytest.mark.parametrize("name", SPOILT)
def test_a_mutant_is_told_why_it_loses_points(name):
    assert runs.graded(f"mutants/{name}").diagnosis.key == SHOWS_BY_ITSELF.get(name, CHECK)


@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", others_are_more("of the same kind", LOSING, "a_wrong_cmake"))
def test_a_workspace_gets_the_first_lines_that_were_judged_by_hand(tmp_path, name):
    expect_said(graded(name, tmp_path).diagnosis, JUDGED[name])


@pytest.mark.parametrize(
    "name", others_are_more(WITHOUT_A_RUN, WRONG, "not_listed", "wrong_module", "misspelt_field")
)
def test_the_first_lines_say_what_is_wrong(name):
    expect_said(diagnose(Recordings(run(FOLDER / "wrong" / name)), LOST), WRONG[name])


def test_types_that_the_two_sides_define_otherwise_exchange_nothing():
    found = diagnose(Recordings(run(runs.REFERENCE, OTHERWISE)), LOST)
    assert found.key == "publishes_to_nobody"
    assert "create_publisher(Twist" in found.place.text
    assert "not the exercise's, and the two exchange nothing: Twist.msg" in str(found.cause)


def test_who_waits_for_messages_without_spinning_is_not_told_to_spin():
    recording = runs.recorded("observed/waits_for_message", Plan(LIMITS))
    assert standstill.never_spins(Case(recording)) is None


def test_a_program_that_shuts_ros_down_itself_and_spins_on_has_not_crashed():
    of = runs.path_of("tutorials/action_client/right/official").read_text(encoding="utf-8")
    spin = "    rclpy.spin(action_client)\n"
    executor = (
        "executor = rclpy.executors.SingleThreadedExecutor()\n    executor.add_node(action_client)"
    )
    loop = f"    {executor}\n    while True:\n        executor.spin_once()\n"
    result = runs.graded(runs.written(of.replace(spin, loop)), load_exercise("action_client"))
    assert (result.score, result.diagnosis) == (100, None)
