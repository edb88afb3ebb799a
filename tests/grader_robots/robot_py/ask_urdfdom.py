"""Writes into urdfdom.json what urdfdom's own check_urdf says of the texts that stand there.

    pip install cmeel-urdfdom==6.0.0 && python tests/grader_robots/robot_py/ask_urdfdom.py

It is urdfdom 6; Jazzy has 4.0.2. What 4.0.2 says otherwise is put right here, as its sources have
it: it knows version 1.0 only, and does not name the joint whose limit is wrong.
"""

import json
import re
import subprocess
import sys
import tempfile
from itertools import groupby
from pathlib import Path

CHECK_URDF = Path(sys.executable).with_name("check_urdf")
AS_IN_4 = (
    (
        "Invalid 'version' specified; versions from 1.0 upto 1.2 are currently supported",
        "Invalid 'version' specified; only version 1.0 is currently supported",
    ),
    (r"Error:   joint \[j\]: limit has no", "Error:   joint limit: no"),
    (r"Error:   joint \[j\]: (\w+ value)", r"Error:   \1"),
)


def main() -> None:
    file = Path(__file__).with_name("urdfdom.json")
    texts = [each["text"] for each in json.loads(file.read_text())]
    lines = ",\n".join(json.dumps({"text": text, **ask(text)}) for text in texts)
    file.write_text(f"[\n{lines}\n]\n")


def ask(text: str) -> dict[str, object]:
    with tempfile.NamedTemporaryFile("w", encoding="utf-8", newline="") as file:
        file.write(text)
        file.flush()
        done = subprocess.run([CHECK_URDF, file.name], capture_output=True, text=True)
    told = done.stderr
    for pattern, replacement in AS_IN_4:
        told = re.sub(pattern, replacement, told)
    lines = [line for line in told.splitlines() if line.startswith(("Error:", "Warning:"))]
    # a visual that is a link's first is looked at twice
    return {"accepted": done.returncode == 0, "lines": [line for line, _ in groupby(lines)]}


if __name__ == "__main__":
    main()
