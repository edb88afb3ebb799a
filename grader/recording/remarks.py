"""Remarks on a run as phrases again.

They are made in processes of their own, the simulator's and the submission's, and lie in a
recording as plain English: a text is known again by the sentence that it was made of.
"""

from __future__ import annotations

import re
import string
from functools import cache

from grader.language.phrase import Phrase, marked
from grader.scenes import NAMES, load_words

#: Longer ones are not looked at [characters].
_LONGEST = 2000
#: Sentences in sentences: none is deeper.
_DEEPEST = 4
#: The sentences, but for those of scenes; of two that fit the first is taken.
KEYS = (
    # how the program ended, or was ended
    marked("every thread of the node waits for something that will not come"),
    marked("the node waits for something that can no longer happen"),
    marked("the node's process was stopped (SIGSTOP), and nobody let it go on"),
    marked("the node sent so much that the simulator used more than {seconds} s of processor time"),
    marked("the node used {seconds} s of processor time without waiting for ROS"),
    marked("the node used more than {seconds} s of processor time"),
    marked("the whole grading used more than {seconds} s of processor time"),
    marked("the node wrote a file of more than {size}: a run may not"),
    marked(
        "the node and what it started came to the limit of {number} processes and threads: a run "
        "may have no more at once"
    ),
    marked(
        "the node and what it started had {number} open files and sockets at once, and were "
        "ended: a run may have {most}"
    ),
    marked(
        "the node and what it started used more than {size} of memory, and were ended: a run may "
        "use no more"
    ),
    marked(
        "the node and what it started printed more than {size}, and were ended: a run may print no "
        "more"
    ),
    marked("the run was ended: the simulator was kept from ticking at its pace"),
    marked("the node ended with {said}: {limit}"),
    marked("{limit}, if that was one more"),
    marked("one process may ask for {size} of memory"),
    marked("a run may have {number} processes and threads"),
    marked("a run may write into its own folder, tempfile.gettempdir() and ~, and nowhere else"),
    marked("a process may have {number} open files"),
    marked("a file may have {size}"),
    marked("the folder for temporary files is full: there is little room in it"),
    # what it said to the simulator
    marked("its process sent what ours never sends"),
    marked("its process does not read what it has asked for"),
    marked("its process sent what only a simulator says"),
    marked("its process made more than {number} requests that let no time pass"),
    marked("the node sent more than {number} messages, or more than {most} GB in them"),
    marked("the node published on more than {number} topics"),
    marked("messages on {channel} were too long or too many to be taken"),
    marked("a message on {channel} could not be read"),
    marked("the simulator could not serve {what}: {error}"),
    # which run was made, and why
    marked("graded in real time, because {why}"),
    marked("several programs were started, each in a process of its own: {names}"),
    marked("the submission {does}"),
    marked("starts another program"),
    marked("starts another program ({program})"),
    marked("becomes another program"),
    marked("becomes another program ({program})"),
    marked("forks (subprocess or multiprocessing)"),
    marked("forks"),
    marked("starts another process (multiprocessing)"),
    marked("asks for a signal after a real time (alarm, setitimer)"),
    marked("runs Python in a thread that a C extension has started"),
    marked("subscribes with a content filter"),
    marked("broke our virtual time ({error})"),
    marked("virtual time does not work here: {lack}"),
    marked("virtual time itself failed ({where})"),
    marked("virtual time does not fit rclpy {version}: {fault}"),
    marked("repeated, because the first try failed in the grader"),
    marked(
        "the simulator ended while the node was running, in both tries, and nothing was recorded: "
        "{words}. What only drives cannot do that; if this node does nothing else, the grader is "
        "wrong"
    ),
)
#: Values that are sentences themselves.
_SENTENCES = {"limit", "why", "does"}
#: What fits a value; anything, if nothing stands here.
_VALUES = {
    **dict.fromkeys(("number", "seconds", "most", "megabytes"), r"[\d.,]{1,20}"),
    "size": r"\d{1,20} [GM]iB",
    "limit": r"(?:one process|a run|a process|a file|the folder) .+",
}


def phrase(text: str, depth: int = 0) -> str:
    """A remark as a phrase; itself where it is one, or no sentence of ours."""
    if isinstance(text, Phrase) or len(text) > _LONGEST or depth > _DEEPEST:
        return text
    for key, pattern in _patterns():
        if found := pattern.fullmatch(text):
            values = {
                name: phrase(value, depth + 1) if name in _SENTENCES else Phrase(value)
                for name, value in found.groupdict().items()
            }
            return Phrase(text, key, values)
    return text


@cache
def _patterns() -> tuple[tuple[str, re.Pattern[str]], ...]:
    keys = (*KEYS, *(key for scene in NAMES for key in load_words(scene).REMARKS))
    return tuple((key, re.compile(_pattern(key), re.DOTALL)) for key in keys)


def _pattern(key: str) -> str:
    made = ""
    for before, name, _, _ in string.Formatter().parse(key):
        made += re.escape(before)
        if name is not None:
            made += f"(?P<{name}>{_VALUES.get(name, '.+?')})"
    return made
