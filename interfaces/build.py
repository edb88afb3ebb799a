"""The setuptools command that builds the interface packages below `packages/`.

One self-contained extension module a package: generated, compiled and linked against the ROS
wheels of PyPI. Used by setup.py, and only where ROS is not sourced.
"""

import shutil
from importlib.metadata import version
from multiprocessing import get_context
from pathlib import Path

from setuptools import Extension
from setuptools.command.build_ext import build_ext
from setuptools.errors import CompileError

from interfaces.generate import generate, ros_prefix

HERE = Path(__file__).resolve().parent
# Package -> the folder with its definitions. Those of turtlesim have two names: from ROS 2 Kilted
# on it is the second.
PACKAGES = {"turtlesim": "turtlesim", "turtlesim_msgs": "turtlesim", "tf2_msgs": "tf2_msgs"}

# Packages whose types ours use. An action uses goal ids and the status topic by itself, a service
# its events.
DEPENDENCIES = (
    *("builtin_interfaces", "action_msgs", "service_msgs", "unique_identifier_msgs"),
    *("std_msgs", "geometry_msgs"),  # tf2_msgs'
)

# ament_index finds packages below AMENT_PREFIX_PATH only, which nothing sets in a plain venv.
# Python runs this line at every start. Last in the list: a sourced workspace goes first.
AMENT_PREFIX_PTH = (
    "import os, sys; "
    "_p = [p for p in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep) if p]; "
    "sys.prefix in _p or os.environ.update(AMENT_PREFIX_PATH=os.pathsep.join([*_p, sys.prefix]))\n"
)


def extensions() -> list[Extension]:
    """What to give to `setup(ext_modules=...)`; the names are those that rclpy imports."""
    return [Extension(f"{name}.{name}_s__rosidl_typesupport_c", sources=[]) for name in PACKAGES]


class BuildInterfaces(build_ext):
    """`build_ext` that writes the sources first, and collects what goes beside the extension."""

    def run(self) -> None:
        """Build all packages and the .pth file that makes the ament index work."""
        super().run()
        lib = Path(self.build_lib)
        lib.mkdir(parents=True, exist_ok=True)
        (lib / "turtlesim_py_ament_prefix.pth").write_text(AMENT_PREFIX_PTH)

    def build_extensions(self) -> None:
        """Build the packages side by side, and collect what each has made.

        Processes, not the threads of `build_ext --parallel`: to generate is Python's work, and
        half of it all.
        """
        fork = get_context("fork")
        builders = [
            fork.Process(target=self.build_extension, args=[ext]) for ext in self.extensions
        ]
        for builder in builders:
            builder.start()
        for builder in builders:
            builder.join()
        for ext, builder in zip(self.extensions, builders, strict=True):
            if builder.exitcode:
                raise CompileError(f"{ext.name} cannot be built, see above")
            self._collect(*self._package(ext))

    def _package(self, ext: Extension) -> tuple[str, Path]:
        """The name of the package, and the folder of what is generated for it."""
        package = ext.name.split(".")[0]
        return package, (Path(self.build_temp) / "rosidl" / package).resolve()

    def build_extension(self, ext: Extension) -> None:
        """Generate and compile one package, unless nothing has changed."""
        package, generated = self._package(ext)
        module = Path(self.get_ext_fullpath(ext.name))
        built_with = generated / "built_with.txt"
        is_ours = built_with.exists() and built_with.read_text() == _ros_version()
        if self.force or not is_ours or not _is_newer(module, than=_inputs()):
            # no leftovers of interfaces that were renamed or removed
            shutil.rmtree(generated, ignore_errors=True)
            shutil.rmtree(Path(self.build_lib) / package, ignore_errors=True)
            definitions = HERE / "packages" / PACKAGES[package]
            generate(package, HERE / "packages" / package / "package.xml", definitions, generated)
            _configure(ext, package, generated)
            super().build_extension(ext)
            built_with.write_text(_ros_version())

    def _collect(self, package: str, generated: Path) -> None:
        """Python modules go into the package, `share/` goes to `<prefix>/share`."""
        modules = generated / "rosidl_generator_py" / package
        for path in sorted(modules.rglob("*.py")):
            target = Path(self.build_lib) / package / path.relative_to(modules)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)
        folders: dict[str, list[str]] = {}
        for path in sorted((generated / "share").rglob("*")):
            if path.is_file():
                folder = path.parent.relative_to(generated).as_posix()
                folders.setdefault(folder, []).append(str(path))
        self.distribution.data_files = [*(self.distribution.data_files or ()), *folders.items()]


def _inputs() -> list[Path]:
    """Everything that decides what is built; pyproject.toml holds the versions of ROS."""
    own = [path for path in HERE.rglob("*") if path.is_file() and path.suffix != ".pyc"]
    return [*own, HERE.parent / "pyproject.toml"]


def _ros_version() -> str:
    """Tells the ROS releases apart: environments of several share build/."""
    return version("ros-rosidl-generator-py")


def _is_newer(path: Path, than: list[Path]) -> bool:
    return path.exists() and path.stat().st_mtime > max(p.stat().st_mtime for p in than)


def _configure(ext: Extension, package: str, generated: Path) -> None:
    """Fill in sources, include paths and libraries."""
    import numpy

    prefix = ros_prefix()
    ext.sources = _unity_sources(generated)
    # its object file is a package's own: each is compiled with other names, side by side
    ext.sources.append(str(shutil.copyfile(HERE / "dispatch.c", generated / "dispatch.c")))
    ext.define_macros += [
        (
            f"rosidl_typesupport_c__get_{kind}_typesupport_handle_function",
            f"{package}__get_{kind}_typesupport_handle",
        )
        for kind in ("message", "service")
    ]
    ext.include_dirs += [
        *(str(path) for path in sorted(generated.glob("rosidl_*/"))),
        numpy.get_include(),
        str(prefix / "include"),  # those of Fast CDR
        *(str(path) for path in sorted((prefix / "include").iterdir()) if path.is_dir()),
    ]
    ext.library_dirs.append(str(prefix / "lib"))
    ext.libraries += [
        "rosidl_runtime_c",
        "rosidl_typesupport_c",
        "rosidl_typesupport_fastrtps_c",
        "rosidl_typesupport_fastrtps_cpp",
        "rosidl_typesupport_introspection_c",
        "fastcdr",
        "rmw",
        "rcutils",
        "dl",
        "stdc++",
    ]
    ext.libraries += [
        f"{dependency}__{library}"
        for dependency in DEPENDENCIES
        for library in (
            "rosidl_generator_c",
            "rosidl_generator_py",
            "rosidl_typesupport_c",
            "rosidl_typesupport_fastrtps_c",
            "rosidl_typesupport_introspection_c",
        )
    ]
    ext.extra_compile_args += ["-O1", "-g0", "-w"]
    # Python's own flags have -DNDEBUG. Without it a wrong type in a field aborts, as with the
    # packages of apt; with it the field silently holds garbage
    ext.extra_compile_args.append("-UNDEBUG")
    ext.extra_link_args += [
        "-Wl,--as-needed",
        "-s",
        # <prefix>/lib, seen from site-packages/<package>. As the older DT_RPATH, because the
        # libraries there have no path of their own and DT_RUNPATH would not hold for them
        "-Wl,--disable-new-dtags",
        "-Wl,-rpath,$ORIGIN/../../../../lib",
    ]


def _unity_sources(generated: Path) -> list[str]:
    """One C and one C++ file that include the others: compiles in a fifth of the time."""
    sources = []
    for suffix in (".c", ".cpp"):
        found = sorted(generated.rglob(f"*{suffix}"))
        # these define static variables of the same names
        alone = [path for path in found if path.stem.endswith("__description")]
        # not the same stem twice: both would become unity.o
        unity = generated / f"unity_{suffix[1:]}{suffix}"
        unity.write_text("".join(f'#include "{path}"\n' for path in found if path not in alone))
        sources += [unity, *alone]
    return [str(path) for path in sources]
