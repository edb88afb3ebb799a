"""Ids that every file system takes as names of folders, and holds apart."""

from __future__ import annotations

import hashlib
import re
import unicodedata
from collections import Counter
from collections.abc import Sequence
from typing import Final

MAX_ID: Final = 80  # characters; what lies in the folder has room for its own names
_OTHERS: Final = re.compile(r"[^A-Za-z0-9._@+-]+")
#: Names that Windows keeps for devices, also with an ending.
_DEVICES: Final = re.compile(r"(?:con|prn|aux|nul|com\d|lpt\d)(?:\..*)?", re.IGNORECASE)
#: What stays of these when their accents are taken away is not what people write for them.
_SPELLED: Final = str.maketrans({"ß": "ss", "æ": "ae", "ø": "o", "ł": "l", "đ": "d", "œ": "oe"})


def safe_ids(wanted: Sequence[str]) -> list[str]:
    """An id for each of these different texts, in their order.

    It is the text itself where that is possible. What had to be changed and then is like another
    gets some signs of its hash, so that it does not depend on how many others there are.
    """
    made = [safe_id(text) for text in wanted]
    times = Counter(id.casefold() for id in made)
    keeps: dict[str, int] = {}  # of those that are alike, whose id is as wanted
    for number, (text, id) in enumerate(zip(wanted, made, strict=True)):
        if text == id:
            keeps.setdefault(id.casefold(), number)
    taken: set[str] = set()
    for number, (text, id) in enumerate(zip(wanted, made, strict=True)):
        fold = id.casefold()
        if times[fold] > 1 and keeps.get(fold) != number:
            made[number] = _marked(id, text)
        while made[number].casefold() in taken:
            made[number] = _marked(id, f"{text}\0{number}")
            text += "\0"
        taken.add(made[number].casefold())
    return made


def safe_id(text: str) -> str:
    """An id made of letters, digits and `._@+-` alone, and not one that a system keeps."""
    plain = unicodedata.normalize("NFKD", text.translate(_SPELLED))
    letters = "".join(sign for sign in plain if not unicodedata.combining(sign))
    id = _OTHERS.sub("-", letters).lstrip(".-").rstrip(".-")
    unwritten = sum(not sign.isascii() and sign.isalnum() for sign in letters)
    if len(id) > MAX_ID or unwritten:  # without them two names may be one
        id = _marked(id, text)
    return f"_{id}" if _DEVICES.fullmatch(id) else id or _marked("", text)


def _marked(id: str, text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:8]
    return f"{id[: MAX_ID - 9].rstrip('.-')}-{digest}" if id else f"student-{digest}"
