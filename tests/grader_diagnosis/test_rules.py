"""One recording a cause: a rule names it, with its place, and is silent where nothing is sure."""

from dataclasses import replace

import pytest

from grader.exercise.verdict import Verdict
from grader.recording.observations import (
    Caught,
    End,
    LintFinding,
    Raised,
    SlowCallback,
    SourceLine,
    Standstill,
    TimerLine,
    Wait,
)
from grader.recording.recording import NOT_THERE, OwnInterfaces, PublishedTopic, Recordings
from grader.recording.subject import Endpoint
from grader.text.message import Message
from grader_diagnosis.case import Case
from grader_diagnosis.diagnose import DISTURBING, RULES, diagnose
from tests.grader_diagnosis.cases import LINE, PEN, POSE, POSES, TWIST, VELOCITY, run_of, said


def end(kind, name, type_, used=1, is_met=False):
    return End(kind, name, type_, is_met, used, LINE)


def raising(type_, text="", place=LINE, **more):
    return run_of(said(raised=Raised(type_, text, 6.0, place), **more), "crashed", exit_code=1)


def field(said_, text):
    return raising("AssertionError", said_, replace(LINE, text=text))


TRACEBACK = """Traceback (most recent call last):
  File "/home/ada/drive.py", line 50, in <module>
    rclpy.spin(node)
  File "/usr/lib/python3.11/site-packages/rclpy/publisher.py", line 70, in publish
    self.__publisher.publish(msg)
AttributeError: 'float' object has no attribute 'x'
"""
UNFIT = (
    "[WARN] [1.0] [spiral]: New subscription discovered on topic '/turtle1/cmd_vel', requesting "
    "incompatible QoS. No messages will be sent to it. Last incompatible policy: RELIABILITY\n"
)
NEVER_AWAITED = (
    "/home/ada/drive.py:31: RuntimeWarning: coroutine 'Spiral.set_pen' was never awaited\n"
    "  self.set_pen(q)\n"
)
STAMPED = end("publisher", "/turtle1/cmd_vel", "geometry_msgs/msg/TwistStamped")
UNUSED = replace(VELOCITY, used=0)
ONE_POSE = replace(POSES, used=1)
NOT_A_POSE = end("subscription", "/pose", "geometry_msgs/msg/Pose", used=0)
FLAG = Message.of("the node used 6 s of processor time without waiting for ROS")

MISSPELT = {
    "set_up": "setup.py",
    "file": "launch/a.launch.py",
    "program": "drvie",
    "names": "drive",
}
ADD = "example_interfaces/srv/AddTwoInts"
#: What only a program with peers gets wrong: the service comes at 2 s.
ADDS = (Endpoint("service", "/add", ADD, "/adder", 2.0),)
IN_VAIN = Wait("/add", ADD, 1.0, None)
AT_SPIN = replace(LINE, text="rclpy.spin(node)")
UNANSWERED = LintFinding("unanswered", "on_add", "response", LINE)
#: Rule and words of what it says -> a recording that it explains; " .* " stands for more words.
CAUSES = {
    "starts_what_is_not_there: launch/a.launch.py starts .* Write one of these names": run_of(
        said(), flags=(NOT_THERE.given(**MISSPELT),)
    ),
    "crashed: Your node crashed at 6.0 s: .* division by zero (drive.py, line 39).": raising(
        "ZeroDivisionError", "division by zero"
    ),
    "crashed: Your node crashed: AttributeError: .* no attribute 'x' (drive.py, line 50).": run_of(
        outcome="crashed", output=TRACEBACK
    ),
    "crashed: A thread of your program crashed: .* no attribute 'x' (drive.py, line 50).": run_of(
        said(), output=f"Exception in thread Thread-1 (go):\n{TRACEBACK}[INFO] on\n"
    ),
    "crashed: Your node crashed at 6.0 s: .* 'Spiral' object has no attribute 'period'": raising(
        "AttributeError",
        "'Spiral' object has no attribute 'period'",
        spun_s=None,
        ends=(VELOCITY, replace(POSES, used=0, place=LINE)),
    ),
    "crashed: is not callable (drive.py, line 39). .* self.NAME, not self.NAME()": raising(
        "TypeError", "'NoneType' object is not callable"
    ),
    "crashed: takes 0 positional arguments .* Write def on_timer(self).": raising(
        "TypeError", "Spiral.on_timer() takes 0 positional arguments but 1 was given"
    ),
    "crashed: publish() was given the class Twist .* The parentheses are missing: Twist()": raising(
        "TypeError", "Expected <class 'g._twist.Twist'>, got <class 'g.Metaclass_Twist'>"
    ),
    "crashed: spin has to be given the node, it .* (drive.py, line 39). Make a node": raising(
        "AttributeError",
        "'function' object has no attribute 'subscriptions'",
        place=replace(LINE, text="rclpy.spin(main)"),
    ),
    "crashed: no request of this service (drive.py, line 39). Are parentheses missing": raising(
        "TypeError", place=replace(LINE, text="self.pen.call_async(request)")
    ),
    "crashed: the Node is not made yet .* must come first": raising(
        "AttributeError", "'Spiral' object has no attribute '_default_callback_group'"
    ),
    "crashed: A Node has a `timers` of its own: choose another name": raising(
        "AttributeError", "property 'timers' of 'Spiral' object has no setter"
    ),
    "crashed: rclpy.init() has not been called (drive.py, line 39). Call rclpy.init()": raising(
        "NotInitializedException", "rclpy.init() has not been called. msg:cannot create"
    ),
    "crashed: KeyError: 4 (drive.py, line 39). COLORS has no entry 4:": raising(
        "KeyError", "4", replace(LINE, text="request.r = COLORS[q]")
    ),
    "crashed: create_publisher() was given values .* the order: create_publisher(Twist,": raising(
        "TypeError",
        "rclpy_resolve_name(): incompatible function arguments. Invoked with: <grader.run",
        replace(LINE, text="self.pub = self.create_publisher('/cmd', Twist, 10)"),
    ),
    "crashed: create_client() was given values of other types, or in another order": raising(
        "AttributeError",
        "type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 message type",
        replace(LINE, text="self.pen = self.create_client('/turtle1/set_pen', SetPen)"),
    ),
    "crashed: there is no file /home/ada/gains.yaml where your node is graded": raising(
        "FileNotFoundError", "[Errno 2] No such file or directory: '/home/ada/gains.yaml'"
    ),
    "crashed: a value of the right type that it cannot take. The whole traceback": raising(
        "ValueError", "math domain error"
    ),
    "unreadable: Python cannot read your file: .* expected ':' (drive.py, line 12).": raising(
        "SyntaxError", "expected ':'", SourceLine("drive.py", 12, "", "def drive(self)")
    ),
    "unreadable: Python cannot read your file: it .* NUL bytes, as text in UTF-16 does.": raising(
        "SyntaxError", "source code string cannot contain null bytes", None
    ),
    "unreadable: TabError: inconsistent .* begin in the same column": raising(
        "TabError", "inconsistent use of tabs and spaces in indentation"
    ),
    "not_importable: ModuleNotFoundError: No module named 'turtle_lib' (drive.py, line 39": raising(
        "ModuleNotFoundError", "No module named 'turtle_lib'"
    ),
    "wrong_value: The field x of a message must be a .* line 39). Write 2.0 instead of 2": field(
        "The 'x' field must be of type 'float'", "twist.linear.x = 2"
    ),
    "wrong_value: must be an int; .* Write 255 instead of 255.0": field(
        "The 'r' field must be of type 'int'", "SetPen.Request(r=255.0, g=0)"
    ),
    "wrong_value: The field x of a message must be a float; something else was given.": run_of(
        said(returned_s=0.5), "exited", output="oh: The 'x' field must be of type 'float'\n"
    ),
    "wrong_value: The field r of a message must be a .* from 0 to 255; .* 256 is not.": field(
        "The 'r' field must be an unsigned integer in [0, 255]", "request.r = 256"
    ),
    "hears_nobody: You subscribe to /pose, which .* of type turtlesim/msg/Pose": raising(
        "AttributeError", "'NoneType' object has no attribute 'x'", ends=(NOT_A_POSE,)
    ),
    "hears_nobody: You subscribe to /turtle1/Pose, .* there is /turtle1/pose (drive": run_of(
        said(VELOCITY, end("subscription", "/turtle1/Pose", POSE, 0))
    ),
    "hears_nobody: You subscribe to /turtle1/pose as .* there, so no message reaches you": run_of(
        said(VELOCITY, end("subscription", "/turtle1/pose", "geometry_msgs/msg/Pose", 0, True))
    ),
    "never_spins: Your program never spins its .* is ever called (drive.py, line 39).": raising(
        "AttributeError",
        "'NoneType' object has no attribute 'x'",
        spun_s=None,
        ends=(VELOCITY, replace(POSES, used=0, place=LINE)),
    ),
    "never_spins: Your program ended after 0.5 s and .* spun its node, .* rclpy.spin(node)": run_of(
        said(UNUSED, spun_s=None, returned_s=0.5), "exited"
    ),
    "has_unfit_qos: Your publisher on .* 10 instead of the QoS profile, or reliability=": run_of(
        said(replace(VELOCITY, is_met=False, place=LINE), POSES), output=UNFIT
    ),
    "never_awaits: An `async def` that nobody awaits .* line 31): nothing of set_pen()": run_of(
        said(), output=NEVER_AWAITED
    ),
    "ended_itself: Your program ended itself at 6.0 .* (drive.py, line 39).": raising(
        "SystemExit", "bye"
    ),
    "ended_itself: exit code 3, by no exception; the last that it printed is: 'bye'.": run_of(
        outcome="crashed", exit_code=3, output="hello\nbye\n"
    ),
    "killed: by the signal SIGABRT (drive.py, line 39): a library gave up on a value": run_of(
        said(raised=Raised("SIGABRT", "", 6.0, LINE)), "killed", exit_code=-6
    ),
    "publishes_to_nobody: You publish .* geometry_msgs/msg/Twist there (drive.py, line 39": run_of(
        said(STAMPED, POSES), "time_limit"
    ),
    "publishes_to_nobody: Your mine/msg/Num is not the .* nothing: Num.msg has more": replace(
        run_of(said(end("publisher", "/nums", "mine/msg/Num"), VELOCITY), "time_limit"),
        interfaces=OwnInterfaces({}, {}, {"mine/msg/Num": Message.of("Num.msg has more")}),
    ),
    "publishes_to_nobody: You publish .* on /turtle1/cmd_vel, but": run_of(
        topics=(PublishedTopic("/turtle1/cmd_vel", STAMPED.type),)
    ),
    "publishes_to_nobody: on /turtle/cmd_vel, where .* turtle listens to /turtle1/cmd_vel": run_of(
        said(end("publisher", "/turtle/cmd_vel", TWIST), POSES)
    ),
    "publishes_to_nobody: on /speed, where nobody .* turtle listens to /turtle1/cmd_vel": run_of(
        said(end("publisher", "/speed", TWIST))
    ),
    "publishes_to_nobody: You publish .* on /turtle1/cmd_vel, but the turtle listens to": raising(
        "TypeError",
        "Expected <class 'turtlesim.msg.Pose'>",
        replace(LINE, text="self.pub.publish(twist)"),
        ends=(End("publisher", "/turtle1/cmd_vel", POSE, False, 1, LINE),),
    ),
    "waits_in_vain: You wait for the service /set_pen .* offers; there is /turtle1/set_pen": run_of(
        said(waits=(Wait("/set_pen", PEN.type, 0.2, None, LINE),)), "stalled"
    ),
    "calls_nobody: You call the service /set_pen, .* offers; there is /turtle1/set_pen": run_of(
        said(VELOCITY, POSES, end("client", "/set_pen", PEN.type))
    ),
    "calls_nobody: You call the service .* std_srvs/srv/Empty, but it is turtlesim/srv/Set": run_of(
        said(end("client", "/turtle1/set_pen", "std_srvs/srv/Empty", is_met=True))
    ),
    "stuck_in_callback: Your node is stuck in on_pose() .* s on: .* call_async(request)": run_of(
        said(stop=Standstill("callback", 1.5, "Client.call", LINE)), "stalled"
    ),
    "stuck_in_callback: on_pose() waits in .* line 39) for what only another callback": run_of(
        said(
            VELOCITY,
            ONE_POSE,
            lint_findings=(LintFinding("waits", "on_pose", "rclpy.spin_once", LINE),),
        )
    ),
    "stuck_in_call: it waits in Rate.sleep() while .* A Rate needs a node that spins": run_of(
        said(stop=Standstill("call", 1.5, "Rate.sleep", LINE), spun_s=None), "stalled"
    ),
    "endless_loop: never leaves a loop in on_pose() (drive.py, line 39)": run_of(
        said(stop=Standstill("loop", 0.5, "", replace(LINE, text="while True:"))), "stalled"
    ),
    "endless_loop: computes without end": run_of(said(), "stalled", flags=(FLAG,)),
    "does_nothing: ended after 0.1 s without a publisher, .* is main() ever called?": run_of(
        replace(said(spun_s=None, returned_s=0.1), ends=()), "exited"
    ),
    "ends_early: Your program ended after 0.6 s, by .* handles one message and returns": run_of(
        said(replace(VELOCITY, used=1), POSES, returned_s=0.6), "exited", output="hello\n"
    ),
    "publishes_without_waiting: You published 190000 .* 10 s (drive.py, line 39): nothing": run_of(
        said(replace(VELOCITY, used=190_000, place=LINE))
    ),
    "publishes_without_waiting: You published 99998 .* 10 s (drive.py, line 39): nothing": run_of(
        said(replace(VELOCITY, used=99_998, place=LINE)), "killed"
    ),
    "hears_once: received /turtle1/pose hardly more .* s (drive.py, line 39), .* returned": run_of(
        said(VELOCITY, replace(POSES, used=1, place=LINE))
    ),
    "ends_before_spin: ROS is shut down before .* line 39) .* Move shutdown() behind": run_of(
        said(
            UNUSED,
            spun_s=None,
            lint_findings=(LintFinding("ends_before_spin", "shutdown", "", LINE),),
        )
    ),
    "ended_by_caught: Your program caught an .* ended after 6.1 s: KeyError: 4 (drive.py": run_of(
        said(returned_s=6.1, caught=(Caught("KeyError", "4", 6.0, 1, LINE),)), "exited"
    ),
    "unstarted: Nothing starts your thread spinner (drive.py, line 39) .* spinner.start()": run_of(
        said(spun_s=None, lint_findings=(LintFinding("unstarted", "spinner", "", LINE),)), "stalled"
    ),
    "called_at_once: calls run() at once, in the main .* parentheses: Thread(target=run)": run_of(
        said(spun_s=None, lint_findings=(LintFinding("called", "run", "Thread(target=", LINE),)),
        "stalled",
    ),
    "stays_in_init: Your program never leaves __init__(): it stays at": run_of(
        said(UNUSED, stop=Standstill("init", 0.1, "", replace(LINE, text="while True:"))), "stalled"
    ),
    "stays_in_init: never leaves __init__() .* spin() returns only when the program ends.": run_of(
        said(
            UNUSED,
            stop=Standstill("init", 0.1, "", replace(LINE, text="rclpy.spin(self)", line=20)),
            lint_findings=(LintFinding("spins_in_init", "spin", "", LINE),),
        )
    ),
    "spins_in_loop: never repeats: spin() returns only when the program ends": run_of(
        said(UNUSED, stop=Standstill("spin", 0.1, "", LINE)), "time_limit"
    ),
    "waits_for_timer: Your timer (drive.py, line 39) .* 100 s .* seconds, not milliseconds": run_of(
        said(UNUSED, timers=(TimerLine(LINE, 100.0, 1),))
    ),
    "hides_errors: on_pose() fails, and something in your program catches that and goes on": run_of(
        said(caught=(Caught("AttributeError", "no attribute 'X'", 0.1, 90, LINE),))
    ),
    "makes_timers: You create a new timer each time .* is called (drive.py, line 39): 600": run_of(
        said(timers=(TimerLine(LINE, 0.1, 600),))
    ),
    "hurries: has a period of 0.001 s: it comes as often as it can.": run_of(
        said(timers=(TimerLine(LINE, 0.001, 1),))
    ),
    "awaits: on_pose() waits by `await` for an .* (drive.py, line 39), .* Leave out await": run_of(
        said(VELOCITY, ONE_POSE, lint_findings=(LintFinding("awaits", "on_pose", "", LINE),))
    ),
    "slow_callback: on_pose() takes up to 0.2 s each .* it is called (drive.py, line 39);": run_of(
        said(slow=(SlowCallback(replace(LINE, text="time.sleep(0.2)"), 0.2, 50),)), "time_limit"
    ),
    "is_too_early: You call the service /add .* 39) before it is there, which is at 2.0 s": run_of(
        said(replace(end("client", "/add", ADD), used_at=LINE), waits=(IN_VAIN,))
    ),
    "is_too_early: Your program ended at 1.5 s, and the service /add came at 2.0 s only.": run_of(
        said(
            end("client", "/add", ADD, 0), waits=(replace(IN_VAIN, lasted_s=0.5),), returned_s=1.5
        ),
        "exited",
    ),
    "unanswered: on_add() (drive.py, line 39) .* and so your node crashed at 6.0 s.": raising(
        "TypeError", "", AT_SPIN, lint_findings=(UNANSWERED,)
    ),
}


@pytest.mark.parametrize("case", CAUSES)
def test_the_cause_is_named_with_its_place_and_with_what_to_do(case):
    rule, words = case.split(": ", 1)
    found = diagnose(Recordings(CAUSES[case]), (), {"": ADDS})
    assert found is not None
    assert (found.key, found.run) == (rule, 0)
    assert found.help
    whole = f"{found.cause!s} {found.help!s}"
    for part in words.split(" .* "):
        assert part in whole, whole


def test_each_rule_of_the_table_has_a_recording_that_it_explains_first():
    cases = [Case(recording, peers_have=ADDS) for recording in CAUSES.values()]
    first = (next((r for r in (*RULES, *DISTURBING) if r(case)), None) for case in cases)
    assert {*RULES, *DISTURBING} <= {*first}


SILENT = {
    "a right program": run_of(said()),
    "nothing is told": run_of(),
    "the right topic as well": run_of(said(VELOCITY, end("publisher", "/turtle2/cmd_vel", TWIST))),
    "a topic of its own": run_of(
        said(end("publisher", "/my_pose", POSE), end("subscription", "/my_pose", POSE))
    ),
    "something that nobody can guess": run_of(said(VELOCITY, end("client", "/go", "a/srv/B"))),
    "somebody else is there": run_of(
        said(VELOCITY, end("subscription", "/poses", POSE, is_met=True))
    ),
    "a wait that has ended": run_of(said(waits=(Wait("/turtle1/set_pen", PEN.type, 0, 3.0),))),
    "a subscription for each message": run_of(said(*[replace(POSES, used=1)] * 9)),
    "one message, and it was asked for one": run_of(
        said(replace(POSES, used=1, place=replace(LINE, text="wait_for_message(Pose, node, t)")))
    ),
    "a last pause": run_of(said(slow=(SlowCallback(LINE, 2.0, 1),))),
    "no spin, and none is needed": run_of(said(VELOCITY, spun_s=None, returned_s=40.0)),
    "the end of a long run": run_of(said(returned_s=40.0)),
    "a program in another language": run_of(outcome="exited"),
}


def of_check(rationale, help_="", **observed):
    texts = map(Message.of, (rationale, help_))
    verdict = Verdict("check", Message.of("Check"), "failed", 0, 20, *texts)
    found = diagnose(Recordings(run_of(said(**observed))), [verdict])
    assert found is not None
    return found


def test_a_check_that_found_an_end_unused_says_which():
    ends = (VELOCITY, POSES, replace(PEN, used=0, place=LINE))
    found = of_check("The pen was never changed.", "Call /turtle1/set_pen.", ends=ends)
    assert str(found.cause) == (
        "The pen was never changed. Your client (drive.py, line 39) has sent no request."
    )
    assert (str(found.help), found.place) == ("Call /turtle1/set_pen.", LINE)


@pytest.mark.parametrize(
    ("kind", "name", "near", "text", "help_"),
    [
        ("uncalled", "self.near", "", "`self.near` stands there without pa", "self.near()"),
        ("unread", "stoped", "stopped", "`self.stoped` is set and never read", "self.stopped"),
        ("local", "quad", "self.quad", "`quad` is a variable of this functi", "self.quad = ..."),
        (
            "swapped",
            "go",
            "a, b",
            "go() takes (a, b), and is given them in another order",
            "(a, b)",
        ),
    ],
)
def test_a_slip_stands_before_the_finding_that_it_may_explain(kind, name, near, text, help_):
    found = of_check("It ran into a wall.", lint_findings=(LintFinding(kind, name, near, LINE),))
    assert str(found.cause).startswith(text)
    assert str(found.cause).endswith(" (drive.py, line 39). It ran into a wall.")
    assert help_ in str(found.help)
    assert found.place == LINE


@pytest.mark.parametrize("near", ["", "publish", "publish nohow", "publish true a = 1"])
def test_a_recording_may_tell_of_unreached_lines_in_any_form(near):
    finding = LintFinding("unreached", "a > 1", near, LINE)
    found = of_check("It ran into the wall.", lint_findings=(finding,))
    assert str(found.cause).endswith("It ran into the wall.")


def test_a_slip_stands_with_the_line_that_it_is_in():
    findings = tuple(
        LintFinding(kind, "a", "b", LINE) for kind in ("method", "without_self", "class")
    )
    assert of_check("It ran into a wall.", lint_findings=findings).cause == Message.of(
        "It ran into a wall."
    )
    made = SourceLine("drive.py", 43, "watch", "request = SetPen.Request()")
    ends = (VELOCITY, POSES, replace(PEN, used=0, place=LINE))
    unsent = LintFinding("unsent", "SetPen", "", made)
    found = of_check("Call /turtle1/set_pen.", ends=ends, lint_findings=(unsent,))
    assert (found.place, str(found.help)) == (
        made,
        "Send the request that you make: call_async(request).",
    )
    place = replace(LINE, text="except Exception:")
    swallows = LintFinding("swallows", "tick", "", place)
    found = of_check("It never moved.", "Publish.", lint_findings=(swallows,))
    assert str(found.cause) == (
        "It never moved. `except Exception:` (drive.py, line 39) hides every error in tick()."
    )
    assert str(found.help) == "Publish. Without the try/except Python would say so itself."
    assert found.place == place


def test_the_finding_of_a_check_has_the_line_that_sends_what_it_speaks_of():
    sends = replace(LINE, line=50)
    ends = (replace(VELOCITY, used_at=LINE), POSES, replace(PEN, used_at=sends))
    assert of_check("set_pen was called 90 times.", ends=ends).place == sends
    assert of_check("linear.x was 1 in every command.", ends=ends).place == LINE
    assert of_check("It is all wrong.", ends=ends).place is None


@pytest.mark.parametrize(
    ("error", "times", "key"),
    [
        ("AttributeError: 'NoneType' object has no attribute 'x'", 3, "check"),
        ("AttributeError: 'NoneType' object has no attribute 'x'", 90, "hides_errors"),
        ("KeyError: 'a'", 30, "check"),
    ],
)
def test_a_message_that_is_none_at_first_and_a_look_up_are_no_hidden_errors(error, times, key):
    type_, text = error.split(": ")
    assert of_check("Seen.", caught=(Caught(type_, text, 0.1, times, LINE),)).key == key


def of_crash(type_, text, place, *findings):
    found = diagnose(Recordings(raising(type_, text, place, lint_findings=findings)))
    assert found is not None
    return found


def test_a_name_of_the_source_is_no_pattern():
    comma = LintFinding("comma", "a(", "", replace(LINE, line=3))
    place = replace(LINE, text="twist.linear.x = 2")
    found = of_crash("AssertionError", "The 'x' field must be of type 'float'", place, comma)
    assert found.place == place


def of_import(text, *findings):
    return of_crash("ImportError", text, LINE, *findings)


def test_an_import_that_fails_is_told_with_what_is_there():
    text = "cannot import name 'COLORS' from 'pens.colours'"
    near, all_ = (LintFinding("not_defined", "COLORS", e, LINE) for e in ("COLOURS", "RED, red"))
    assert str(of_import(text, near).help) == (
        "Your module pens.colours has COLOURS, not COLORS: write that."
    )
    assert "has no COLORS; it has: RED, red." in str(of_import(text, all_).help)
    text = "cannot import name 'Node' from partially initialized module 'pens.node'"
    place = replace(LINE, file="pens/colours.py", line=1)
    used = LintFinding("circular", "pens/colours.py", "", replace(LINE, file="pens/node.py"))
    unused = LintFinding("circular", "pens/node.py", "unused", place)
    found = of_import(text, used, unused)
    assert "pens/node.py imports pens/colours.py, and pens/colours.py imports" in str(found.cause)
    assert found.place == place
    assert str(found.help) == "Take that import out: pens/colours.py uses nothing of it."
    assert "a third file" in str(of_import(text, used).help)
    place = replace(LINE, text="from my_colors import COLORS")
    slip = LintFinding("beside", "my_colors", "my_package.my_colors", place)
    found = of_crash("ModuleNotFoundError", "No module named 'my_colors'", place, slip)
    assert str(found.help) == "Write `from my_package.my_colors import COLORS` there."


@pytest.mark.parametrize("name", SILENT)
def test_a_rule_that_is_not_sure_is_silent(name):
    assert diagnose(Recordings(SILENT[name])) is None
