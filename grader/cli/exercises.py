"""List the exercises that are here; add others by their git address, update and remove them."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from grader import content, extensions, system
from grader.added import pins
from grader.added.pins import FILES, Origin, Pin
from grader.cli import ELSEWHERE, agreed, options, say
from grader.cli.batch import processes
from grader.errors import ExerciseError, UsageError
from grader.exercise.building import NAME
from grader.exercise.loading import load_exercise
from grader.exercise.places import DESCRIPTION, installed_names, names
from grader.message import Message, listed, msg
from grader.translations import tr, translate
from grader.yaml_file import read_yaml

if TYPE_CHECKING:
    from grader.added.fetching import Fetched

DONE, NOT_DONE = 0, 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.epilog = tr(
        "Exit code: 0 done, 1 not added or updated (you said no, or check-exercise found something "
        "to fix), 2 it cannot be used, 3 its checks end their process, answer too much or do not "
        "end."
    )
    does = parser.add_subparsers(dest="what", required=True, metavar="list|add|update|remove")
    each = {
        name: does.add_parser(name, help=translate(said), description=translate(said))
        for name, (_, said) in DOES.items()
    }
    address = tr("its git repository, a tag, branch or commit in it, and the folder in that")
    each["add"].add_argument("address", metavar="ADDRESS[@TAG][#FOLDER]", help=address)
    one_alone = tr("one alone (all), and another tag of it, a branch or a commit")
    each["update"].add_argument("name", nargs="?", metavar="NAME[@TAG]", help=one_alone)
    each["remove"].add_argument("name", metavar="NAME", help=tr("as `list` shows it"))
    for name in ("add", "update"):
        each[name].add_argument("--yes", action="store_true", help=tr("do not ask"))
        at_once = tr("so many solutions at once (one a core)")
        each[name].add_argument("--jobs", type=processes, metavar="N", help=at_once)
    for one in each.values():  # behind the last word, too
        options.add_arguments(one, argparse.SUPPRESS)


def main(args: argparse.Namespace) -> int:
    """Do what is asked; see `grader.cli` for the exit codes."""
    if args.what in ("add", "update") and not system.runs_submissions():
        raise UsageError(ELSEWHERE)
    return DOES[args.what][0](args, Console(highlight=False))


def _list(args: argparse.Namespace, console: Console) -> int:
    say(console, msg("Installed with a package:"))
    for name, found in extensions.points(extensions.EXERCISES).items():
        say(console, f"  {name} ({', '.join(map(extensions.described, found))})")
    added = pins.names()
    say(console, msg("Added by address:") if added else msg("Added by address: none."))
    for name in added:
        folder = pins.home() / name / FILES
        try:
            pin = _pin_of(folder)
            _show(console, pin, _state(pin, folder))
        except (ExerciseError, OSError) as error:
            why = error.message if isinstance(error, ExerciseError) else str(error)
            say(console, f"  {name}")
            say(console, msg("    cannot be used: {why}", why=why))
    return DONE


def _state(pin: Pin, folder: Path) -> Message:
    if found := pin.differs(folder):
        return msg("changed since: its files have the hash {found}; it is refused", found=found)
    return msg("unchanged")


def _show(console: Console, pin: Pin, state: Message) -> None:
    say(console, f"  {pin.name}: {pin.origin}")
    say(console, msg("    commit {commit}", commit=pin.origin.commit))
    say(console, msg("    SHA-256 {sha256}: {state}", sha256=pin.origin.sha256, state=state))


def _add(args: argparse.Namespace, console: Console) -> int:
    from grader.added.address import Address
    from grader.added.fetching import fetch

    fetched = fetch(Address.parse(args.address))
    with pins.unfinished() as place:
        pin = _laid_out(fetched, place)
        if pin.name in names():
            folder = pins.folder_of(pin.name)
            raise UsageError(
                "there is an exercise {name!r} already, {where}. Nothing was added",
                name=pin.name,
                where=msg("installed with a package")
                if folder is None
                else _taken(_pin_of(folder), pin.origin),
            )
        _show_what(console, pin)
        _show_origin(console, pin.origin)
        for name, data in fetched.files.items():
            say(console, msg("    {file} ({size:,} bytes)", file=name, size=len(data)))
        if not (_is_wanted(args, console) and _is_fine(args, console, place)):
            say(console, msg("Nothing was added."))
            return NOT_DONE
        pins.put(place, pin.name)
    say(console, msg("Added: grader run SUBMISSION --exercise {name}", name=pin.name))
    return DONE


def _taken(there: Pin, asked: Origin) -> Message:
    """Say where an added exercise is from, and which command brings what is asked for."""
    name, tag = there.name, "" if asked.tag == there.origin.tag else f"@{asked.tag or 'HEAD'}"
    is_same = (asked.address, asked.folder) == (there.origin.address, there.origin.folder)
    way = f"grader exercises update {name}{tag}" if is_same else f"grader exercises remove {name}"
    words = {"origin": str(there.origin), "command": way}
    if is_same:
        return msg("added from {origin}; `{command}` fetches what you ask for", **words)
    return msg("added from {origin}; `{command}` makes room", **words)


def _update(args: argparse.Namespace, console: Console) -> int:
    if args.name is None:
        codes = [_update_one(name, args, console) for name in pins.names()]
        if not codes:
            say(console, msg("Added by address: none."))
        return max(codes, default=DONE)
    return _update_one(args.name, args, console)


def _update_one(asked: str, args: argparse.Namespace, console: Console) -> int:
    from grader.added.address import Address, check_tag
    from grader.added.fetching import changed, fetch

    name, at, tag = asked.partition("@")
    if at:
        check_tag(tag, asked)
    folder = _folder_of(name)
    pin = _pin_of(folder)
    there = pin.origin
    tag = tag or there.tag
    fetched = fetch(Address(there.address, tag, there.folder))
    is_changed_here = bool(pin.differs(folder))
    is_same = (fetched.origin.sha256, tag) == (there.sha256, there.tag)
    if is_same and not is_changed_here:
        say(console, msg("{name} is up to date: {origin}", name=name, origin=str(there)))
        return DONE
    with pins.unfinished() as place:
        new = _laid_out(fetched, place)
        if new.name != name:
            raise UsageError(
                "{origin} holds another exercise now, {found!r}: add that one, and remove {name!r}",
                origin=str(new.origin),
                found=new.name,
                name=name,
            )
        _show_what(console, new)
        say(console, msg("    until now: commit {commit}", commit=there.commit))
        _show_origin(console, new.origin)
        if is_changed_here:
            say(console, msg("    its files were changed here; these changes go"))
        for line in changed(content.hashes_of(folder), content.hashes_of(place / FILES)):
            say(console, f"    {line}")
        if not (_is_wanted(args, console) and _is_fine(args, console, place)):
            say(console, msg("Nothing was changed."))
            return NOT_DONE
        pins.put(place, name)
    say(console, msg("Updated: {name}", name=name))
    return DONE


def _remove(args: argparse.Namespace, console: Console) -> int:
    _folder_of(args.name)  # whose pin may be damaged
    pins.drop(args.name)
    say(console, msg("Removed: {name}", name=args.name))
    return DONE


def _folder_of(name: str) -> Path:
    """Return the folder of an added exercise.

    Raises:
        UsageError: there is none of this name.
    """
    folder = pins.folder_of(name)
    if folder is None:
        added = pins.names()
        raise UsageError(
            "{name!r} is no added exercise; {there}",
            name=name,
            there=msg("it is installed with a package: pip uninstalls that")
            if name in installed_names()
            else msg("there are {names}", names=listed(added))
            if added
            else msg("there is none"),
        )
    return folder


def _pin_of(folder: Path) -> Pin:
    """Return the pin of the added exercise in a folder.

    Raises:
        ExerciseError: it is damaged.
    """
    pin = pins.around(folder)
    assert pin is not None
    return pin


def _laid_out(fetched: Fetched, place: Path) -> Pin:
    """Write what was fetched, with its pin; return that.

    Raises:
        UsageError: it cannot be written, or its exercise has no name.
    """
    fetched.write(place / FILES)
    data = read_yaml(place / FILES / DESCRIPTION).data
    name = data.get("exercise") if isinstance(data, dict) else None
    if not isinstance(name, str) or not NAME.fullmatch(name) or not pins.is_name(name):
        raise UsageError(
            "{file}: expected a name such as my_exercise for the key `exercise`, found {name}",
            file=DESCRIPTION,
            name=repr(name)[:100],
        )
    pin = Pin(name, fetched.origin)
    pins.write(place, pin)
    return pin


def _show_what(console: Console, pin: Pin) -> None:
    origin = str(pin.origin)
    say(console, msg("The exercise {name}, from {origin}", name=pin.name, origin=origin))


def _show_origin(console: Console, origin: Origin) -> None:
    say(console, msg("    commit {commit}", commit=origin.commit))
    say(console, msg("    SHA-256 of its files {sha256}", sha256=origin.sha256))


def _is_wanted(args: argparse.Namespace, console: Console) -> bool:
    """Ask whether to go on, unless that was said.

    Raises:
        UsageError: nobody can be asked.
    """
    if args.yes:
        return True
    if not sys.stdin.isatty():
        raise UsageError(
            msg("nobody can be asked here: look at what is listed, and call again with --yes")
        )
    say(
        console,
        msg(
            "Its checks are a stranger's program. They run confined: they see a recording, and "
            "reach neither your files nor the network. check-exercise tries them now."
        ),
    )
    return agreed(tr("Go on? [y/N] "))


def _is_fine(args: argparse.Namespace, console: Console, place: Path) -> bool:
    """Try the exercise as `grader check-exercise` does, and show what that finds."""
    from grader.cli import check_exercise

    say(console, msg("Trying it: each of its solutions is run and judged. That may take minutes."))
    examination = check_exercise.tried(load_exercise(place / FILES), jobs=args.jobs)
    check_exercise.show(examination, console)
    return examination.is_fine


DOES: Mapping[str, tuple[Callable[[argparse.Namespace, Console], int], Message]] = {
    "list": (_list, msg("show those that are installed, and those that were added")),
    "add": (_add, msg("fetch one from a git repository, show it, ask, try it, and keep it")),
    "update": (_update, msg("fetch what was added again, show what changes, ask, and try it")),
    "remove": (_remove, msg("remove one that was added")),
}
