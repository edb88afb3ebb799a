"""Write the hand-ins of others anew, without the names of one who is forgotten.

A run that several share is written once, and linked into the folder of each; every folder moves
into its place whole.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from grader import files, judging, strict_json
from grader.batch.entry import ENTRY, Entry, HandIn
from grader.batch.forget.whom import Kept, Whom
from grader.batch.names.recorded import result_without_names, without_hash, without_names
from grader.batch.names.replacing import Names
from grader.batch.page.thumb import THUMB
from grader.batch.similar import features
from grader.batch.similar.sources import SOURCE, kept
from grader.batch.store import ASIDE, ERROR, RECORDING, RUN, STUDENTS, Store
from grader.errors import RecordingError
from grader.recording.recording import Recordings
from grader.reports import Report, render
from grader.reports.beside import Beside
from grader.result import json_file
from grader.result.error import ErrorResult
from grader.result.result import PAGE, RESULT, Result, put_artifacts


def mentions(sharing: Sequence[Kept], store: Store, whom: Whom, words: set[str]) -> bool:
    """Whether hand-ins of one run, or that run, have the names of who is forgotten.

    Args:
        words: gets those with a name in them.
    """
    noted = set[str]()
    names = whom.names_for(sharing[0].entry.key).noting(noted)
    for each in sharing:
        names(_text(each.entry))
    base = _base(sharing[0].entry, store)
    is_lost = False
    if (base / ERROR).is_file():
        names((base / ERROR).read_text("utf-8", "replace"))
    else:
        for file in kept(base / SOURCE):
            names(f"{file.name}\n{_decoded(file.data)}")
        if (base / RECORDING).is_dir():
            try:
                without_names(judging.load_recordings(base / RECORDING), names)
            except (RecordingError, ValueError, LookupError, TypeError):
                is_lost = True  # it is left out
    words |= noted
    return is_lost or bool(noted)


def rewrite(sharing: Sequence[Kept], store: Store, whom: Whom) -> bool:
    """Write hand-ins that share a run anew; return whether their recording could be kept."""
    key = sharing[0].entry.key
    names, base, place = whom.names_for(key), _base(sharing[0].entry, store), store.new_place()
    recordings: Recordings | None = None
    is_judged = any(each.entry.result is not None for each in sharing)
    if key:
        recordings = _write_run(base, place / RUN, names)
    for each in sharing:
        folder = place / (STUDENTS if each.part != ASIDE else ASIDE) / each.entry.id
        write_entry(each.entry, whom.without(each.entry.hand_in), folder, recordings, names)
    store.put(key, place)
    return recordings is not None or not is_judged


def write_entry(
    entry: Entry,
    hand_in: HandIn,
    folder: Path,
    recordings: Recordings | None,
    names: Names,
) -> None:
    """Write the files of a hand-in into a new folder, except those of its run.

    Args:
        hand_in: what it is from now on.
        recordings: of its run, without the names; None where there are none.
    """
    files.make_folder(folder)
    message = entry.message.map_texts(names)
    if entry.result is not None:
        result = of_hand_in(result_without_names(entry.result, names, recordings), hand_in)
        result = replace(result, artifacts=result.artifacts if recordings else {})
        result.put(folder / RESULT)
        if recordings is None:
            report = Report(result, Beside(result, folder), "whole")
        else:
            put_artifacts(recordings.nominal, folder)
            report = Report.of(result, folder, recordings, "whole")
        files.put(folder / PAGE, render("html", [report]).encode("utf-8"))
    replace(entry, hand_in=hand_in, message=message, folder=folder).put()


def of_hand_in(result: Result, hand_in: HandIn) -> Result:
    """Return a result as that of a hand-in, of another id or other people than before."""
    whose = result.handed_in and replace(result.handed_in, id=hand_in.id, name=hand_in.name)
    return replace(result, submission=hand_in.name, handed_in=whose)


def loaded(entry: Entry, store: Store) -> Recordings | None:
    """Return the recordings of a hand-in; None where there are none, or they cannot be read."""
    try:
        return judging.load_recordings(_base(entry, store) / RECORDING)
    except RecordingError:
        return None


def rewrite_older(each: Kept, hand_in: HandIn, names: Names) -> bool:
    """Write what a regrade has kept of a hand-in anew; return whether it was another."""
    entry = each.entry
    if hand_in == entry.hand_in and not names.are_in(_text(entry)):
        return False
    folder = entry.folder.with_name(hand_in.id)
    if entry.result is not None:
        result = of_hand_in(result_without_names(entry.result, names, None), hand_in)
        files.put(folder / RESULT, json_file.text(result.to_json()).encode())
    message = entry.message.map_texts(names)
    replace(entry, hand_in=hand_in, message=message, folder=folder).put()
    return True


def _base(entry: Entry, store: Store) -> Path:
    """Return the folder with the run of a hand-in."""
    return store.run(entry.key) if store.has(entry.key) else entry.folder


def _text(entry: Entry) -> str:
    """Return the texts that are kept of a hand-in beside its run."""
    texts = [(entry.folder / ENTRY).read_text("utf-8", "replace")]
    if entry.result is not None:
        texts.append(json_file.text(entry.result.to_json()))
    return "\n".join(texts)


def _write_run(base: Path, run: Path, names: Names) -> Recordings | None:
    """Write a run without names; return its recordings, None where there are none left."""
    files.make_folder(run)
    if (base / ERROR).is_file():
        found = ErrorResult.from_json(json_file.read(base / ERROR, is_ours=True))
        made = replace(found, message=found.message.map_texts(names))
        files.put(run / ERROR, json_file.text(made.to_json()).encode())
        return None
    _write_sources(base / SOURCE, run / SOURCE, names)
    if (base / THUMB).is_file():
        shutil.copyfile(base / THUMB, run / THUMB)
    try:
        recordings = without_names(judging.load_recordings(base / RECORDING), names)
        recordings = without_hash(recordings)
    except (RecordingError, ValueError, LookupError, TypeError):
        return None
    judging.save_recordings(recordings, run / RECORDING)
    if (before := features.Features.read(base)) is not None:
        now = replace(before, files=features.hashed(run / SOURCE))
        files.put(run / features.NAME, strict_json.line(now))
    return recordings


def _write_sources(source: Path, into: Path, names: Names) -> None:
    taken: set[str] = set()
    into.mkdir(parents=True, exist_ok=True)
    for file in kept(source):
        name = names(file.name)
        while name.lower() in taken:
            name = f"{name.removesuffix('.py')}_.py"
        taken.add(name.lower())
        path = into / name
        path.parent.mkdir(parents=True, exist_ok=True)
        text = names(_decoded(file.data))
        path.write_bytes(text.encode("utf-8", "surrogateescape"))


def _decoded(data: bytes) -> str:
    return data.decode("utf-8", "surrogateescape")


def by_run(found: Iterable[Kept]) -> list[list[Kept]]:
    """Group hand-ins of the class and of `aside` by their runs."""
    groups: dict[str, list[Kept]] = {}
    for each in found:
        entry = each.entry
        groups.setdefault(entry.key or f"{each.part} {entry.id}", []).append(each)
    return list(groups.values())
