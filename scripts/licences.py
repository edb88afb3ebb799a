#!/usr/bin/env python3
"""List the licences of all that `pip install turtlesim_py[...]` brings, in docs/licences.md.

    licences.py PREFIX ...                  write the list, from what is installed in environments
    licences.py --check PREFIX ...          fail where something is not in the list, or otherwise
    licences.py --complete BOM PREFIX       add to a CycloneDX file what it lacks: licences, and the
                                            libraries that ROS's wheels hold

A licence that is in no metadata, or that nobody has accepted, fails: read it, then say so below.
"""

import json
import re
import sys
from collections.abc import Iterator
from importlib.metadata import Distribution, distributions
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

LIST = Path(__file__).resolve().parents[1] / "docs" / "licences.md"
OURS = ("turtlesim-py", "turtlesim-py-jazzy", "turtlesim-py-kilted")
#: What may be installed with software under BSD-3-Clause, as a wheel beside it.
ACCEPTED = {
    *("0BSD", "Apache-2.0", "BSD", "BSD-2-Clause", "BSD-3-Clause", "CC0-1.0", "MIT", "MIT-CMU"),
    *("OpenSSL", "PSF-2.0", "Zlib", "LGPL-2.1-only", "LGPL-2.1-or-later"),
}
#: Other names for the same, in classifiers and in package.xml.
SAME = {
    "Apache 2.0": "Apache-2.0",
    "Apache License 2.0": "Apache-2.0",
    "Apache License, Version 2.0": "Apache-2.0",
    "Apache Software License": "Apache-2.0",
    "BSD License": "BSD",
    "MIT License": "MIT",
    "zlib License": "Zlib",
}
#: Of those that say nothing in their metadata: as the file LICENSE in their wheels has it.
READ = {
    "ros-fastcdr": "Apache-2.0",
    "ros-fastdds": "Apache-2.0",
    "ros-fastrtps": "Apache-2.0",
    "setuptools": "MIT",
    "xacro": "BSD-3-Clause",
}
#: Libraries of Linux that the wheels of ROS hold a copy of, by the beginnings of their names.
LIBRARIES = {
    "libcrypto": "OpenSSL",
    "libfmt": "MIT",
    "liblttng-ust": "LGPL-2.1-only",
    "libspdlog": "MIT",
    "libssl": "OpenSSL",
    "libtinyxml2": "Zlib",
    "liburcu": "LGPL-2.1-or-later",
    "libyaml": "MIT",
}
#: libssl-3d4c8e8d.so.1.1.1k
LIBRARY = re.compile(r"(lib[a-z\d-]+?)(?:-[\d.]+)?-[\da-f]{8}\.so\.?([\w.]*)")
HEAD = """\
# Licences

What `pip install 'turtlesim_py[jazzy]'` or `[kilted]` installs, by `scripts/licences.py`; a test
fails where something else is installed, or under another licence. turtlesim_py itself is under
[BSD-3-Clause](../LICENSE), what it needs of ROS under that and Apache-2.0.
"""


class Unknown(Exception):
    """A licence that nobody has accepted, or none."""


def normal(name: str) -> str:
    """Return the name of a distribution as an index has it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def site(prefix: Path) -> Path:
    """Return the folder of packages of an environment."""
    (found,) = prefix.glob("lib/python3*/site-packages")
    return found


def required(prefix: Path) -> dict[str, Distribution]:
    """Return what ours needs in an environment, with ours."""
    installed: dict[str, Distribution] = {}
    for each in distributions(path=[str(site(prefix))]):
        installed.setdefault(normal(each.metadata["Name"]), each)
    found: dict[str, Distribution] = {}
    wanted = [*OURS]
    while wanted:
        name = wanted.pop()
        if name in installed and name not in found:
            found[name] = installed[name]
            lines = [line for line in found[name].requires or () if "extra ==" not in line]
            wanted += [normal(re.split(r"[^\w.-]", line, maxsplit=1)[0]) for line in lines]
    return found


def declared(name: str, of: Distribution, prefix: Path) -> Iterator[str]:
    """Yield the licences of a distribution: of its metadata, or of the ROS package in it."""
    if expression := of.metadata.get("License-Expression"):
        yield from expression.split(" AND ")
        return
    classifiers = of.metadata.get_all("Classifier") or []
    named = [line.rpartition(" :: ")[2] for line in classifiers if line.startswith("License ::")]
    if named := [each for each in named if each != "OSI Approved"]:
        yield from named
    elif (text := of.metadata.get("License") or "") and "\n" not in text:
        yield from text.split(" AND ")
    elif name in READ:
        yield READ[name]
    elif name.startswith("ros-"):
        package = re.sub("^ros-((jazzy|kilted)-)?", "", name).replace("-", "_")
        manifest = prefix / "share" / package / "package.xml"
        if manifest.exists():
            yield from (each.text or "" for each in ElementTree.parse(manifest).iter("license"))


def licence(name: str, of: Distribution, prefix: Path) -> str:
    """Return the licence of a distribution, as an expression.

    Raises:
        Unknown: there is none, or it is not accepted.
    """
    parts = dict.fromkeys(
        SAME.get(each.strip(), each.strip()) for each in declared(name, of, prefix)
    )
    if not parts or parts.keys() - ACCEPTED:
        found = " AND ".join(parts) or "none"
        raise Unknown(f"{name} {of.version}: its licence is {found}; nobody has accepted that")
    return " AND ".join(sorted(parts))


def libraries(prefix: Path) -> dict[str, list[tuple[str, str, str]]]:
    """Return the libraries in wheels of ROS: name, version, licence, by the wheel's distribution.

    Raises:
        Unknown: one has no known licence.
    """
    found: dict[str, list[tuple[str, str, str]]] = {}
    for path in sorted(site(prefix).glob("ros_*.libs/*.so*")):
        if (prefix / "lib" / re.sub(r"-[\da-f]{8}\.", ".", path.name)).exists():
            continue  # another copy of what is ROS's own
        match = LIBRARY.fullmatch(path.name)
        known = [each for start, each in LIBRARIES.items() if path.name.startswith(start)]
        if not match or not known:
            raise Unknown(
                f"{path.parent.name}/{path.name}: a library whose licence nobody has read"
            )
        found.setdefault(normal(path.parent.stem), []).append((*match.groups(), known[0]))
    return found


def listed(prefixes: list[Path]) -> dict[str, str]:
    """Return the licence of each thing that is installed, by name.

    Raises:
        Unknown: as above.
    """
    found = {
        name: licence(name, each, prefix)
        for prefix in prefixes
        for name, each in required(prefix).items()
        if name not in OURS
    }
    for prefix in prefixes:
        for held in libraries(prefix).values():
            found |= {f"{name} (in wheels of ROS)": known for name, _, known in held}
    return found


def text(found: dict[str, str]) -> str:
    """Return the file: a row for each licence."""
    rows = [
        f"| {each} | {', '.join(sorted(name for name in found if found[name] == each))} |\n"
        for each in sorted(set(found.values()))
    ]
    return f"{HEAD}\n| licence | of |\n|---|---|\n{''.join(rows)}"


def read() -> dict[str, str]:
    """Return what the file lists."""
    rows = re.findall(r"^\| (.+) \| (.+) \|$", LIST.read_text(encoding="utf-8"), re.MULTILINE)
    return {name: each for each, names in rows for name in names.split(", ")}


def complete(bom: Path, prefix: Path) -> None:
    """Add to a CycloneDX file the licences and libraries that it lacks."""
    data: dict[str, Any] = json.loads(bom.read_text(encoding="utf-8"))
    known, held = listed([prefix]), libraries(prefix)
    for component in data["components"]:
        name = normal(component["name"])
        # a wheel of ROS holds the metadata of its package beside its own
        if found := known.get(name) or known.get(f"ros-{name}"):
            component.setdefault("licenses", [stated(found)])
        if name in held:
            component["components"] = [
                {
                    "type": "library",
                    "bom-ref": f"{name}/{library}",
                    "name": library,
                    "version": version,
                    "licenses": [stated(each)],
                }
                for library, version, each in held[name]
            ]
    bom.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")


def stated(found: str) -> dict[str, Any]:
    """Return a licence as CycloneDX has it."""
    if "BSD" in found.split(" AND "):  # which one is not said, so that SPDX has no name for it
        return {"license": {"name": found}}
    return {"expression": found, "acknowledgement": "concluded"}


def main(words: list[str]) -> str | None:
    """Do what is asked; return what is wrong."""
    try:
        if words[0] == "--complete":
            complete(Path(words[1]), Path(words[2]))
            return None
        found = listed([Path(word) for word in words if word != "--check"])
    except Unknown as unknown:
        return f"{unknown}: see {Path(__file__).name}"
    if "--check" not in words:
        LIST.write_text(text(found), encoding="utf-8")
        return None
    known = read()
    wrong = [
        f"{name}: {licence}, and docs/licences.md has {known.get(name, 'nothing of it')}"
        for name, licence in found.items()
        if known.get(name) != licence
    ]
    return "\n".join([*wrong, "See scripts/licences.py."]) if wrong else None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
