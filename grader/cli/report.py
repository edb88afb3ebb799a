"""Show a result in another format."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console

from grader import result as results
from grader.reports import terminal

FORMATS = {"terminal": terminal.show}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("result", type=Path, metavar="RESULT.json")
    parser.add_argument("--format", choices=sorted(FORMATS), default="terminal")


def main(args: argparse.Namespace) -> int:
    """Print the report on standard output."""
    FORMATS[args.format](results.read(args.result), Console())
    return 0
