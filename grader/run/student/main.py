"""The submission's process: run what was handed in, and nothing of ours.

    python main.py AWAITED EVIDENCE ROOT module:function
    python main.py AWAITED EVIDENCE ROOT path/to/script.py [function]

AWAITED is a JSON list of two lists: topics and services that have to be connected when the
submission gets them; see `Introduced`. EVIDENCE is a pipe to the grader (`telling`), -1 for none.

Started by path, not with -m, and of the grader it imports only what looks on (`looking`), so that
the submission finds the interpreter as it would at a student's desk. ROOT comes first on the import
path; our packages of the same names as the submission's are out of reach, whatever is installed.
"""

import functools
import importlib
import importlib.machinery
import importlib.util
import json
import re
import runpy
import sys
import time
import traceback
import types
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

#: Installed packages that a submission must never pick up in place of its own.
OURS = ("turtlesim_challenge", "turtlesim_py", "grader")
#: How a line begins that declares the encoding of a file (PEP 263).
ENCODING = re.compile(rb"[ \t\f]*#.*?coding[:=][ \t]*[-\w.]+")


class OnlyFromSubmission:
    """An import hook: modules of these names come from the submission or not at all."""

    def __init__(self, root: str) -> None:
        self._root = root

    def find_spec(self, name, path=None, target=None):  # type: ignore[no-untyped-def]
        """Find a top-level module of ours below the submission's root only."""
        if name not in OURS:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, [self._root])
        if spec is None:
            raise ModuleNotFoundError(f"No module named {name!r} in the submission", name=name)
        return spec


class AfterImport:
    """An import hook: when one of these modules has been loaded, each of its calls is made."""

    def __init__(self, calls: Mapping[str, Sequence[Callable[[types.ModuleType], None]]]) -> None:
        self._calls = calls

    def find_spec(self, name, path=None, target=None):  # type: ignore[no-untyped-def]
        """Load as usual, then call."""
        if name not in self._calls:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path)
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def exec_module(module: types.ModuleType) -> None:
                load(module)
                for call in self._calls[name]:
                    call(module)

            spec.loader.exec_module = exec_module  # type: ignore[method-assign]
        return spec


class Introduced:
    """What drives the scene is connected when the submission gets it, in real time.

    ROS drops what is published before the other side is found, which takes some tenths of a
    second, and seconds on a busy machine: the same submission would do something else each time.
    So publishers and clients of these names wait until they are connected. What only ends like one
    of them may be a wrong name, or one of what is yet to come: these wait for `patience_s` at most,
    all together.
    """

    def __init__(self, topics: list[str], services: list[str]) -> None:
        self.patience_s = 4.0
        #: of the very names: they are there, and will be found, unless their types are wrong
        self.sure_patience_s = 10.0
        self._topics, self._services = _with_endings(topics), _with_endings(services)

    def patch(self, module: Any) -> None:
        """Put the waiting into `rclpy.node`."""
        node = module.Node
        create_publisher, create_client = node.create_publisher, node.create_client

        @functools.wraps(create_publisher)
        def connected_publisher(self_: Any, *args: Any, **kwargs: Any) -> Any:
            publisher = create_publisher(self_, *args, **kwargs)
            is_met = lambda: publisher.get_subscription_count() > 0  # noqa: E731
            self._await(publisher.topic_name, self._topics, is_met)
            return publisher

        @functools.wraps(create_client)
        def connected_client(self_: Any, *args: Any, **kwargs: Any) -> Any:
            client = create_client(self_, *args, **kwargs)
            name = self_.resolve_service_name(client.srv_name)
            self._await(name, self._services, client.service_is_ready)
            return client

        node.create_publisher, node.create_client = connected_publisher, connected_client

    def _await(
        self, name: str, known: tuple[set[str], set[str]], is_connected: Callable[[], bool]
    ) -> None:
        names, endings = known
        if name in names:
            self.sure_patience_s -= _wait(is_connected, self.sure_patience_s)
        elif _ending(name) in endings:
            self.patience_s -= _wait(is_connected, self.patience_s)


def _with_endings(names: list[str]) -> tuple[set[str], set[str]]:
    return set(names), set(map(_ending, names))


def _ending(name: str) -> str:
    return name.rpartition("/")[2]


def _wait(is_connected: Callable[[], bool], patience_s: float) -> float:
    """Wait for a connection; how long that took [s]."""
    began = time.monotonic()
    is_new = not is_connected()
    while is_new and time.monotonic() < began + patience_s:
        is_new = not is_connected()
        # ROS tells of a service a moment before a request would reach it, so not too short
        time.sleep(0.02)
    return time.monotonic() - began


def run(root: str, target: str, function: str | None) -> object:
    """Start what was handed in; returns what its function returned."""
    if target.endswith(".py"):
        must_be_text(target)
        if function is None:
            runpy.run_path(target, run_name="__main__")
            return None
        name = Path(target).stem
        spec = importlib.util.spec_from_file_location(name, target)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
    else:
        name, _, function = target.partition(":")
        module = importlib.import_module(name)
        check_origin(module, root)
    start: Any = functools.reduce(getattr, str(function).split("."), module)
    return start()


def must_be_text(file: str) -> None:
    """Refuse what `python3 FILE` refuses, and `runpy` passes over or does not place.

    Raises:
        SyntaxError: bytes that are no UTF-8 and no declared encoding either, or null bytes.
    """
    data = Path(file).read_bytes()
    try:
        at, why = data.index(0), "source code cannot contain null bytes"
    except ValueError:
        try:
            data.decode()
            return
        except UnicodeDecodeError as error:
            if any(ENCODING.match(line) for line in data.splitlines()[:2]):
                return  # the compiler goes by it
            at = error.start
            why = f"Non-UTF-8 code starting with '\\x{data[at]:02x}', but no encoding declared"
    line = data.count(b"\n", 0, at) + 1
    raise SyntaxError(f"{why}; save the file as UTF-8", (file, line, None, None))


def check_origin(module: types.ModuleType, root: str) -> None:
    """The module must be the submission's, not one of the same name that was there before.

    Raises:
        ImportError: it is not; the text says what to do.
    """
    file = getattr(module, "__file__", None)
    if file is None or not Path(file).resolve().is_relative_to(Path(root).resolve()):
        raise ImportError(
            f"{module.__name__!r} is also the name of a module of Python's or ROS's own "
            f"({file or 'built in'}); call yours something else"
        )


def call(
    root: str,
    target: str,
    function: str | None,
    on_error: Callable[[BaseException], None] = lambda error: None,
) -> int:
    """Run what was handed in to its end; its exit code. Tracebacks go without our own lines.

    `on_error`: told of an exception that nobody has caught, before its traceback is printed; also
        of one that Python prints nothing of.
    """
    try:
        code = run(root, target, function)
    except KeyboardInterrupt as interrupt:
        on_error(interrupt)
        return 130
    except SystemExit as leaving:
        on_error(leaving)
        code = leaving.code
        if isinstance(code, str):
            print(code, file=sys.stderr)
            return 1
    except BaseException as error:
        on_error(error)
        traceback.print_exception(_without_our_frames(error))
        return 1
    return code if isinstance(code, int) else 0


def forget_ourselves(root: str, target: str, arguments: Sequence[str] = ()) -> None:
    """Have the interpreter look as it would at a student's desk."""
    name = Path(target).name if target.endswith(".py") else target.partition(":")[0]
    sys.argv = [name, *arguments]
    sys.path[0] = root
    sys.meta_path.insert(0, OnlyFromSubmission(root))
    for name in [name for name in sys.modules if name.partition(".")[0] in OURS]:
        del sys.modules[name]


def main(arguments: Sequence[str] = ()) -> None:
    """Prepare the interpreter, run, and leave with the exit code.

    Args:
        arguments: of the submission's program.
    """
    _, awaited, page, root, target, *more = sys.argv
    sys.path[0] = str(Path(__file__).resolve().parents[3])
    from grader.run.student.looking import Looking

    looking = Looking(int(page), root)
    forget_ourselves(root, target, arguments)
    introduced = Introduced(*json.loads(awaited))
    calls = {name: [look] for name, look in looking.calls.items()}
    calls["rclpy.node"].insert(0, introduced.patch)
    sys.meta_path.insert(0, AfterImport(calls))
    code = call(root, target, more[0] if more else None, looking.raised)
    looking.returns(code)
    sys.exit(code)


def _without_our_frames(error: BaseException) -> BaseException:
    trace = error.__traceback__
    hidden = (__file__, runpy.__file__, importlib.__file__, "<frozen runpy>")
    while trace is not None and (
        trace.tb_frame.f_code.co_filename in hidden
        or trace.tb_frame.f_code.co_filename.startswith("<frozen importlib")
    ):
        trace = trace.tb_next
    return error.with_traceback(trace)


if __name__ == "__main__":
    main()
