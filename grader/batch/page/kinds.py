"""The kind of a sentence: what is left when numbers, names and places are taken out of it.

Two students fail alike where the same check says the same of both, but for what is their own.
"""

from __future__ import annotations

import re

from grader import text

#: What of a sentence is looked at [characters].
_LIMIT = 600
GAP = "…"

_STEPS: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (re.compile(pattern, re.IGNORECASE), by)
    for pattern, by in (
        # what is quoted: names of fields, variables, files
        (
            r"“[^”]*”|«[^»]*»|‘[^’]*’|\"[^\"]*\"|`[^`]*`|(?<!\w)'(?:[^']|(?<=\w)'(?=\w))*'(?!\w)",
            GAP,
        ),
        (r"[\w./+~-]+\.(?:pyc?|launch|xml|yaml|zip|so)\b", GAP),  # files
        (r"(?<![\w/])/?[a-z_]\w*(?:/\w+)+|(?<![\w/])/[a-z_]\w*", GAP),  # topics, types, folders
        (r"\b0x[0-9a-f]+\b", GAP),
        (r"(?<![\w.])[-+−]?\d+(?:[.,]\d+)*(?!\w)", "N"),
        (r"\bN ?/ ?N\b", "N"),
        (r"\b\w+ \((?:N(?:, )?)+\)", f"({GAP})"),  # a name for a colour, a place
        (r"\([^()]*\)", f"({GAP})"),
        (r"\b(?-i:[IVX]+)\b", "N"),
        (r"\b(?:left|right|top|bottom|upper|lower)\b", GAP),
    )
)
#: 'N and N', 'N (…), N (…)', 'N %, N %': how many there are makes no other kind.
_LIST = re.compile(r"(?<!\w)([^,.;:]{1,30}?)(?:(?:, | and |, and | et |、|和)\1)+(?!\w)")
_SENTENCES = re.compile(r"(?<=[.:;]) ")


def kind_of(sentence: str) -> str:
    """The sentence without what differs from student to student."""
    kind = text.one_line(text.plain(text.clip(sentence, _LIMIT)))
    for pattern, by in _STEPS:
        kind = pattern.sub(by, kind)
    kind = _LIST.sub(r"\1", kind)
    return " ".join(dict.fromkeys(_SENTENCES.split(kind)))
