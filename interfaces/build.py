"""Builds turtlesim-py-jazzy and turtlesim-py-kilted: what of ROS PyPI lacks, for its ROS.

The interface packages below `packages/`, one self-contained extension module each: generated,
compiled and linked against the ROS wheels of PyPI, by `grader.ros.building`. Where there is no
compiler, or the variable COMPILE is empty, their definitions alone (`grader.ros.uncompiled`).
And ../tf2, and what `ros2 run turtlesim ...` looks for. `<release>/pyproject.toml` says what is
required.

One distribution for all of a release: they are compiled together, for one rclpy, and nobody needs
one without the others. None of it may be where ROS is sourced, which has the same by these names.
"""

import os
import shutil
import sys
import tomllib
from importlib.metadata import version
from multiprocessing import get_context
from pathlib import Path

import setuptools
from setuptools import Extension
from setuptools.command.build_ext import build_ext
from setuptools.errors import CompileError

from grader.ros import building, compiler
from interfaces import ament

HERE = Path(__file__).resolve().parent
# Package -> the folder with its definitions. Those of turtlesim have two names: from ROS 2 Kilted
# on it is the second.
PACKAGES = {
    **{"turtlesim": "turtlesim", "turtlesim_msgs": "turtlesim", "tf2_msgs": "tf2_msgs"},
    **{name: name for name in ("example_interfaces", "action_tutorials_interfaces")},
}

# Packages whose types ours use.
DEPENDENCIES = (*building.ALWAYS_USED, "std_msgs", "geometry_msgs")
# What lies in ../tf2, by the names of ROS's own packages: not in a checkout's root, which may stand
# on Python's path and would hide them.
TF2 = ("tf2_py", "tf2_ros")
# Commands that build, or by which pip asks what building needs. It asks before it downloads
# anything; later the line about a sourced ROS would stand below hundreds of others.
BUILDING = {"egg_info", "dist_info", "bdist_wheel", "editable_wheel", "install", "build"}
# The ament index's list of packages of interfaces.
INTERFACES = "share/ament_index/resource_index/rosidl_interfaces"
# Names the ROS releases that PyPI's ROS is from here (turtlesim_py/ros/source.py), as a resource of
# the ament index.
BROUGHT = "share/ament_index/resource_index/turtlesim_py_ros"
# <prefix>/lib, seen from site-packages/<package>
LIBRARIES = "$ORIGIN/../../../../lib"

# ament_index finds packages below AMENT_PREFIX_PATH only, which nothing sets in a plain venv.
# Python runs this line at every start. Last in the list: a sourced workspace goes first.
AMENT_PREFIX_PTH = (
    "import os, sys; "
    "_p = [p for p in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep) if p]; "
    "sys.prefix in _p or os.environ.update(AMENT_PREFIX_PATH=os.pathsep.join([*_p, sys.prefix]))\n"
)


def setup() -> None:
    """Build what the folder of a release describes, which is the current one."""
    folder = Path.cwd()
    if BUILDING.intersection(sys.argv) and (release := os.environ.get("ROS_DISTRO")):
        sys.exit(
            f"Cannot install: ROS 2 {release} is sourced, and has all that is built here. "
            "Install the project alone, or take a shell without ROS."
        )
    ours = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))
    compiles = os.environ.get("COMPILE", "yes") and not compiler.missing()
    setuptools.setup(
        license="BSD-3-Clause AND Apache-2.0",
        setup_requires=ours["tool"]["turtlesim-py"]["build"] if compiles else [],
        ext_modules=extensions() if compiles else [],
        packages=[*TF2],
        package_dir={name: f"../../tf2/{name}" for name in TF2},
        data_files=[*data_files(folder.name), *(() if compiles else definitions())],
        include_package_data=False,
        distclass=ament.AmentDistribution,
        cmdclass={"build_py": BuildModules, "build_ext": BuildInterfaces},
        # what is compiled for one release of ROS is not for another
        options={"build": {"build_base": f"../../build/{folder.name}"}},
        zip_safe=False,
    )


def data_files(release: str) -> list[tuple[str, list[str]]]:
    """What `ros2 run` and `ros2 launch` look for in ROS's own packages, as tutorials have it."""
    nodes = [(Path(path).name, path) for path in ament.programs("grader_robots")]
    return [
        (BROUGHT, [f"ament_marker/{release}"]),
        # the second is that of example_interfaces and action_tutorials_interfaces
        (f"share/turtlesim-py-{release}", ["../../LICENSE", "../LICENSE-Apache-2.0"]),
        ("share/turtlesim/launch", ["../../launch/multisim.launch.py"]),
        ("lib/turtlesim", ament.programs("turtlesim_py")),
        *((ament.PACKAGES, [f"ament_marker/{name}"]) for name, _ in nodes),
        *((f"lib/{name}", [path]) for name, path in nodes),
    ]


def definitions() -> list[tuple[str, list[str]]]:
    """What of the packages is installed where they are not compiled."""
    files = []
    for name, source in PACKAGES.items():
        files += [(index, [f"ament_marker/{name}"]) for index in (ament.PACKAGES, INTERFACES)]
        packages = HERE / "packages"
        plain = [packages / name / "package.xml", *(packages / source).glob("LICENSE")]
        files.append((f"share/{name}", [*map(os.path.relpath, plain)]))
        for kind in building.KINDS:
            found = sorted((packages / source / kind).glob(f"*.{kind}"))
            files.append((f"share/{name}/{kind}", [*map(os.path.relpath, found)]))
    return files


def extensions() -> list[Extension]:
    """Return the argument of `setup(ext_modules=...)`, with the names that rclpy imports."""
    return [Extension(f"{name}.{name}_s__rosidl_typesupport_c", sources=[]) for name in PACKAGES]


class BuildModules(ament.BuildPy):
    """A `build_py` that adds the .pth file that makes the ament index work."""

    def run(self) -> None:
        super().run()
        Path(self.build_lib, "turtlesim_py_ament_prefix.pth").write_text(AMENT_PREFIX_PTH)


class BuildInterfaces(build_ext):
    """A `build_ext` that generates the sources first, and collects the files beside."""

    def build_extensions(self) -> None:
        """Build the packages in parallel, and collect their files.

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
        """Return the name of the package, and the folder of its generated files."""
        package = ext.name.split(".")[0]
        return package, (Path(self.build_temp) / "rosidl" / package).resolve()

    def build_extension(self, ext: Extension) -> None:
        """Generate and compile one package, unless nothing has changed."""
        package, generated = self._package(ext)
        module = Path(self.get_ext_fullpath(ext.name))
        built_with = generated / "built_with.txt"
        is_ours = built_with.exists() and built_with.read_text() == _ros_version()
        built_at = module.stat().st_mtime if module.exists() else 0.0
        if self.force or not is_ours or built_at <= max(p.stat().st_mtime for p in _inputs()):
            # no leftovers of interfaces that were renamed or removed
            shutil.rmtree(generated, ignore_errors=True)
            shutil.rmtree(Path(self.build_lib) / package, ignore_errors=True)
            packages = HERE / "packages"
            manifest = packages / package / "package.xml"
            building.generate(package, packages / PACKAGES[package], manifest, generated)
            building.configure(ext, generated, DEPENDENCIES, LIBRARIES, package)
            super().build_extension(ext)
            built_with.write_text(_ros_version())

    def _collect(self, package: str, generated: Path) -> None:
        """Copy Python modules into the package; `share/` goes to `<prefix>/share`."""
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
    """Return the inputs of the build; pyproject.toml has the versions of ROS."""
    sources = [path for path in (HERE / "packages").rglob("*") if path.is_file()]
    ours = (building.HERE / name for name in ("building.py", "dispatch.c"))
    return [*sources, *ours, Path(__file__), *HERE.glob("*/pyproject.toml")]


def _ros_version() -> str:
    """Return a version that differs between ROS releases, which may share build/."""
    return version("ros-rosidl-generator-py")
