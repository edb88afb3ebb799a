"""What a look at a student's source shows, and what it is silent about."""

from __future__ import annotations

import ast

import pytest

from grader.recording.observations import LintFinding, SourceLine
from grader.run.opening import open_submission
from grader.submission import lint
from tests.hand_ins import SUBMISSIONS

TUTORIALS = SUBMISSIONS / "tutorials"
SETUP = """from setuptools import setup
setup(name="spiral", entry_points={"console_scripts": ["draw = spiral.draw:main"]})
"""
HEAD = "class Controller(Node):\n    def __init__(self):\n        self.stopped = False\n"
READ = "    def drive(self):\n        return self.stopped\n"
CALLBACK = "node.create_timer(1, tick)\n\ndef tick():\n    try:\n        drive()\n"
#: Source -> the one finding in it.
FOUND = {
    f"{HEAD}{READ}    def on_pose(self, pose):\n        self.stoped = True\n": (
        *("unread", "stoped", "stopped", 7),
    ),
    f"{HEAD}{READ}    def on_pose(self, pose):\n        stopped = True\n": (
        *("local", "stopped", "self.stopped", 7),
    ),
    "last = 0\ndef on_pose(pose):\n    if last:\n        last = pose\n": (
        *("global", "last", "global last", 1),
    ),
    "count = 0\ndef on_timer():\n    count += 1\n": ("global", "count", "global count", 1),
    "stop = False\ndef on_pose(pose):\n    stop = True\ndef drive():\n    print(stop)\n": (
        *("local", "stop", "global stop", 3),
    ),
    "def main():\n    near = False\n    def on_pose(pose):\n        near = True\n"
    "    while not near:\n        pass\n": ("local", "near", "nonlocal near", 4),
    f"{HEAD}    def near(self):\n        return self.stopped\n"
    "    def drive(self):\n        if not self.near and self.stopped:\n            pass\n": (
        *("uncalled", "self.near", "", 7),
    ),
    "def main():\n    rclpy.spin\nmain()\n": ("uncalled", "rclpy.spin", "", 2),
    "def main():\n    pass\nmain\n": ("uncalled", "main", "", 3),
    "class C:\n    def stop(self):\n        self.stop = True\n": ("method", "stop", "", 3),
    "class C:\n    def paint(r, g, b):\n        pass\n": ("without_self", "paint", "", 2),
    "def drive():\n    pass\nthreading.Thread(target=drive()).start()\n": (
        "called",
        "drive",
        "Thread(target=",
        3,
    ),
    "class C(Node):\n    pass\nrclpy.spin(C)\n": ("class", "C", "rclpy.spin", 3),
    "for colour in colours:\n    calls[colour] = lambda: send(colour)\n": ("late", "colour", "", 2),
    "if a:\n    q = 1\nif b:\n    q = 2\nelse:\n    q = 3\n": ("overrules", "q", "", 3),
    "def speed(now=time.time()):\n    return now\n": ("default", "now=time.time()", "", 1),
    "turn = math.atan2(y, x)\nsector = turn // 90\n": ("degrees", "turn // 90", "", 2),
    "class Paint(Node):\n    pass\nrclpy.init()\npainter = Paint()\n"
    "rclpy.spin(Drive())\npainter.destroy_node()\n": ("unspun", "painter", "Paint", 4),
    "Thread(target=rclpy.spin(node)).start()\n": ("called", "rclpy.spin", "Thread(target=", 1),
    "speed = 0\nspeed =+ 0.1\n": ("plus", "speed", "", 2),
    "painters[now]\n": ("uncalled", "painters[now]", "", 1),
    "requests = [Request()] * 4\n": ("shared", "[Request()] * 4", "", 1),
    f"{HEAD}        self.speed = 0.0\n    def go(self):\n        self.speed *= 1.01\n": (
        *("adds_nothing", "self.speed *= 1.01", "", 6),
    ),
    "def go():\n    if last != 'red':\n        change('Red', 255)\n": (
        *("other_text", "'red'", "'Red'", 2),
    ),
    "class C:\n    def _init_(self):\n        pass\n": ("misnamed", "_init_", "__init__", 2),
    "class A:\n    def on_pose(self):\n        pass\n\nclass B(A):\n"
    "    def on_Pose(self):\n        pass\n": ("misnamed", "on_Pose", "on_pose", 6),
    "while True:\n    speed = 0.0\n    speed += 0.1\n": ("resets", "speed", "", 2),
    f"{HEAD}    def on_pose(self, stopped):\n        stopped = self.stopped\n": (
        *("sides", "stopped", "self.stopped", 5),
    ),
    "from geometry_msgs.msg import Twist\ndef go():\n    msg = Twist()\n    msg.linear.x = 1.0\n": (
        *("unpublished", "msg", "", 3),
    ),
    "def go(request):\n    request.r = 255\n    request.r = 0\n": ("twice", "request.r", "", 3),
    "spinner = Thread(target=spin)\n": ("unstarted", "spinner", "", 1),
    "STEP = 0,5\n": ("comma", "STEP", "5", 1),
    "request = SetPen.Request(r=1)\n": ("unsent", "SetPen", "", 1),
    f"{CALLBACK}    except Exception:\n        pass\n": ("swallows", "tick", "", 6),
    f"{CALLBACK}    except:\n        print('oh')\n": ("swallows", "tick", "", 6),
    "node.create_timer(1, lambda: step())\ndef step():\n    try:\n        drive()\n"
    "    except (OSError, Exception) as error:\n        return\n": ("swallows", "step", "", 5),
}
NOTHING = {
    "a subscription that stands there as in ROS's tutorials": (
        f"{HEAD}        self.subscription = self.create_subscription(String, 'topic', print, 10)\n"
        "        self.subscription  # prevent unused variable warning\n"
    ),
    "other words": f"{HEAD}{READ}    def on_pose(self, p):\n        self.last_y = p\n",
    "what is read by its name": (
        f"{HEAD}{READ}    def on_pose(self, p):\n        self.stoped = getattr(self, 'x')\n"
    ),
    "numbers": "class C:\n    def __init__(self):\n        self.timer1 = 1\n    def f(self):\n"
    "        self.timer2 = self.timer1\n",
    "a property": "class C:\n    @property\n    def near(self):\n        return 1\n"
    "    def f(self):\n        if self.near:\n            pass\n",
    "a function that is replaced": "def near():\n    pass\nnear = None\nif near:\n    pass\n",
    "a variable with its own value first": "last = 0\ndef f():\n    last = 1\n    print(last)\n",
    "a factory for a thread": "def make():\n    return print\nThread(target=make())\n",
    "a request that is sent": "pen.call_async(SetPen.Request(r=1))\n",
    "no Python at all": "def (:\n",
    "an except that raises": f"{CALLBACK}    except Exception:\n        raise\n",
    "an except that names the error": f"{CALLBACK}    except Exception as e:\n        print(e)\n",
    "an except that shows it all": f"{CALLBACK}    except:\n        traceback.print_exc()\n",
    "an except of some errors": f"{CALLBACK}    except OSError:\n        pass\n",
    "an except where nothing is called back": "def main():\n    try:\n        node.destroy_node()\n"
    "    except Exception:\n        pass\nmain()\n",
    "an argument as default": "def near():\n    pass\ndef f(near):\n    if near:\n        pass\n",
}


#: What only gives a place to something that a run has shown.
PLACES = {
    *("sets", "constant", "never_read", "never_set", "no_super", "imports", "at_wall", "at_middle"),
    *("argument", "stays", "waits", "same_colour", "cancels", "grows", "holds", "zero", "ends"),
    "no_return",
}


def found_in(sources):
    found = lint.find(lint.parsed_of(sources), sources, lambda _: False)
    return [LintFinding(*each[:3], SourceLine(file, each[3])) for file, each in found]


def reported(sources):
    return [each for each in found_in(sources) if each.kind not in PLACES]


@pytest.mark.parametrize("source", FOUND)
def test_a_slip_is_found_with_its_line(source):
    found = [(s.kind, s.name, s.near, s.place.line) for s in reported({"a.py": source})]
    assert found == [FOUND[source]]


#: What gives the line to change, once a run has shown that something is wrong.
PLACED = {
    "def tick():\n    pass\nnode.create_timer(1.0, tick())\n": ("called_callback", "tick", 3),
    "def quadrant(x):\n    0 if x > 5 else 1\n": ("no_effect", "0 if x > 5 else 1", 2),
    f"{HEAD}    def go(self):\n        if self.stopped:\n            pass\n": (
        *("stays", "self.stopped", 5),
    ),
    f"{HEAD}    def go(self):\n        return self.speed\n": ("never_set", "speed", 5),
    f"{HEAD}    def go(self):\n        self.n += 1\n": ("never_set", "n", 5),
    "def pen(r, width, off):\n    pass\npen(255, 3, 0)\npen(9, 0, 3)\n": ("swapped", "pen", 4),
    "def main(args):\n    pass\n": ("entry", "main", 1),
    f"{HEAD}    def go(self):\n        self.n = self.n + 1\n": ("never_set", "n", 2),
    "from geometry_msgs.msg import Twist\nTwist = Twist()\n": ("hides_class", "Twist", 2),
    "class C:\n    def __init__(self):\n        self.v = 0.0,\n": ("comma", "v", 3),
    "pen(1, 2, 3)\npen(0, 0, 0)\npen(1, 2, 3)\n": ("same_colour", "(1, 2, 3)", 3),
    "def send(x):\n    msg.linear.x = x\nspeed = 0.0\ndef go():\n    send(speed)\n": (
        *("argument", "linear.x", 3),
    ),
    "node.create_timer(1.0, tick)\ndef tick():\n    paint()\ndef paint():\n"
    "    pen.call(request)\n": ("waits", "paint", 5),
    f"{HEAD}        self.create_subscription(Pose, 'pose', self.on_pose, 1)\n"
    "    def on_pose(self, pose):\n        self.speed += 0.1\n        self.timer.cancel()\n": (
        *("grows", "self.speed", 6),
    ),
    "if not ready:\n    raise SystemExit('late')\n": ("exits", "not ready", 2),
    f"{HEAD}    def go(self, q):\n        if q != self.q:\n            self.q = q\n": (
        *("keeps", "self.q", 6),
    ),
    "def on_pose(pose):\n    turn = pose.theta\n": ("heads", "pose.theta", 2),
    "def on_pose(pose):\n    timer.cancel()\n": ("cancels", "timer.cancel()", 2),
    "node.create_service(Add, 'add', add)\ndef add(request, response):\n    response.sum = 1\n": (
        *("unanswered", "add", 2),
    ),
    "ActionServer(node, Fibonacci, 'f', go)\ndef go(goal):\n    goal.succeed()\n": (
        *("unanswered", "go", 2),
    ),
    "def on_timer():\n    node.get_logger().debug('now')\n": (
        *("quiet", "node.get_logger().debug", 2),
    ),
    "from rclpy.executors import SingleThreadedExecutor\n"
    f"{HEAD}{READ}    def go(self):\n        self.stoped = True\n": ("unread", "stoped", 7 + 1),
}


@pytest.mark.parametrize("source", PLACED)
def test_what_is_wrong_only_where_a_run_shows_it_is_found_with_its_line(source):
    found = [(s.kind, s.name, s.place.line) for s in found_in({"a.py": source})]
    assert PLACED[source] in found


@pytest.mark.parametrize("name", NOTHING)
def test_what_may_be_meant_is_no_slip(name):
    assert reported({"a.py": NOTHING[name]}) == []


def test_in_the_right_programs_of_tutorials_nothing_is_blamed():
    blamed = {"uncalled", "unused", "local", "unread", "no_effect", "unspun", "unanswered", "quiet"}
    programs = [*TUTORIALS.glob("*/right/*.py"), *TUTORIALS.glob("*/with_form/*.py")]
    assert len(programs) > 60
    for path in programs:
        assert not blamed & {each.kind for each in lint.lint(path.parent, [path])}, path


def test_what_one_file_sets_another_may_read():
    base = "class Base:\n    def go(self):\n        return self.stoped\n"
    source = f"{HEAD}{READ}    def on_pose(self, pose):\n        self.stoped = True\n"
    assert reported({"a.py": source, "b.py": base}) == []


COLOURS = "from .node import Node\nRED = (255, 0, 0)\ndef red(): print(RED)\n"
TOLD = {
    "a name that a module of one's own lacks": (
        {"s/node.py": "from s.colours import GREEN, RED\nclass Node: pass\n"},
        [
            ("circular", "s/node.py", "unused", "s/colours.py", 1),
            ("not_defined", "GREEN", "RED, red", "s/node.py", 1),
            ("circular", "s/colours.py", "unused", "s/node.py", 1),
        ],
    ),
    "a name that is spelt otherwise": (
        {"s/draw.py": "from .colours import REDS\n", "s/node.py": "Node = 1\n"},
        [("not_defined", "REDS", "RED", "s/draw.py", 1)],
    ),
    "a function of another file that returns nothing": (
        {"s/draw.py": "from s.colours import red\nr = red()\n", "s/node.py": "Node = 1\n"},
        [("no_return", "r", "red", "s/colours.py", 3)],
    ),
    "what is there": (
        {"s/node.py": "from s import colours, walls\nNode = 1\n", "s/walls/a.py": "", "s/b.py": ""},
        [],
    ),
}


@pytest.mark.parametrize("name", TOLD)
def test_what_the_files_of_a_package_show_together_is_found(name):
    files, wanted = TOLD[name]
    found = found_in({"s/__init__.py": "", "s/colours.py": COLOURS, **files})
    kinds = ("not_defined", "circular", "no_return")
    told = [(s.kind, s.name, s.near, s.place.file, s.place.line) for s in found if s.kind in kinds]
    assert told == wanted


def test_what_a_package_shows_is_found_where_it_is_read(tmp_path):
    package = tmp_path / "spiral"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "pens.py").touch()
    (tmp_path / "setup.py").write_text(SETUP)
    source = "import math\nimport pens\n\ndef main():\n    print(pens)\n    main\n"
    (package / "draw.py").write_text(source)
    with open_submission(tmp_path) as submission:
        assert submission.lint_findings == (
            LintFinding("uncalled", "main", "", SourceLine("spiral/draw.py", 6, "", "main")),
            LintFinding(
                "beside", "pens", "spiral.pens", SourceLine("spiral/draw.py", 2, "", "import pens")
            ),
        )


LONG = f"0x{'f' * 6000}"  # Python reads it, and does not write it in decimals


@pytest.mark.parametrize(
    "source",
    [
        *("draw({[5]: 1})\n", "pen.r = {[5]: 1}\n", "pen(1e999, 2, 3)\npen(1e999, 2, 3)\n"),
        *(f"pen({LONG}, 0, 0)\npen({LONG}, 0, 0)\n", f"pen.r = {LONG}\n", f"speed == {LONG}\n"),
        *(f"{LONG}\n", f"pen({LONG}).r = 1\n", f"pen({'9' * 400}, 0, 0)\n"),
    ],
    ids=lambda source: source[:12],
)
def test_a_value_that_python_refuses_or_does_not_write_is_no_failure_of_ours(tmp_path, source):
    file = tmp_path / "draw.py"
    file.write_text(source)
    with open_submission(file) as submission:
        assert submission.found


def test_twice_the_source_takes_about_twice_the_steps(monkeypatch):
    steps = 0
    children = ast.iter_child_nodes

    def counted(node):
        nonlocal steps
        steps += 1
        return children(node)

    monkeypatch.setattr(ast, "iter_child_nodes", counted)
    taken = []
    for functions in (40, 80):
        steps = 0
        bodies = (f"def f{i}():\n    a = P()\n    m = Twist()\n" for i in range(functions))
        head = "from geometry_msgs.msg import Twist\nclass P(Node):\n    pass\n"
        found_in({"a.py": head + "".join(bodies)})
        taken.append(steps)
    assert taken[1] < 2.5 * taken[0]


def test_a_file_that_nobody_looks_through_is_started_all_the_same(tmp_path):
    deep = tmp_path / "draw.py"
    deep.write_text("main\n" * (lint.MOST_SOURCE // 5 + 1))
    with open_submission(deep) as submission:
        assert submission.lint_findings == ()
