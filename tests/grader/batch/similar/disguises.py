"""Copies of a source, disguised as copies are: the program stays, what it looks like changes."""

from __future__ import annotations

import ast
import builtins
import re


def renamed(source: str) -> str:
    """All names of its own are others."""
    tree = ast.parse(source)
    own = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    own |= {n.arg for n in ast.walk(tree) if isinstance(n, ast.arg)}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            own.add(node.name)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            own |= {node.attr} if isinstance(node.value, ast.Name) else set()
    # what belongs to messages and to Node keeps its name, as it has to
    own -= {"__init__", "x", "y", "z", "r", "g", "b", "width", "off", "main", *dir(builtins)}
    names = sorted(own, key=len, reverse=True)
    pattern = re.compile(r"\b(" + "|".join(map(re.escape, names)) + r")\b")
    return pattern.sub(lambda match: f"other_{names.index(match[1])}", source)


def reformatted(source: str) -> str:
    """Another layout, no comments, no docstrings but new ones, and some lines that print."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            if ast.get_docstring(node) is not None:
                node.body[0] = ast.parse("'A new one.'").body[0]
            node.body.insert(0, ast.parse("print('here')").body[0])
    return "# by somebody else\n" + ast.unparse(ast.fix_missing_locations(tree)) + "\n"


def reordered(source: str) -> str:
    """Functions and methods the other way round."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            functions = [n for n in node.body if isinstance(n, ast.FunctionDef)]
            node.body = [n for n in node.body if n not in functions] + functions[::-1]
    functions = [n for n in tree.body if isinstance(n, ast.FunctionDef | ast.ClassDef)]
    places = [n for n, node in enumerate(tree.body) if node in functions]
    for place, node in zip(places, functions[::-1], strict=True):
        tree.body[place] = node
    return ast.unparse(tree) + "\n"


def other_constants(source: str) -> str:
    """Numbers a little larger, texts with a dot."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant):
            if isinstance(node.value, float):
                node.value = round(node.value * 1.03, 4)
            elif type(node.value) is int and node.value > 1:
                node.value -= 1
    return ast.unparse(tree) + "\n"


def split(source: str) -> str:
    """The longest function or method is two: the second half is in one of its own."""
    tree = ast.parse(source)
    owners = [n for n in ast.walk(tree) if isinstance(n, ast.ClassDef | ast.Module)]
    both = [(len(f.body), n, f) for n in owners for f in n.body if isinstance(f, ast.FunctionDef)]
    _, owner, longest = max(both, key=lambda each: each[0])
    half = len(longest.body) // 2
    call = "self.rest()" if isinstance(owner, ast.ClassDef) else "rest()"
    rest = ast.parse(f"def rest({'self' if call.startswith('self') else ''}): pass").body[0]
    rest.body, longest.body = longest.body[half:], longest.body[:half]
    longest.body.append(ast.parse(call).body[0])
    owner.body.insert(owner.body.index(longest) + 1, rest)
    return ast.unparse(ast.fix_missing_locations(tree)) + "\n"


DISGUISES = {
    "renamed": renamed,
    "reformatted": reformatted,
    "reordered": reordered,
    "other_constants": other_constants,
    "split": split,
    "all": lambda source: split(reordered(reformatted(other_constants(renamed(source))))),
}
