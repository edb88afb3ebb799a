"""What xacro says of a file that it cannot take, in as many words as it needs, and what to do."""

from __future__ import annotations

import re
from typing import Final

from grader.language.phrase import say

#: What xacro puts behind every fault of XML; of most it is not true.
_CHECK_THAT: Final = " Check that:"
#: Where what lies in the package's share folder lies in the package, if nobody renames it.
_SHARE: Final = "/prefix/share/{}/"
_BY_HAND: Final = say("Run xacro by hand on the file: it says the same.")
_ABOVE: Final = say(
    "a tag that is not closed, or closed by another name, stands at that line or above."
)
#: What xacro says -> what to do. The first that fits counts.
_ADVICE: Final = (
    (
        "unbound prefix",
        say(
            "The first tag has to say what xacro: is: "
            '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name=...>.'
        ),
    ),
    ("mismatched tag", say("The line is where it was noticed: {above}", above=_ABOVE)),
    ("no element found", say("The file ends too soon: {above}", above=_ABOVE)),
    (
        "XML or text declaration not at start",
        say("<?xml ...?> stands at the very start of a file: take away what is above it."),
    ),
    (
        "not well-formed",
        say(
            "Look at that place: a quotation mark that is missing, a < or & that is"
            " meant as it stands, or -- within a comment."
        ),
    ),
    (
        "unknown macro name",
        say(
            "A macro is defined by <xacro:macro name=...>, or in a file that is "
            "included, above where it is used. Compare the names."
        ),
    ),
    (
        "Undefined parameters",
        say(
            "The macro's params asks for them: each use of it has to give them, "
            "unless params has a default (NAME:=VALUE)."
        ),
    ),
    (
        "Invalid parameter",
        say(
            "The macro has no such parameter: add it to its params, or leave it out"
            " where it is used."
        ),
    ),
    (
        "No such file or directory",
        say(
            "A name in <xacro:include filename=...> is looked for beside the file "
            "that includes it, where it is installed: is it there, and in "
            "data_files?"
        ),
    ),
    (
        "a file of another package",
        say(
            "$(find NAME) takes the name of a package: of your own, as package.xml "
            "has it, for your own files. Another one has to be installed where this"
            " is graded."
        ),
    ),
    (
        "codec can't decode",
        say("Save the file as UTF-8: editors have that under 'Save with encoding' or 'Save as'."),
    ),
    (
        "sequence by non-int",
        say("A number is a text here: decimals take a point, 0.11, not a comma, and no unit."),
    ),
    (
        "Undefined substitution argument",
        say("<xacro:arg name=... default=...> has to come before $(arg ...) is used."),
    ),
)
_UNDEFINED: Final = re.compile(r"name '(\w+)' is not defined")


def told(said: str, package: str) -> str:
    """The same without what is of no use, and with the package's own paths in it."""
    text = " ".join(said.split()).partition(_CHECK_THAT)[0]
    text = text.replace("xacro: error: ", "xacro: ").replace(_SHARE.format(package), "")
    return re.sub(r" when processing file: \S+$", "", text)


def advice(said: str) -> str:
    """What to do about what xacro says."""
    undefined = _UNDEFINED.search(said)
    if undefined is not None:
        return say(
            'Nothing above defines it: <xacro:property name="{name}" '
            "value=.../>, with xacro: before it, or a parameter of the macro. "
            "Compare letter by letter.",
            name=undefined[1],
        )
    return next((help for words, help in _ADVICE if words in said), _BY_HAND)
