"""When something was handed in, as people and course systems write it."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta, timezone
from typing import Final

#: ISO 8601, and what is made of it for names of files: 2026-11-01_12-30-05, 20261101T123005Z;
#: Ruby's YAML has nanoseconds and a space before the zone.
_TIME: Final = re.compile(
    r"(?P<year>\d{4})-?(?P<month>\d\d)-?(?P<day>\d\d)"
    r"(?:(?:T|[ _-]+|, )(?P<hour>\d\d)[:.h-]?(?P<minute>\d\d)"
    r"(?:[:.-]?(?P<second>\d\d)(?:[.,](?P<fraction>\d{1,9}))?)?)?"
    r" ?(?:(?P<utc>Z|UTC)|(?P<sign>[+-])(?P<hours>\d\d):?(?P<minutes>\d\d))?"
)
#: As Moodle writes it in English: Tuesday, 1 December 2026, 6:00 PM.
_MONTHS: Final = (
    *("january", "february", "march", "april", "may", "june", "july", "august", "september"),
    *("october", "november", "december"),
)
_MOODLE: Final = re.compile(
    r"(?:[A-Za-z]+, )?(?P<day>\d{1,2}) (?P<month>[A-Za-z]+) (?P<year>\d{4}), "
    r"(?P<hour>\d{1,2}):(?P<minute>\d\d)(?:\s(?P<half>[AP]M))?"
)
_EPOCH: Final = re.compile(r"\d{10}|\d{13}")  # seconds, milliseconds since 1970


def read_time(text: str) -> datetime | None:
    """The moment that a text means; None if it means none.

    Without a zone it is this machine's local time, and without an hour the day's first moment.
    """
    text = text.strip()
    if _EPOCH.fullmatch(text):
        return datetime.fromtimestamp(int(text[:10]), UTC)
    match = _TIME.fullmatch(text)
    if match is None:
        return _of_moodle(text)
    year, month, day, hour, minute, second = (int(part or 0) for part in match.groups()[:6])
    microsecond = int((match["fraction"] or "").ljust(6, "0")[:6])
    try:
        at = datetime(year, month, day, hour, minute, second, microsecond)
        if match["utc"]:
            return at.replace(tzinfo=UTC)
        if match["sign"]:
            return at.replace(tzinfo=zone(match["sign"], match["hours"], match["minutes"]))
        return at.astimezone()
    except (ValueError, OverflowError, OSError):  # there is no such day, or zone
        return None


def _of_moodle(text: str) -> datetime | None:
    match = _MOODLE.fullmatch(text)
    if match is None or match["month"].casefold() not in _MONTHS:
        return None
    month, hour = _MONTHS.index(match["month"].casefold()) + 1, int(match["hour"])
    if match["half"]:
        if not 1 <= hour <= 12:
            return None
        hour = hour % 12 + (12 if match["half"] == "PM" else 0)
    try:
        at = datetime(int(match["year"]), month, int(match["day"]), hour, int(match["minute"]))
        return at.astimezone()
    except (ValueError, OverflowError, OSError):
        return None


def zone(sign: str, hours: str, minutes: str) -> timezone:
    """A time zone from its numbers.

    Raises:
        ValueError: no zone is so far away.
    """
    ahead = timedelta(hours=int(hours), minutes=int(minutes))
    if ahead > timedelta(hours=14):
        raise ValueError(f"no time zone is {hours}:{minutes} from Greenwich")
    return timezone(-ahead if sign == "-" else ahead)
