"""Parses the address of an exercise: ADDRESS[@TAG][#FOLDER].

An address is one of https, ssh (also `git@host:path`) or file, or the path of a folder here. What
may stand in it is listed, for it goes to git, which runs programs for some addresses; and it goes
into results, so that no password may be in it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Final

from grader.errors import UsageError
from grader.message import msg

_HOST: Final = r"(?:[A-Za-z0-9_][\w.-]*@)?[A-Za-z0-9][A-Za-z0-9.-]*"
_PATH: Final = r"[\w./~+%-]+"
_URL: Final = re.compile(rf"(?:https|ssh)://{_HOST}(?::[0-9]{{1,5}})?/{_PATH}", re.ASCII)
_SCP: Final = re.compile(rf"{_HOST}:(?!/?-){_PATH}", re.ASCII)
#: A tag, a branch without a slash, or a commit.
_TAG: Final = re.compile(r"[A-Za-z0-9_](?:[\w.+-]{0,98}\w)?", re.ASCII)
#: A folder as a host's own page shows it: https://github.com/me/x/tree/main/corner.
_SHOWN: Final = re.compile(
    r"(https://(?:github\.com/[^/]+/[^/]+|.+(?=/-/)))/(?:-/)?tree/([^/]+)(?:/(.+?))?/?", re.ASCII
)
_FOLDER: Final = re.compile(r"(?:[A-Za-z0-9_][\w.-]*)(?:/[A-Za-z0-9_][\w.-]*)*", re.ASCII)
#: What stands before a host: over https a token may pose as the user.
_SECRET: Final = re.compile(r"https?://[^/@]*@|\w+://[^/@]*:[^/@]*@")
_EXPECTED: Final = msg(
    "expected https://HOST/PATH, ssh://HOST/PATH, git@HOST:PATH, or the path of a repository here, "
    "then perhaps @TAG and #FOLDER"
)


@dataclass(frozen=True)
class Address:
    """A place in a git repository.

    Attributes:
        repository: its address, as git gets it.
        tag: a tag, a branch or a commit; '' for its head.
        folder: where in it the exercise lies; '' for its root.
    """

    repository: str
    tag: str = ""
    folder: str = ""

    @classmethod
    def parse(cls, text: str) -> Address:
        """Parse an address.

        Raises:
            UsageError: it is none, or one that is not fetched from.
        """
        if has_secret(text):  # first: other refusals repeat the text
            why = msg(
                "a password or token before the host of an address would be in every result: leave "
                "it out, git has credential helpers"
            )
            raise UsageError(why)
        rest, hash_sign, folder = text.partition("#")
        # "@" is also before a host: a tag is behind the last "/" and ":"
        last = max(rest.rfind("/"), rest.rfind(":"))
        at = rest.rfind("@")
        tag = rest[at + 1 :] if at > last else ""
        repository = rest[:at] if at > last else rest
        if at > last:
            check_tag(tag, text)
        is_folder = _FOLDER.fullmatch(folder) and ".." not in PurePosixPath(folder).parts
        if hash_sign and not is_folder:
            raise _refused(text, msg("{folder!r} is no folder in a repository", folder=folder))
        return cls(_repository(repository, text), tag, folder)


def has_secret(address: str) -> bool:
    """Whether a password or a token is, or may be, in an address."""
    return _SECRET.search(address) is not None


def check_tag(tag: str, text: str) -> None:
    """Refuse what is no tag.

    Raises:
        UsageError: it is none; with the text that it is in.
    """
    if not _TAG.fullmatch(tag) or ".." in tag:
        raise UsageError(
            "{text!r}: expected a tag, a branch without a slash, or a commit behind the @, found "
            "{tag!r}",
            text=text[:200],
            tag=tag[:200],
        )


def _repository(given: str, text: str) -> str:
    if page := _SHOWN.fullmatch(given):
        shown, tag, inside = page.groups("")
        raise UsageError(
            "{text!r} is the address of a page; the repository's is {address}",
            text=text[:200],
            address=f"{shown}@{tag}" + (f"#{inside}" if inside else ""),
        )
    if _is_url(given):
        return given
    path = given.removeprefix("file://")
    if given and not given.startswith("-") and "://" not in path and "::" not in path:
        folder = Path(path)
        if folder.is_dir():
            return folder.resolve().as_uri()
        _check_no_slash(given, text)
        raise _refused(text, msg("there is no folder {path!r} here", path=path))
    _check_no_slash(given, text)
    raise _refused(text, msg("it is no address that exercises are fetched from"))


def _check_no_slash(given: str, text: str) -> None:
    """Refuse what would be an address but for a slash behind the @."""
    repository, at, tag = given.rpartition("@")
    if at and (_is_url(repository) or Path(repository.removeprefix("file://")).is_dir()):
        check_tag(tag, text)


def _is_url(given: str) -> bool:
    is_scp = _SCP.fullmatch(given) is not None and "://" not in given
    return is_scp or _URL.fullmatch(given) is not None


def _refused(text: str, why: object) -> UsageError:
    return UsageError("{text!r}: {why}; {expected}", text=text[:200], why=why, expected=_EXPECTED)
