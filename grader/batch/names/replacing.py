r"""Find names in a text, however they are written there, and replace them.

Letters count without their accents, case and escapes: see `spelling`. A name may stand in a longer
word: `zoe_node`, `ZoeNode`, `zoe2`; but not in one that is known to belong to the task: `Nimal` in
`minimal_publisher`.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

from grader.batch.names.spelling import (
    PIECE,
    WORD,
    folded,
    is_unspaced,
    unaccented,
    unescaped,
    with_places,
)

#: A part of a name with so many letters is also found within a longer word; a shorter one is not:
#: `Jan` in `January`.
STRONG: Final = 5
#: A longer word is no word but data: a picture in base64.
_LONGEST_WORD: Final = 120
#: With so few names, most texts are seen to have none at one glance.
_FEW: Final = 100
#: So many words without a name are remembered.
_MOST_CLEAN: Final = 50_000
#: So many words at most make a name.
_MOST_WORDS: Final = 6
#: A name that counts only letter by letter, with its blanks, begins with this.
LITERAL: Final = "="
_WORD_BEFORE: Final = re.compile(r"[^\W_]+\Z")
_IDENTIFIER: Final = re.compile(r"\w+")
#: What may stand between two words of one name.
_GAP: Final = re.compile(r"[\W_]{0,4}")


class Span(NamedTuple):
    """Where a name stands in a text, and what it is replaced by."""

    begin: int
    end: int
    instead: str


def literal(text: str) -> str:
    """Return a name in the form in which it counts only letter by letter, with its blanks."""
    return LITERAL + " ".join(unaccented(text).split())


class Names:
    """Replaces names.

    Args:
        instead: a name, its folded words with blanks between them -> what stands for it.
        strong: the same, which come first; those of one word are also found within longer words,
            if they are long enough.
        others: more names, which come last.
        known: words in which no name stands, nor in a part of them.
    """

    def __init__(
        self,
        instead: Mapping[str, str],
        strong: Mapping[str, str] | None = None,
        others: Names | None = None,
        known: frozenset[str] = frozenset(),
    ) -> None:
        self._own = {**instead, **(strong or {})}
        self._others = others
        self._known = known
        #: The words of a literal name -> the names with these.
        self._literal: dict[str, list[str]] = {}
        for name in self._own:
            if name.startswith(LITERAL):
                self._literal.setdefault(" ".join(WORD.findall(folded(name))), []).append(name)
        names = [*(name for name in self._own if not name.startswith(LITERAL)), *self._literal]
        self._firsts = {name.split(" ", 1)[0] for name in names if " " in name}
        words = [name for name in names if " " not in name and not name.isdigit()]
        found = {name for name in words if is_unspaced(name)}
        found |= {name for name in words if name in (strong or {}) and len(name) >= STRONG}
        found |= {*others.strong} if others else set()
        self.strong: list[str] = sorted(found, key=lambda name: (-len(name), name))
        begins = {name.split(" ", 1)[0] for name in names}
        #: The words with names in them that were found; see `noting`.
        self._noted: set[str] | None = None
        #: Words without a name in them: most texts repeat theirs.
        self._clean: set[str] = set()
        is_few = len(begins) <= _FEW and not others
        self._any = re.compile("|".join(map(re.escape, sorted(begins)))) if is_few else None

    def __bool__(self) -> bool:
        """Whether there are names at all."""
        return bool(self._own or self._others)

    def noting(self, into: set[str]) -> Names:
        """Return the same names, which note in which words, `zoe_node`, they are found."""
        made = copy.copy(self)
        made._noted = into
        return made

    def stands_for(self, name: str) -> str:
        """Return what stands for a name; '' for what is none."""
        return self._own.get(name) or (self._others.stands_for(name) if self._others else "")

    def _as_it_stands(self, words: str, text: str) -> str:
        """Return what stands for a literal name; '' for what is none."""
        wanted = " ".join(text.split())
        for name in self._literal.get(words, ()):
            if name == LITERAL + wanted:
                return self._own[name]
        return self._others._as_it_stands(words, text) if self._others else ""

    def _begins(self, word: str) -> bool:
        """Whether a name of several words may begin with a word."""
        return word in self._firsts or (self._others is not None and self._others._begins(word))

    def __call__(self, text: str) -> str:
        """Return a text without the names."""
        made, at = [], 0
        for begin, end, instead in self.spans(text):
            made += [text[at:begin], _as_written(text, begin, end, instead)]
            at = end
        return "".join([*made, text[at:]]) if made else text

    def are_in(self, text: str) -> bool:
        """Whether a text has one of the names."""
        return next(self.spans(text), None) is not None

    def spans(self, text: str) -> Iterator[Span]:
        """Yield where names stand, in order."""
        if not self or not self._may_be_in(text):
            return
        plain, starts = with_places(text)
        done = 0
        for begin, end in self._words(plain):
            word = plain[begin:end]
            if begin < done or word in self._clean:
                continue
            done, found = self._at(plain, begin, end)
            is_clean = not found and not self._begins(word.casefold())
            if is_clean and len(self._clean) < _MOST_CLEAN:
                self._clean.add(word)
            for first, last, instead in found:
                if self._noted is not None:
                    self._noted.add(_identifier(plain, first, last))
                if starts is None:
                    yield Span(first, last, instead)
                else:
                    yield Span(starts[first], starts[last], instead)

    def _may_be_in(self, text: str) -> bool:
        """Whether the beginning of a name is in a text, anywhere: most texts have none."""
        if self._any is None:
            return True
        return self._any.search(folded(unescaped(text))) is not None

    def _words(self, plain: str) -> Iterator[tuple[int, int]]:
        """Yield where words are in which a name may begin."""
        small = plain.casefold()
        if self._any is None or len(small) != len(plain):
            yield from (match.span() for match in WORD.finditer(plain))
            return
        end = 0
        for found in self._any.finditer(small):
            if found.start() < end:
                continue
            at = found.start()
            before = _WORD_BEFORE.search(plain, max(0, at - _LONGEST_WORD), at)
            begin = before.start() if before else at
            word = WORD.match(plain, begin)
            assert word is not None
            end = word.end()
            yield begin, end

    def _at(self, plain: str, begin: int, end: int) -> tuple[int, list[Span]]:
        """Return up to where a text is done from this word on, and the names in that."""
        words, ends = [plain[begin:end].casefold()], [end]
        if self._begins(words[0]):
            while len(words) < _MOST_WORDS and (gap := _GAP.match(plain, ends[-1])):
                following = WORD.match(plain, gap.end())
                if following is None:
                    break
                words.append(following[0].casefold())
                ends.append(following.end())
            for count in range(len(words), 1, -1):
                together, last = " ".join(words[:count]), ends[count - 1]
                literally = self._as_it_stands(together, plain[begin:last])
                if instead := literally or self.stands_for(together):
                    return last, [Span(begin, last, instead)]
        if instead := self.stands_for(words[0]):
            return end, [Span(begin, end, instead)]
        return end, list(self._within(plain[begin:end], begin))

    def _within(self, word: str, begin: int) -> Iterator[Span]:
        """Yield the names within a longer word."""
        if len(word) > _LONGEST_WORD:
            return
        pieces = [match.span() for match in PIECE.finditer(word)]
        found = list(self._of_pieces(word, pieces)) if len(pieces) > 1 else []
        found = found or list(self._of_letters(word.casefold(), len(word), pieces))
        for first, last, instead in found:
            yield Span(begin + first, begin + last, instead)

    def _of_pieces(self, word: str, pieces: list[tuple[int, int]]) -> Iterator[Span]:
        number = 0
        while number < len(pieces):
            for last in range(min(len(pieces), number + _MOST_WORDS), number, -1):
                first, end = pieces[number][0], pieces[last - 1][1]
                together = " ".join(word[a:b] for a, b in pieces[number:last]).casefold()
                joined = together.replace(" ", "")
                if instead := self.stands_for(joined) or self.stands_for(together):
                    yield Span(first, end, instead)
                    number = last - 1
                    break
            number += 1

    def _of_letters(self, word: str, length: int, pieces: list[tuple[int, int]]) -> Iterator[Span]:
        if word in self._known or len(word) != length:  # a letter whose small form is two
            return
        taken: list[Span] = []
        for name in self.strong:
            at = word.find(name)
            while at >= 0:
                end = at + len(name)
                is_free = all(end <= each.begin or at >= each.end for each in taken)
                if is_free and not self._cuts(word, at, end, pieces):
                    taken.append(Span(at, end, self.stands_for(name)))
                at = word.find(name, end)
        yield from sorted(taken)

    def _cuts(self, word: str, begin: int, end: int, pieces: list[tuple[int, int]]) -> bool:
        """Whether letters are a part of a known word."""
        return any(
            first < end
            and begin < last
            and (first < begin or end < last)
            and word[first:last] in self._known
            for first, last in pieces
        )


def _identifier(text: str, begin: int, end: int) -> str:
    """Return what stands at a place, with all letters, digits and _ before and behind."""
    before = re.search(r"\w*\Z", text[max(0, begin - _LONGEST_WORD) : begin])
    behind = _IDENTIFIER.match(text, end)
    around = before[0] if before else "", behind[0] if behind else ""
    return text[begin:end].join(around)


def _as_written(text: str, begin: int, end: int, instead: str) -> str:
    """Return what stands for a name, in the case of the identifier that it is a part of."""
    around = text[begin - 1 : begin] + text[end : end + 1]
    if not any(sign.isalnum() or sign == "_" for sign in around):
        return instead
    name = text[begin:end]
    if name.isupper() and len(name) > 1:
        return instead.upper()
    return instead[:1].upper() + instead[1:] if name[:1].isupper() else instead
