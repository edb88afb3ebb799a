"""Generates the C, C++ and Python sources of a ROS 2 interface package, without CMake.

This calls the Python API of the rosidl generators, as ROS's own CMake functions do. Their
command `rosidl generate` cannot be used: the wheels on PyPI register its plug-ins twice, which
it refuses. Needs the packages listed under `build` in pyproject.toml.
"""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

KINDS = ("msg", "srv", "action")
# Fast DDS serialises by the first, but looks at every type by the second when it registers it:
# without introspection a module imports, and the first publisher fails.
TYPE_SUPPORTS = ("rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c")


def ros_prefix() -> Path:
    """The directory whose include/, lib/ and share/ the ROS wheels fill."""
    import rosidl_generator_c

    # <prefix>/lib/python3.X/site-packages/rosidl_generator_c/__init__.py
    return Path(rosidl_generator_c.__file__).resolve().parents[4]


def generate(package: str, manifest: Path, definitions: Path, out: Path) -> None:
    """Generate a package from `definitions` (msg/, srv/, action/) and its package.xml below `out`.

    `out` then holds `share/`, as ROS installs it (definitions, type descriptions, index), and one
    folder a generator, `<generator>/<package>/`, with its sources.
    """
    from rosidl_adapter import convert_to_idl
    from rosidl_generator_c import generate_c
    from rosidl_generator_py import generate_py
    from rosidl_generator_type_description import generate_type_hash
    from rosidl_typesupport_c import generate_c as generate_dispatch
    from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c
    from rosidl_typesupport_introspection_c import generate_c as generate_introspection

    definitions, out = definitions.resolve(), out.resolve()
    share = out / "share" / package
    share.mkdir(parents=True)
    files = [
        path.relative_to(definitions)
        for kind in KINDS
        for path in sorted((definitions / kind).glob(f"*.{kind}"))
    ]
    idls = [convert_to_idl(definitions, package, file, share).relative_to(share) for file in files]
    _write_share(package, manifest, definitions, out / "share", files, idls)

    def arguments(generator: str, output: Path | None = None, **more: Any) -> str:
        return _arguments_file(package, generator, out, share, idls, output, more)

    ros_share = ros_prefix() / "share"
    # type hashes first: the C sources carry them. Those of other packages' types stand in share/
    generate_type_hash(
        arguments(
            "rosidl_generator_type_description",
            output=share,
            include_paths=[
                f"{other.name}:{other}"
                for other in ros_share.iterdir()
                if any((other / kind).is_dir() for kind in KINDS)
            ],
        )
    )
    generate_c(
        arguments(
            "rosidl_generator_c",
            type_description_tuples=[
                f"{idl.as_posix()}:{share / idl.with_suffix('.json')}" for idl in idls
            ],
            ros_interface_files=[str(definitions / file) for file in files],
        )
    )
    generate_typesupport_fastrtps_c(arguments("rosidl_typesupport_fastrtps_c"))
    generate_introspection(arguments("rosidl_typesupport_introspection_c"))
    generate_dispatch(arguments("rosidl_typesupport_c"), list(TYPE_SUPPORTS))
    generate_py(arguments("rosidl_generator_py"), ["rosidl_typesupport_c"])
    (out / "rosidl_generator_py" / package / "__init__.py").touch()


def _write_share(
    package: str,
    manifest: Path,
    definitions: Path,
    share: Path,
    files: Sequence[Path],
    idls: Sequence[Path],
) -> None:
    """Definitions with their licence, and the package's entries in the ament index."""
    shutil.copyfile(manifest, share / package / "package.xml")
    licence = [path.relative_to(definitions) for path in definitions.glob("LICENSE")]
    for file in (*licence, *files):
        shutil.copyfile(definitions / file, share / package / file)
    entries = {
        "packages": "",
        "rosidl_interfaces": "\n".join(sorted(path.as_posix() for path in (*files, *idls))),
    }
    for resource, text in entries.items():
        entry = share / "ament_index" / "resource_index" / resource / package
        entry.parent.mkdir(parents=True, exist_ok=True)
        entry.write_text(text)


def _arguments_file(
    package: str,
    generator: str,
    out: Path,
    share: Path,
    idls: Sequence[Path],
    output: Path | None,
    more: dict[str, Any],
) -> str:
    """The JSON file that a generator reads its arguments from."""
    output = output or out / generator / package
    output.mkdir(parents=True, exist_ok=True)
    templates = ros_prefix() / "share" / generator / "resource"
    # ROS's CMake functions fill in these headers; the generated C sources include them
    for template in templates.glob("*__visibility_control.h.in"):
        header = output / "msg" / template.stem
        header.parent.mkdir(exist_ok=True)
        text = template.read_text().replace("@PROJECT_NAME_UPPER@", package.upper())
        header.write_text(text.replace("@PROJECT_NAME@", package))
    path = out / f"{generator}.json"
    path.write_text(
        json.dumps(
            {
                "package_name": package,
                "output_dir": str(output),
                "template_dir": str(templates),
                "idl_tuples": [f"{share}:{idl.as_posix()}" for idl in idls],
                "target_dependencies": [],
                "ros_interface_dependencies": [],
                **more,
            }
        )
    )
    return str(path)
