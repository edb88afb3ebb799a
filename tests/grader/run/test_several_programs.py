"""Several programs of a launch file in virtual time, each in a process of its own."""

from pathlib import Path

import pytest
import yaml

from grader.errors import SubmissionError
from grader.recording.recording import Recording
from grader.run import virtual_time
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.opening import open_submission
from grader.run.processes import levels
from grader.scenes.scene import Limits
from tests import runs
from tests.files import lay
from tests.grader.run.conftest import CLOCKS, LIMITS, at_levels, either_clock
from tests.hand_ins import SUBMISSIONS
from tests.tiers import others_are_more
from turtlesim_py.world.events import CmdVel, SetPen

LAUNCHED = SUBMISSIONS / "launched"
TEXTS: dict[str, str] = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())
PLAN = Plan(Limits(first_motion_s=20, rest_s=0.3, total_s=6))


def recorded(
    folder: Path, plan: Plan = PLAN, executable: str | None = None, clock: str = "virtual"
) -> Recording:
    with open_submission(folder, executable) as submission:
        recording = CLOCKS[clock](submission, plan)
    assert recording.run.time == clock, recording.run.flags
    return recording


def said(recording: Recording, name: str) -> list[str]:
    """What a program has printed."""
    mark = f"[{name}] "
    lines = recording.output.splitlines()
    return [line.removeprefix(mark) for line in lines if line.startswith(mark)]


def test_both_nodes_run_with_what_the_launch_file_gives_them():
    recording = recorded(LAUNCHED / "spiral")
    assert recording.run.flags == ()
    events = recording.trace.events
    assert any(isinstance(event, CmdVel) for event in events), recording.output
    assert {event.width for event in events if isinstance(event, SetPen)} == {5}


def test_a_conversation_of_programs_that_do_not_drive():
    still = Plan(Limits(first_motion_s=4, rest_s=4, total_s=4))
    conversation = recorded(LAUNCHED / "conversation", still)
    # what one sends the other hears at that moment
    first, *heard = said(conversation, "listener-2")
    times = [10_000_000 + second * 10**9 for second in range(4)]
    assert heard == [f"hello {100 * second} {time_ns}" for second, time_ns in enumerate(times)]
    # who comes late what is kept
    late = said(conversation, "late-5")
    assert late[1] == "first weather"
    # one waits for the service of another
    assert said(conversation, "asker-3") == ["not yet", "0", "2", "4"]
    # each sees those that are there, and draws its own random numbers
    assert first == "['listener', 'talker', 'turtlesim'] 1"
    is_asker_there, drawn = late[0].split()
    assert is_asker_there == "False"  # it has ended
    also_drawn, there = said(conversation, "dies-6")
    assert there == str(["adder", "dies", "late", "listener", "talker", "turtlesim"])
    assert drawn != also_drawn
    # who dies ends nobody else and is the one to blame
    assert (conversation.run.outcome, conversation.run.exit_code) == ("crashed", 3)


def package(folder: Path, *names: str, launch: str = "all.launch.py", **own: str) -> Path:
    """A package whose launch file starts programs, by name or text, in this order."""
    programs = {name: TEXTS[name] for name in names} | own
    files = {
        "package.xml": TEXTS["package.xml"],
        "setup.py": TEXTS["setup.py"].replace("NAMES", repr(list(programs))),
        "launch/all.launch.py": TEXTS[launch].replace("NAMES", repr(list(programs))),
        "company/__init__.py": "",
        **{f"company/{name}.py": text for name, text in programs.items()},
    }
    return lay(folder / "company", files)


def add(folder: Path, name: str, place: str, *changes: tuple[str, str]) -> None:
    """Add a file to a package, at a place of what is installed; change its launch file."""
    lay(folder, {name: TEXTS[Path(name).name]})
    setup, launch_file = folder / "setup.py", folder / "launch/all.launch.py"
    entry = '("share/company/launch"'
    setup.write_text(setup.read_text().replace(entry, f'("{place}", ["{name}"]), {entry}'))
    text = launch_file.read_text()
    for old, new in changes:
        text = text.replace(old, new)
    launch_file.write_text(text)


ORDERS = ("controller, idle", "idle, controller")


@pytest.mark.parametrize("order", others_are_more("one of both", ORDERS, "idle, controller"))
def test_beside_an_idle_one_a_program_does_what_it_does_alone(tmp_path, order):
    folder = package(tmp_path, *order.split(", "))
    both, alone = recorded(folder), recorded(folder, executable="controller")
    assert both.run.trace_sha256 == alone.run.trace_sha256


def test_who_computes_without_end_stalls_alone_and_the_first_that_failed_is_to_blame(tmp_path):
    folder = package(tmp_path, "raises", "computes", "drives")
    with open_submission(folder) as submission:
        recording = virtual_time.run(submission, PLAN, patience=Patience(stall_cpu_s=0.5))
    assert (recording.run.time, recording.run.outcome) == ("virtual", "stalled")
    assert "[raises-1] ValueError: no more" in recording.output
    times_s = [event.tick * 0.016 for event in recording.trace.of_kind(CmdVel)]
    assert times_s[-1] > 5.5, times_s  # who drives goes on to the end


def test_what_is_to_start_later_runs_from_then_on_or_was_not_run(tmp_path):
    folder = package(tmp_path, "stamps", "drives", launch="later.launch.py")
    recording = recorded(folder)
    begin = float(said(recording, "stamps-1")[0])
    late = [float(line) - begin for line in said(recording, "stamps-3")]
    assert late == pytest.approx([1.25, 1.75, 2.25], abs=1e-3)
    launch_file = folder / "launch/all.launch.py"
    launch_file.write_text(launch_file.read_text().replace("1.25", "60.0"))
    run = recorded(folder).run
    assert (run.programs[2].name, run.programs[2].outcome) == ("stamps-3", "not_run")
    assert "stamps-3 was to start at 60 s, when the run was over" in map(str, run.flags)


@either_clock
def test_each_program_is_in_the_result_with_how_it_has_ended(tmp_path, clock):
    folder = package(tmp_path, "raises", "stamps", "drives")
    run = recorded(folder, clock=clock).run
    ends = [(each.name, each.exit_code) for each in run.programs]
    assert ends == [("raises-1", 1), ("stamps-2", 0), ("drives-3", None)]
    assert (run.outcome, run.programs[0].outcome) == ("crashed", "crashed")
    assert [each.executable for each in run.programs] == ["raises", "stamps", "drives"]
    assert {each.package for each in run.programs} == {"company"}
    assert run.programs[0].output.endswith("ValueError: no more\n")
    assert len(run.programs[1].output.splitlines()) == 3


def test_what_one_writes_the_others_find_as_at_a_desk(tmp_path):
    recording = recorded(package(tmp_path, "writes", "reads"))
    assert said(recording, "reads-2") == ["['house', 'house', 'house']", "True True"]
    assert said(recording, "writes-1") == ["True True"]


@either_clock
def test_what_waits_for_the_end_of_another_starts_then_or_was_not_run(tmp_path, clock):
    names = ("stamps", "drives", "raises")
    folder = package(tmp_path, *names, launch="after.launch.py", late=TEXTS["stamps"])
    recording = recorded(folder, clock=clock)
    told = {each.name: each.exit_code for each in recording.run.programs}
    assert [told["drives-1"], told["raises-2"], told["late-4"]] == [None, 1, 0]
    assert len(said(recording, "late-4")) == 3
    if clock == "virtual":
        assert recording.run.programs[2].outcome == "not_run"
        flag = "stamps-3 was to start at the end of drives-1, which did not come"
        assert flag in map(str, recording.run.flags)
        assert float(said(recording, "late-4")[0]) == pytest.approx(2.5, abs=0.01)


@either_clock
def test_what_is_to_be_started_again_is_at_its_end(tmp_path, clock):
    folder = package(tmp_path, "drives", "stamps")
    launch_file = folder / "launch/all.launch.py"
    again = "executable=name, respawn=name == 'stamps', respawn_delay=0.25)"
    launch_file.write_text(launch_file.read_text().replace("executable=name)", again))
    with open_submission(folder) as submission:
        notes = list(map(str, submission.notes))
        recording = CLOCKS[clock](submission, PLAN)
    assert "stamps of launch/all.launch.py is started again 3 times at most" in notes
    names = [each.name for each in recording.run.programs]
    assert names == ["drives-1", *["stamps-2"] * len(names[1:])]
    if clock == "virtual":
        begins = [float(line) for line in said(recording, "stamps-2")[::3]]
        assert begins == pytest.approx([0.0, 1.75, 3.5, 5.25], abs=0.01)


def test_a_file_of_parameters_is_for_the_nodes_that_it_names(tmp_path):
    folder = package(tmp_path, "tells", other=TEXTS["tells"].replace('"drives"', '"other"'))
    share = 'FindPackageShare("company"), "/config/all.yaml"'
    node = f"executable=name, parameters=[[{share}], {{'own': '5'}}])"
    head = "from launch_ros.substitutions import FindPackageShare\nfrom launch import"
    changes = ("executable=name)", node), ("from launch import", head)
    add(folder, "config/all.yaml", "share/company/config", *changes)
    recording = recorded(folder)
    assert said(recording, "tells-1") == ["drives 2.5 map 5"]
    assert said(recording, "other-2") == ["other None map 5"]


def test_a_script_of_its_own_is_started_by_its_path(tmp_path):
    folder = package(tmp_path, "drives")
    command = "['python3', HERE + '/prepare.py', '--map', HERE + '/package.xml']"
    also = f"for name in ['drives']] + [ExecuteProcess(cmd={command})]"
    head = "import os\nfrom launch.actions import ExecuteProcess\nfrom launch import"
    here = "HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))\ndef generate"
    changes = ("for name in ['drives']]", also), ("from launch import", head)
    changes += (("def generate", here),)
    add(folder, "prepare.py", "share/company", *changes)
    add(folder, "package.xml", "share/company")
    recording = recorded(folder)
    assert said(recording, "python3-2") == ["<package><name>company</name></package> --map"]
    last = recording.run.programs[1]
    assert (last.package, last.executable, last.exit_code) == ("", "prepare.py", 0)


def test_programs_that_cmake_installs_run_with_the_files_that_it_installs():
    recording = recorded(LAUNCHED / "in_cmake")
    assert said(recording, "teller-1") == ["Hello World Hello World"]
    first, *more = said(recording, "node.py-2")
    assert first.startswith("--folder ")
    assert first.endswith("/share/tells burger one True")
    assert more == ["5000 ['--ros-args', '-p', 'of:=\"hears\"']"]
    programs = [(each.package, each.executable) for each in recording.run.programs]
    assert programs == [("tells", "teller"), ("hears", "node.py")]


def test_a_program_that_cmake_installs_may_have_any_name_and_import_a_module_from_anywhere(
    tmp_path,
):
    texts = {
        "CMakeLists.txt": """project(walks)
ament_python_install_package(walks PACKAGE_DIR python/walks)
install(PROGRAMS scripts/go DESTINATION lib/${PROJECT_NAME})
""",
        "package.xml": "<package><name>walks</name></package>",
        "python/walks/__init__.py": "SAID = 'walked'\n",
        "scripts/go": "#!/usr/bin/env python3\nimport walks\n\nprint(walks.SAID)\n",
    }
    assert "walked" in recorded(lay(tmp_path, texts)).output


@pytest.mark.more("a run in each time")
def test_where_one_cannot_be_followed_all_run_in_real_time_and_it_is_named(tmp_path):
    folder = package(tmp_path, "drives", "starts")
    with open_submission(folder) as submission:
        run = virtual_time.run(submission, PLAN).run
    assert run.time == "real"
    flag = "graded in real time, because the submission starts another program (true) (starts-2)"
    assert str(run.flags[0]) == flag
    assert [each.name for each in run.programs] == ["drives-1", "starts-2"]


@pytest.mark.more("tests/attacks run one of several at each level")
@pytest.mark.parametrize("level", at_levels("landlock", "limits"))
def test_they_run_at_a_lower_level_of_isolation_too(level):
    levels.only(level)
    try:
        run = recorded(LAUNCHED / "spiral").run  # its launch file is evaluated at that level, too
    finally:
        levels.only("")
    assert [(each.outcome, each.exit_code) for each in run.programs] == [("time_limit", None)] * 2


def test_a_program_alone_is_in_the_result_too():
    (program,) = runs.recorded("quick_spiral", Plan(LIMITS)).run.programs
    told = (program.name, program.package, program.executable)
    assert told == ("quick_spiral.py", "", "quick_spiral.py")


def test_a_ninth_program_is_refused(tmp_path):
    folder = package(tmp_path, **{f"idle{n}": TEXTS["idle"] for n in range(9)})
    with pytest.raises(SubmissionError, match=r"all.launch.py starts 9 programs; a run may have 8"):
        recorded(folder)
