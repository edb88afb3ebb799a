"""Exports of course systems, made by hand as their own source code or documentation has them."""

from grader_class.find.finding import find

NODE = "def main():\n    pass\n"


class Finder:
    """Finds, and keeps what was found until the test is over."""

    def __init__(self, stack):
        self._stack = stack

    def __call__(self, submissions, **options):
        return self._stack.enter_context(find(submissions, **options))

    def by_id(self, submissions, **options):
        return {each.id: each for each in self(submissions, **options).hand_ins}


def content(hand_in):
    """The files of a hand-in, by their paths in it."""
    if hand_in.path.is_file():
        return {hand_in.path.name}
    files = (path for path in hand_in.path.rglob("*") if path.is_file())
    return {str(path.relative_to(hand_in.path)) for path in files}


def noted(found, *words):
    """Whether one of the notes has all these words."""
    return any(all(word in note for word in words) for note in map(str, found.notes))
