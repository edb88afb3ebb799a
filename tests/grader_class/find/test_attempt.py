from datetime import UTC, datetime

import pytest

from grader_class.find.attempt import read_time

NOON = datetime(2026, 11, 1, 12, tzinfo=UTC)


@pytest.mark.parametrize(
    "text",
    [
        "2026-11-01T12:00:00Z",
        "2026-11-01 13:00:00.000000000 +01:00",
        "20261101T120000Z",
        "2026-11-01_12-00-00Z",
        "2026-11-01 12:00 UTC",
        "2026-11-01T08-30-00-0330",
        "1793534400",
        "1793534400123",
    ],
)
def test_a_moment_is_read(text):
    assert read_time(text) == NOON


def test_without_a_zone_it_is_local_time():
    assert read_time("2026-11-01 12:00") == datetime(2026, 11, 1, 12).astimezone()
    assert read_time("20261101") == datetime(2026, 11, 1).astimezone()


@pytest.mark.parametrize(
    "text",
    [
        "",
        "soon",
        "2026-13-01",
        "2026-11-01T25:00",
        "2026-11-01T12:00+99:00",
        "12345",
        "-1",
        "Tuesday, 1 Foo 2026, 6:00 PM",
        "31 June 2026, 13:00 PM",
    ],
)
def test_what_is_no_moment_is_none(text):
    assert read_time(text) is None


@pytest.mark.parametrize(
    ("text", "hour"),
    [
        ("Tuesday, 1 December 2026, 6:00 PM", 18),
        ("Tuesday, 1 December 2026, 12:00 AM", 0),
        ("1 December 2026, 18:00", 18),
    ],
)
def test_moodles_english_times_are_local(text, hour):
    assert read_time(text) == datetime(2026, 12, 1, hour).astimezone()
