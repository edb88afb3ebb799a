"""A student's file is seen as it would run, without running."""

import pytest

from grader.submission.python_source import read_source


def seen(tmp_path, text):
    file = tmp_path / "node.py"
    file.write_text(text)
    return read_source(file)


@pytest.mark.parametrize(
    ("line", "is_one"),
    [
        ('if __name__ == "__main__": run()', True),
        ('if (__name__ == "__main__") and True: run()', True),
        ('try:\n    pass\nfinally:\n    if __name__ == "__main__": run()', True),
        ("# if __name__ == '__main__':", False),
        ("def f():\n    if __name__ == '__main__': pass", False),
    ],
)
def test_a_guard_is_seen(tmp_path, line, is_one):
    assert seen(tmp_path, line).has_guard == is_one


def test_only_a_main_at_module_level_counts(tmp_path):
    assert seen(tmp_path, "if True:\n    async def main(): ...").has_main
    assert not seen(tmp_path, "class Node:\n    def main(self): ...").has_main


@pytest.mark.parametrize("line", ["main()", "sys.exit(main())", "Thread(target=main).start()"])
def test_a_call_of_main_is_seen(tmp_path, line):
    assert seen(tmp_path, line).calls_main
    assert not seen(tmp_path, f"def other():\n    {line}").calls_main


@pytest.mark.parametrize(
    ("text", "lacks"),
    [
        ("def main(): ...", False),
        ("class main: ...", False),
        ("main = print", False),
        ("from a import main", False),
        ("from a import b as main", False),
        ("from a import *", False),
        ("if a:\n    pass\nelse:\n    main = print", False),
        ("def f():\n    global main\n    main = print", False),
        ("globals()['main'] = print", False),
        ("def __getattr__(name): ...", False),
        ("def main(:", False),
        ("", True),
        ("class A:\n    def main(self): ...", True),
        ("def f():\n    main = 1", True),
        ("import a.main", True),
    ],
)
def test_a_name_is_surely_missing_where_it_cannot_be_there(tmp_path, text, lacks):
    assert seen(tmp_path, text).surely_lacks("main") == lacks


def test_definitions_come_in_the_order_of_the_file(tmp_path):
    text = "import os\nB = 1\ndef c(): ...\nif B:\n    class A: ...\n"
    assert seen(tmp_path, text).defined == ("B", "c", "A")


def test_a_warning_of_the_parser_is_left_to_the_run(tmp_path):
    assert seen(tmp_path, "x = '\\d'\n").parses


def test_a_file_of_megabytes_is_not_looked_into(tmp_path):
    assert not seen(tmp_path, "#" * 1_000_001).parses
