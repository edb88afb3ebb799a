"""One recording a cause: a rule names it, with its place, and is silent where nothing is sure."""

from __future__ import annotations

from dataclasses import replace

import pytest

from grader.diagnosis.case import Case
from grader.diagnosis.diagnose import DISTURBING, RULES, diagnose
from grader.exercise.verdict import Verdict
from grader.message import plain_text
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
from grader.recording.recording import (
    NOT_THERE,
    OwnInterfaces,
    PublishedTopic,
    Recordings,
)
from grader.recording.subject import Endpoint
from tests.grader.diagnosis.cases import LINE, PEN, POSE, POSES, TWIST, VELOCITY, run_of, said


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
NOT_A_POSE = end("subscription", "/pose", "geometry_msgs/msg/Pose", used=0)
FLAG = plain_text("the node used 6 s of processor time without waiting for ROS")

MISSPELT = {"file": "launch/a.launch.py", "program": "drvie", "names": "drive"}
CAUSES = {
    "a launch file with a wrong name": (
        run_of(said(), flags=(NOT_THERE.given(**MISSPELT),)),
        "starts_what_is_not_there",
        "launch/a.launch.py starts drvie, which setup.py does not install; it installs drive. .* "
        "Write one of these names",
    ),
    "an exception": (
        raising("ZeroDivisionError", "division by zero"),
        "crashed",
        "Your node crashed at 6.0 s: ZeroDivisionError: division by zero (drive.py, line 39).",
    ),
    "an exception, known from the output alone": (
        run_of(outcome="crashed", output=TRACEBACK),
        "crashed",
        "Your node crashed: AttributeError: 'float' object has no attribute 'x' "
        "(drive.py, line 50).",
    ),
    "a syntax error": (
        raising("SyntaxError", "expected ':'", SourceLine("drive.py", 12, "", "def drive(self)")),
        "unreadable",
        "Python cannot read your file: SyntaxError: expected ':' (drive.py, line 12).",
    ),
    "UTF-16": (
        raising("SyntaxError", "source code string cannot contain null bytes", None),
        "unreadable",
        "Python cannot read your file: it holds NUL bytes, as text in UTF-16 does.",
    ),
    "an import": (
        raising("ModuleNotFoundError", "No module named 'turtle_lib'"),
        "not_importable",
        "ModuleNotFoundError: No module named 'turtle_lib' (drive.py, line 39",
    ),
    "an int in a float field": (
        field("The 'x' field must be of type 'float'", "twist.linear.x = 2"),
        "wrong_value",
        "The field x of a message must be a float; something else was given at 6.0 s "
        "(drive.py, line 39). Write 2.0 instead of 2",
    ),
    "a float in an int field": (
        field("The 'r' field must be of type 'int'", "SetPen.Request(r=255.0, g=0)"),
        "wrong_value",
        "must be an int; .* Write 255 instead of 255.0",
    ),
    "a field's refusal that the program has caught and printed": (
        run_of(
            said(returned_s=0.5), "exited", output="oh: The 'x' field must be of type 'float'\n"
        ),
        "wrong_value",
        "The field x of a message must be a float; something else was given.",
    ),
    "an exception in a thread": (
        run_of(said(), output=f"Exception in thread Thread-1 (go):\n{TRACEBACK}[INFO] on\n"),
        "crashed",
        "A thread of your program crashed: AttributeError: 'float' object has no attribute 'x' "
        "(drive.py, line 50).",
    ),
    "256": (
        field("The 'r' field must be an unsigned integer in [0, 255]", "request.r = 256"),
        "wrong_value",
        "The field r of a message must be a whole number from 0 to 255; .* 256 is not.",
    ),
    "None for want of a message": (
        raising("AttributeError", "'NoneType' object has no attribute 'x'", ends=(NOT_A_POSE,)),
        "hears_nobody",
        "You subscribe to /pose, which nobody publishes; there is /turtle1/pose of type "
        "turtlesim/msg/Pose",
    ),
    "None for want of a spin": (
        raising(
            "AttributeError",
            "'NoneType' object has no attribute 'x'",
            spun_s=None,
            ends=(VELOCITY, replace(POSES, used=0, place=LINE)),
        ),
        "never_spins",
        "Your program never spins its node, so none of its subscriptions and timers is ever "
        "called (drive.py, line 39).",
    ),
    "an attribute that is set too late, before a spin": (
        raising(
            "AttributeError",
            "'Spiral' object has no attribute 'period'",
            spun_s=None,
            ends=(VELOCITY, replace(POSES, used=0, place=LINE)),
        ),
        "crashed",
        "Your node crashed at 6.0 s: AttributeError: 'Spiral' object has no attribute 'period'",
    ),
    "a callback with brackets": (
        raising("TypeError", "'NoneType' object is not callable"),
        "crashed",
        "is not callable (drive.py, line 39). .* self.NAME, not self.NAME()",
    ),
    "a callback without self": (
        raising("TypeError", "Spiral.on_timer() takes 0 positional arguments but 1 was given"),
        "crashed",
        "takes 0 positional arguments .* Write def on_timer(self).",
    ),
    "a class that is published": (
        raising("TypeError", "Expected <class 'g._twist.Twist'>, got <class 'g.Metaclass_Twist'>"),
        "crashed",
        "publish() was given the class Twist itself, not a message (drive.py, line 39). "
        "The parentheses are missing: Twist()",
    ),
    "a function that is spun": (
        raising(
            "AttributeError",
            "'function' object has no attribute 'subscriptions'",
            place=replace(LINE, text="rclpy.spin(main)"),
        ),
        "crashed",
        "spin has to be given the node, it was given: function (drive.py, line 39). Make a node",
    ),
    "a request's class": (
        raising("TypeError", place=replace(LINE, text="self.pen.call_async(request)")),
        "crashed",
        "no request of this service (drive.py, line 39). Are parentheses missing",
    ),
    "no super().__init__": (
        raising("AttributeError", "'Spiral' object has no attribute '_default_callback_group'"),
        "crashed",
        "the Node is not made yet .* super().__init__('name_of_the_node') must come first",
    ),
    "a name that a Node has": (
        raising("AttributeError", "property 'timers' of 'Spiral' object has no setter"),
        "crashed",
        "A Node has a `timers` of its own: choose another name",
    ),
    "no init": (
        raising("NotInitializedException", "rclpy.init() has not been called. msg:cannot create"),
        "crashed",
        "rclpy.init() has not been called (drive.py, line 39). Call rclpy.init()",
    ),
    "no such entry": (
        raising("KeyError", "4", replace(LINE, text="request.r = COLORS[q]")),
        "crashed",
        "KeyError: 4 (drive.py, line 39). COLORS has no entry 4:",
    ),
    "arguments in another order": (
        raising(
            "TypeError",
            "rclpy_resolve_name(): incompatible function arguments. Invoked with: <grader.run",
            replace(LINE, text="self.pub = self.create_publisher('/cmd', Twist, 10)"),
        ),
        "crashed",
        "create_publisher() was given values of other types, or in another order (drive.py, "
        "line 39). Compare the order: create_publisher(Twist,",
    ),
    "a topic where the type belongs": (
        raising(
            "AttributeError",
            "type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 message type",
            replace(LINE, text="self.pen = self.create_client('/turtle1/set_pen', SetPen)"),
        ),
        "crashed",
        "create_client() was given values of other types, or in another order",
    ),
    "an indentation": (
        raising("TabError", "inconsistent use of tabs and spaces in indentation"),
        "unreadable",
        "TabError: inconsistent .* begin in the same column",
    ),
    "an exception that says all": (
        raising("ValueError", "math domain error"),
        "crashed",
        "a value of the right type that it cannot take. The whole traceback",
    ),
    "a QoS that does not fit": (
        run_of(said(replace(VELOCITY, is_met=False, place=LINE), POSES), output=UNFIT),
        "has_unfit_qos",
        "Your publisher on /turtle1/cmd_vel (drive.py, line 39) is BEST_EFFORT, the turtle "
        "listens RELIABLE: nothing arrives. Write 10 instead of the QoS profile, or reliability=",
    ),
    "a coroutine that nobody awaits": (
        run_of(said(), output=NEVER_AWAITED),
        "never_awaits",
        "An `async def` that nobody awaits was called (drive.py, line 31): nothing of set_pen()",
    ),
    "exit with a text": (
        raising("SystemExit", "bye"),
        "ended_itself",
        "Your program ended itself at 6.0 s by sys.exit('bye') (drive.py, line 39).",
    ),
    "an exit code": (
        run_of(outcome="crashed", exit_code=3, output="hello\nbye\n"),
        "ended_itself",
        "exit code 3, by no exception; the last that it printed is: 'bye'.",
    ),
    "an abort": (
        run_of(said(raised=Raised("SIGABRT", "", 6.0, LINE)), "killed", exit_code=-6),
        "killed",
        "by the signal SIGABRT (drive.py, line 39): a library gave up on a value",
    ),
    "another type on the right topic": (
        run_of(said(STAMPED, POSES), "time_limit"),
        "publishes_to_nobody",
        "You publish geometry_msgs/msg/TwistStamped on /turtle1/cmd_vel, but the turtle listens "
        "to geometry_msgs/msg/Twist there (drive.py, line 39",
    ),
    "a type that the exercise has otherwise": (
        replace(
            run_of(said(end("publisher", "/nums", "mine/msg/Num"), VELOCITY), "time_limit"),
            interfaces=OwnInterfaces({}, {}, {"mine/msg/Num": plain_text("Num.msg has more")}),
        ),
        "publishes_to_nobody",
        "Your mine/msg/Num is not the exercise's, and the two exchange nothing: Num.msg has more",
    ),
    "the same, known from the topics alone": (
        run_of(topics=(PublishedTopic("/turtle1/cmd_vel", STAMPED.type),)),
        "publishes_to_nobody",
        "You publish geometry_msgs/msg/TwistStamped on /turtle1/cmd_vel, but",
    ),
    "another topic": (
        run_of(said(end("publisher", "/turtle/cmd_vel", TWIST), POSES)),
        "publishes_to_nobody",
        "on /turtle/cmd_vel, where nobody listens; the turtle listens to /turtle1/cmd_vel",
    ),
    "a topic known by its type": (
        run_of(said(end("publisher", "/speed", TWIST))),
        "publishes_to_nobody",
        "on /speed, where nobody listens; the turtle listens to /turtle1/cmd_vel",
    ),
    "a capital letter": (
        run_of(said(VELOCITY, end("subscription", "/turtle1/Pose", POSE, 0))),
        "hears_nobody",
        "You subscribe to /turtle1/Pose, which nobody publishes; there is /turtle1/pose (drive",
    ),
    "the wrong Pose": (
        run_of(
            said(VELOCITY, end("subscription", "/turtle1/pose", "geometry_msgs/msg/Pose", 0, True))
        ),
        "hears_nobody",
        "You subscribe to /turtle1/pose as geometry_msgs/msg/Pose, but turtlesim/msg/Pose is "
        "published there, so no message reaches you",
    ),
    "a service waited for": (
        run_of(said(waits=(Wait("/set_pen", PEN.type, 0.2, None, LINE),)), "stalled"),
        "waits_in_vain",
        "You wait for the service /set_pen from 0.2 s on, which nobody offers; there is "
        "/turtle1/set_pen",
    ),
    "a service called": (
        run_of(said(VELOCITY, POSES, end("client", "/set_pen", PEN.type))),
        "calls_nobody",
        "You call the service /set_pen, which nobody offers; there is /turtle1/set_pen",
    ),
    "a service of another type": (
        run_of(said(end("client", "/turtle1/set_pen", "std_srvs/srv/Empty", is_met=True))),
        "calls_nobody",
        "You call the service /turtle1/set_pen as std_srvs/srv/Empty, but it is turtlesim/srv/Set",
    ),
    "a wait in a callback": (
        run_of(said(stop=Standstill("callback", 1.5, "Client.call", LINE)), "stalled"),
        "stuck_in_callback",
        "Your node is stuck in on_pose() (drive.py, line 39) from 1.5 s on: .* call_async(request)",
    ),
    "a rate that nobody spins": (
        run_of(said(stop=Standstill("call", 1.5, "Rate.sleep", LINE), spun_s=None), "stalled"),
        "stuck_in_call",
        "it waits in Rate.sleep() while nobody spins the node, .* A Rate needs a node that spins",
    ),
    "an endless loop": (
        run_of(
            said(stop=Standstill("loop", 0.5, "", replace(LINE, text="while True:"))), "stalled"
        ),
        "endless_loop",
        "never leaves a loop in on_pose() (drive.py, line 39)",
    ),
    "an endless loop somewhere": (
        run_of(said(), "stalled", flags=(FLAG,)),
        "endless_loop",
        "computes without end",
    ),
    "main is never called": (
        run_of(replace(said(spun_s=None, returned_s=0.1), ends=()), "exited"),
        "does_nothing",
        "ended after 0.1 s without a publisher, .* is main() ever called?",
    ),
    "no spin": (
        run_of(said(replace(VELOCITY, used=0), spun_s=None, returned_s=0.5), "exited"),
        "never_spins",
        "Your program ended after 0.5 s and never spun its node, .* rclpy.spin(node)",
    ),
    "one spin": (
        run_of(said(replace(VELOCITY, used=1), POSES, returned_s=0.6), "exited", output="hello\n"),
        "ends_early",
        "Your program ended after 0.6 s, by itself; until then it had published one message, and "
        "the last that it printed is: 'hello'. "
        "rclpy.spin_once(node) handles one message and returns",
    ),
    "a loop that publishes": (
        run_of(said(replace(VELOCITY, used=190_000, place=LINE))),
        "publishes_without_waiting",
        "You published 190000 messages on /turtle1/cmd_vel in 10 s (drive.py, line 39): nothing",
    ),
    "a loop that publishes until the grader ends it": (
        run_of(said(replace(VELOCITY, used=99_998, place=LINE)), "killed"),
        "publishes_without_waiting",
        "You published 99998 messages on /turtle1/cmd_vel in 10 s (drive.py, line 39): nothing",
    ),
    "a callback that does not return": (
        run_of(said(VELOCITY, replace(POSES, used=1, place=LINE))),
        "hears_once",
        "received /turtle1/pose hardly more than once in 10 s (drive.py, line 39), .* returned",
    ),
    "a shutdown before the spin": (
        run_of(
            said(
                replace(VELOCITY, used=0),
                spun_s=None,
                lint_findings=(LintFinding("ends_before_spin", "shutdown", "", LINE),),
            )
        ),
        "ends_before_spin",
        "ROS is shut down before anything spins (drive.py, line 39) .* Move shutdown() behind",
    ),
    "a publisher of another type, which refuses a message": (
        raising(
            "TypeError",
            "Expected <class 'turtlesim.msg.Pose'>",
            replace(LINE, text="self.pub.publish(twist)"),
            ends=(End("publisher", "/turtle1/cmd_vel", POSE, False, 1, LINE),),
        ),
        "publishes_to_nobody",
        "You publish turtlesim/msg/Pose on /turtle1/cmd_vel, but the turtle listens to",
    ),
    "an exception that the program caught, and ended": (
        run_of(
            said(returned_s=6.1, caught=(Caught("KeyError", "4", 6.0, 1, LINE),)),
            "exited",
        ),
        "ended_by_caught",
        "Your program caught an exception, and so ended after 6.1 s: KeyError: 4 (drive.py",
    ),
    "a thread that nothing starts": (
        run_of(
            said(spun_s=None, lint_findings=(LintFinding("unstarted", "spinner", "", LINE),)),
            "stalled",
        ),
        "unstarted",
        "Nothing starts your thread spinner (drive.py, line 39) .* spinner.start()",
    ),
    "a function that a thread was to run": (
        run_of(
            said(
                spun_s=None, lint_findings=(LintFinding("called", "run", "Thread(target=", LINE),)
            ),
            "stalled",
        ),
        "called_at_once",
        "calls run() at once, in the main program, .* without parentheses: Thread(target=run)",
    ),
    "a loop in __init__": (
        run_of(
            said(
                replace(VELOCITY, used=0),
                stop=Standstill("init", 0.1, "", replace(LINE, text="while True:")),
            ),
            "stalled",
        ),
        "stays_in_init",
        "Your program never leaves __init__(): it stays at",
    ),
    "a spin in __init__": (
        run_of(
            said(
                replace(VELOCITY, used=0),
                stop=Standstill("init", 0.1, "", replace(LINE, text="rclpy.spin(self)", line=20)),
                lint_findings=(LintFinding("spins_in_init", "spin", "", LINE),),
            )
        ),
        "stays_in_init",
        "never leaves __init__() .* spin() returns only when the program ends.",
    ),
    "a spin in a loop": (
        run_of(
            said(replace(VELOCITY, used=0), stop=Standstill("spin", 0.1, "", LINE)), "time_limit"
        ),
        "spins_in_loop",
        "never repeats: spin() returns only when the program ends",
    ),
    "a timer of milliseconds": (
        run_of(said(replace(VELOCITY, used=0), timers=(TimerLine(LINE, 100.0, 1),))),
        "waits_for_timer",
        "Your timer (drive.py, line 39) has a period of 100 s .* seconds, not milliseconds",
    ),
    "an error that a callback hides": (
        run_of(said(caught=(Caught("AttributeError", "no attribute 'X'", 0.1, 90, LINE),))),
        "hides_errors",
        "on_pose() fails, and something in your program catches that and goes on",
    ),
    "a timer for each message": (
        run_of(said(timers=(TimerLine(LINE, 0.1, 600),))),
        "makes_timers",
        "You create a new timer each time that on_pose() is called (drive.py, line 39): 600",
    ),
    "a timer of no time": (
        run_of(said(timers=(TimerLine(LINE, 0.001, 1),))),
        "hurries",
        "has a period of 0.001 s: it comes as often as it can.",
    ),
    "an await in a callback": (
        run_of(
            said(
                VELOCITY,
                replace(POSES, used=1),
                lint_findings=(LintFinding("awaits", "on_pose", "", LINE),),
            )
        ),
        "awaits",
        "on_pose() waits by `await` for an answer (drive.py, line 39), .* Leave out await",
    ),
    "a spin in a callback, beside a thread that spins": (
        run_of(
            said(
                VELOCITY,
                replace(POSES, used=1),
                lint_findings=(LintFinding("waits", "on_pose", "rclpy.spin_once", LINE),),
            )
        ),
        "stuck_in_callback",
        "on_pose() waits in rclpy.spin_once() (drive.py, line 39) for what only another callback",
    ),
    "a sleep in a callback": (
        run_of(
            said(slow=(SlowCallback(replace(LINE, text="time.sleep(0.2)"), 0.2, 50),)), "time_limit"
        ),
        "slow_callback",
        "on_pose() takes up to 0.2 s each time it is called (drive.py, line 39); ",
    ),
}


ADD = "example_interfaces/srv/AddTwoInts"
#: What only a program with peers gets wrong: the service comes at 2 s.
ADDS = (Endpoint("service", "/add", ADD, "/adder", 2.0),)
IN_VAIN = Wait("/add", ADD, 1.0, None)
AT_SPIN = replace(LINE, text="rclpy.spin(node)")
UNANSWERED = LintFinding("unanswered", "on_add", "response", LINE)
WITH_PEERS = {
    "a request before its service": (
        run_of(said(replace(end("client", "/add", ADD), used_at=LINE), waits=(IN_VAIN,))),
        "is_too_early",
        "You call the service /add (drive.py, line 39) before it is there, which is at 2.0 s",
    ),
    "a program that gives up": (
        run_of(
            said(
                end("client", "/add", ADD, 0),
                waits=(replace(IN_VAIN, lasted_s=0.5),),
                returned_s=1.5,
            ),
            "exited",
        ),
        "is_too_early",
        "Your program ended at 1.5 s, and the service /add came at 2.0 s only.",
    ),
    "a service that returns nothing": (
        raising("TypeError", "", AT_SPIN, lint_findings=(UNANSWERED,)),
        "unanswered",
        "on_add() (drive.py, line 39) returns no response, and so your node crashed at 6.0 s.",
    ),
}


@pytest.mark.parametrize("name", WITH_PEERS)
def test_the_cause_is_named_where_peers_play(name):
    recording, key, words = WITH_PEERS[name]
    found = diagnose(Recordings(recording), (), {"": ADDS})
    assert (found.key, words in str(found.cause)) == (key, True), str(found.cause)


@pytest.mark.parametrize("name", CAUSES)
def test_the_cause_is_named_with_its_place_and_with_what_to_do(name):
    recording, key, words = CAUSES[name]
    found = diagnose(Recordings(recording))
    assert found is not None
    assert found.key == key
    whole = f"{found.cause!s} {found.help!s}"
    first, *rest = words.split(" .* ")
    assert first.strip() in whole
    assert all(part in whole for part in rest), whole
    assert found.help
    assert found.run == 0


def test_each_rule_of_the_table_has_a_recording_that_it_explains_first():
    asked = (
        next(
            (
                r
                for rules in (RULES, DISTURBING)
                for r in rules
                if r(Case(recording, peers_have=ADDS))
            ),
            None,
        )
        for recording, *_ in (CAUSES | WITH_PEERS).values()
    )
    assert {*RULES, *DISTURBING} <= {*asked}


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


def test_a_check_that_found_an_end_unused_says_which():
    recording = run_of(said(VELOCITY, POSES, replace(PEN, used=0, place=LINE)))
    texts = map(plain_text, ("The pen was never changed.", "Call /turtle1/set_pen."))
    verdict = Verdict("pen", plain_text("Pen"), "failed", 0, 20, *texts)
    found = diagnose(Recordings(recording), [verdict])
    assert found is not None
    assert str(found.cause) == (
        "The pen was never changed. Your client (drive.py, line 39) has sent no request."
    )
    assert (str(found.help), found.place) == ("Call /turtle1/set_pen.", LINE)


def of_check(rationale, help_="", **observed):
    texts = map(plain_text, (rationale, help_))
    verdict = Verdict("check", plain_text("Check"), "failed", 0, 20, *texts)
    found = diagnose(Recordings(run_of(said(**observed))), [verdict])
    assert found is not None
    return found


SLIPS = {
    "uncalled": ("self.near", "", "`self.near` stands there without parentheses", "self.near()"),
    "unread": ("stoped", "stopped", "`self.stoped` is set and never read", "self.stopped"),
    "local": ("quad", "self.quad", "`quad` is a variable of this function", "self.quad = ..."),
}


@pytest.mark.parametrize("kind", SLIPS)
def test_a_slip_stands_before_the_finding_that_it_may_explain(kind):
    name, near, text, help_ = SLIPS[kind]
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


def test_a_slip_that_explains_an_exception_only_is_not_told_of_anything_else():
    findings = tuple(
        LintFinding(kind, "a", "b", LINE) for kind in ("method", "without_self", "class")
    )
    assert of_check("It ran into a wall.", lint_findings=findings).cause == plain_text(
        "It ran into a wall."
    )


def test_a_request_that_is_made_and_never_sent_is_told_with_its_line():
    made = SourceLine("drive.py", 43, "watch", "request = SetPen.Request()")
    ends = (VELOCITY, POSES, replace(PEN, used=0, place=LINE))
    unsent = LintFinding("unsent", "SetPen", "", made)
    found = of_check("Call /turtle1/set_pen.", ends=ends, lint_findings=(unsent,))
    assert (found.place, str(found.help)) == (
        made,
        "Send the request that you make: call_async(request).",
    )


def test_arguments_in_another_order_stand_before_the_finding_that_they_may_explain():
    swapped = LintFinding("swapped", "set_pen", "off, width", LINE)
    found = of_check("The pen is off.", lint_findings=(swapped,))
    assert str(found.cause) == (
        "set_pen() takes (off, width), and is given them in another order (drive.py, line 39). "
        "The pen is off."
    )
    assert str(found.help) == "Give them in the order of `def set_pen`: (off, width)."
    assert found.place == LINE


def test_the_finding_of_a_check_has_the_line_that_sends_what_it_speaks_of():
    sends = replace(LINE, line=50)
    ends = (replace(VELOCITY, used_at=LINE), POSES, replace(PEN, used_at=sends))
    assert of_check("set_pen was called 90 times.", ends=ends).place == sends
    assert of_check("linear.x was 1 in every command.", ends=ends).place == LINE
    assert of_check("It is all wrong.", ends=ends).place is None


def test_a_message_that_is_none_at_first_is_no_hidden_error():
    caught = Caught("AttributeError", "'NoneType' object has no attribute 'x'", 0.1, 3, LINE)
    assert of_check("Seen.", caught=(caught,)).key == "check"
    assert of_check("Seen.", caught=(replace(caught, times=90),)).key == "hides_errors"


def test_what_a_program_looks_up_and_does_not_find_is_no_hidden_error():
    caught = Caught("KeyError", "'a'", 0.1, 30, LINE)
    assert of_check("Seen.", caught=(caught,)).key == "check"


def test_an_except_that_hides_every_error_stands_behind_the_finding_that_it_may_explain():
    place = replace(LINE, text="except Exception:")
    swallows = LintFinding("swallows", "tick", "", place)
    found = of_check("It never moved.", "Publish.", lint_findings=(swallows,))
    assert str(found.cause) == (
        "It never moved. `except Exception:` (drive.py, line 39) hides every error in tick()."
    )
    assert str(found.help) == "Publish. Without the try/except Python would say so itself."
    assert found.place == place


def test_a_name_of_the_source_is_no_pattern():
    comma = LintFinding("comma", "a(", "", replace(LINE, line=3))
    said_ = "The 'x' field must be of type 'float'"
    place = replace(LINE, text="twist.linear.x = 2")
    found = diagnose(Recordings(raising("AssertionError", said_, place, lint_findings=(comma,))))
    assert found is not None
    assert found.place == place


def of_import(text, *findings):
    recording = raising("ImportError", text, LINE, lint_findings=findings)
    found = diagnose(Recordings(recording))
    assert found is not None
    return found


def test_a_name_that_an_own_module_lacks_is_told_with_what_it_has():
    text = "cannot import name 'COLORS' from 'pens.colours'"
    near, all_ = (LintFinding("not_defined", "COLORS", e, LINE) for e in ("COLOURS", "RED, red"))
    assert str(of_import(text, near).help) == (
        "Your module pens.colours has COLOURS, not COLORS: write that."
    )
    assert "has no COLORS; it has: RED, red." in str(of_import(text, all_).help)


def test_two_modules_that_import_each_other_are_told_with_the_import_that_nothing_uses():
    text = "cannot import name 'Node' from partially initialized module 'pens.node'"
    place = replace(LINE, file="pens/colours.py", line=1)
    used = LintFinding("circular", "pens/colours.py", "", replace(LINE, file="pens/node.py"))
    unused = LintFinding("circular", "pens/node.py", "unused", place)
    found = of_import(text, used, unused)
    assert "pens/node.py imports pens/colours.py, and pens/colours.py imports" in str(found.cause)
    assert found.place == place
    assert str(found.help) == "Take that import out: pens/colours.py uses nothing of it."
    assert "a third file" in str(of_import(text, used).help)


def test_a_module_that_lies_beside_is_told_by_its_full_name():
    place = replace(LINE, text="from my_colors import COLORS")
    slip = LintFinding("beside", "my_colors", "my_package.my_colors", place)
    text = "No module named 'my_colors'"
    recording = raising("ModuleNotFoundError", text, place, lint_findings=(slip,))
    found = diagnose(Recordings(recording))
    assert found is not None
    assert str(found.help) == "Write `from my_package.my_colors import COLORS` there."


@pytest.mark.parametrize("name", SILENT)
def test_a_rule_that_is_not_sure_is_silent(name):
    assert diagnose(Recordings(SILENT[name])) is None
