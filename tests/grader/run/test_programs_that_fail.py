"""Whatever one of several programs does, wherever: the others go on, and it is the one to blame."""

import pytest

from grader.run import virtual_time
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
from tests.grader.run.test_several_programs import TEXTS, package
from turtlesim_py.world.events import CmdVel

PLAN = Plan(Limits(first_motion_s=20, rest_s=20, total_s=4))
PATIENCE = Patience(start_cpu_s=2.0, stall_cpu_s=0.5)
STAGES = ["AT_IMPORT", "AT_CONSTRUCTOR", "AT_SPIN", "IN_CALLBACK", "WHILE_ASKED"]
#: What the program does -> the outcomes that it may have.
FATES = {
    "os._exit(3)": {"crashed"},
    "os.kill(os.getpid(), signal.SIGKILL)": {"killed"},
    "raise ValueError('no more')": {"crashed"},
    "while True: pass": {"stalled"},
    "while True: print('x' * 1000, flush=True)": {"killed", "stalled", "time_limit"},
}
CASES = [(fate, stage) for fate in FATES for stage in STAGES]
OTHERS = pytest.mark.more("one that is killed and one that raises stand for the others")
KEPT = {*CASES[len(STAGES) + 1 : 3 * len(STAGES) : len(STAGES) + 1]}


@pytest.mark.parametrize(
    ("fate", "stage"),
    [pytest.param(*case, marks=() if case in KEPT else OTHERS) for case in CASES],
)
def test_the_others_go_on_and_it_is_to_blame(tmp_path, fate, stage):
    text = TEXTS["victim"].replace("FATE", fate).replace(stage, "fail()")
    for other in STAGES:
        text = text.replace(other, "pass" if other != "AT_IMPORT" else "")
    folder = package(tmp_path, "asks", victim=text, drives=TEXTS["drives"])
    with open_submission(folder) as submission:
        recording = virtual_time.run(submission, PLAN, patience=PATIENCE)
    run = recording.run
    assert run.time == "virtual", run.flags
    asks, victim, drives = run.programs
    assert victim.outcome in FATES[fate], run
    assert run.outcome == victim.outcome
    if "print" in fate:  # the limit of what is printed is that of all together
        return
    assert (asks.exit_code, drives.exit_code) == (None, None)
    times_s = [event.tick * 0.016 for event in recording.trace.of_kind(CmdVel)]
    assert times_s[-1] > 3.8, times_s
