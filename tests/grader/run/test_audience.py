"""Who looks on at a run sees all of it, and changes nothing of it."""

import numpy as np
import pytest

from grader.recording.subject import Start
from grader.run import real_time, simulator_process, virtual_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
from grader.scenes.turtlesim.pages import TurtlesimPage
from tests.grader.run.conftest import LIMITS
from tests.hand_ins import SUBMISSIONS
from tests.tiers import others_are_more
from turtlesim_py.live.feed import News
from turtlesim_py.world import picture
from turtlesim_py.world.turtle import Sprite


class Onlooker:
    """Has the picture as a page would have it."""

    def __init__(self, speed: float | None) -> None:
        self.speed = speed
        self.told: list[object] = []
        self.ticks: list[int] = []
        self.wholes: list[News] = []
        self.mirror = TurtlesimPage(lambda news: news.canvas and self.wholes.append(news))

    def begins(self, plan, time):
        self.told.append((plan.start, time))
        self.mirror.begin()

    def hear(self, news):
        self.ticks += [each["tick"] for each in news]
        self.mirror.hear(news)

    def ends(self, is_whole):
        self.told.append(is_whole)

    def window(self):
        self.mirror.ask(self)
        whole = self.wholes[-1]
        turtles = [
            Sprite(*map(float, (*turtle["px"], turtle["heading"])), turtle["sprite"])
            for turtle in whole.content["turtles"]
        ]
        return picture.render(whole.canvas, tuple(whole.content["background"]), turtles)


SEEN = [("services/all_services", None), ("quick_spiral", 8.0)]


@pytest.mark.parametrize(
    ("name", "speed"), others_are_more("it takes its time", SEEN, "services/all_services")
)
def test_a_run_that_is_seen_is_the_same_run_and_is_seen_to_its_last_pixel(recorded, name, speed):
    unseen = recorded(name)
    onlooker = Onlooker(speed)
    with open_submission(SUBMISSIONS / f"{name}.py") as submission:
        seen = virtual_time.run(submission, Plan(LIMITS), audience=onlooker)
    assert onlooker.told == [(None, "virtual"), True]
    assert (seen.run.time, seen.run.trace_sha256) == ("virtual", unseen.run.trace_sha256)
    assert (seen.run.outcome, seen.run.flags) == (unseen.run.outcome, unseen.run.flags)
    assert (seen.topics, seen.output) == (unseen.topics, unseen.output)
    assert seen.observations == unseen.observations
    assert onlooker.ticks == sorted(onlooker.ticks)
    assert onlooker.ticks[0] == 0
    assert np.array_equal(onlooker.window(), seen.trace.window)


@pytest.mark.more("one in virtual time is seen")
def test_a_run_in_real_time_is_seen_as_well_from_where_it_starts(tmp_path):
    node = tmp_path / "node.py"
    node.write_text("import rclpy\nrclpy.init()\nrclpy.create_node('still')\n")
    onlooker = Onlooker(1.0)
    plan = Plan(Limits(0.3, 0.2, 1), start=Start(2.0, 3.0, 1.0))
    with open_submission(node) as submission:
        seen = real_time.run(submission, plan, audience=onlooker)
    assert onlooker.told == [(plan.start, "real"), True]
    assert np.array_equal(onlooker.window(), seen.trace.window)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_one_who_fails_is_told_nothing_more_and_the_run_goes_on(recorded):
    onlooker = Onlooker(None)

    def fail(news):
        raise KeyError("tick")

    onlooker.hear = fail
    with open_submission(SUBMISSIONS / "quick_spiral.py") as submission:
        seen = virtual_time.run(submission, Plan(LIMITS), audience=onlooker)
    assert seen.run.trace_sha256 == recorded("quick_spiral").run.trace_sha256
    assert onlooker.told == [(None, "virtual"), False]


def test_nobody_costs_nothing():
    with simulator_process.live_feed(None, Plan(LIMITS), "virtual") as feed:
        assert feed == ("", ())
