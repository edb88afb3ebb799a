"""A robot as its URDF describes it: links, joints, shapes, as plain data.

Lengths are in metres, angles in radians, masses in kilograms. What the file leaves out has the
value that urdfdom gives it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

Vector = tuple[float, float, float]
Colour = tuple[float, float, float, float]

BLACK: Colour = (0.0, 0.0, 0.0, 1.0)


class JointType(StrEnum):
    """How a joint lets its child move."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"
    FLOATING = "floating"
    PLANAR = "planar"

    @property
    def is_movable(self) -> bool:
        """Whether one number is its position; ROS moves no planar and no floating one."""
        return self in (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)


@dataclass(frozen=True, slots=True)
class Origin:
    """Where something is [m], turned about fixed axes by roll, then pitch, then yaw [rad]."""

    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Material:
    """A colour, red, green, blue, alpha from 0 to 1, or a texture's file, or both.

    A texture alone leaves the colour at urdfdom's default, black.
    """

    name: str
    rgba: Colour = BLACK
    texture: str = ""


@dataclass(frozen=True, slots=True)
class Box:
    """A box round its origin, with its size along x, y, z [m]."""

    size: Vector


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder round its origin, along z [m]."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class Sphere:
    """A ball round its origin [m]."""

    radius: float


@dataclass(frozen=True, slots=True)
class Mesh:
    """A file of triangles, as the URDF names it (`package://...`), and its scale."""

    filename: str
    scale: Vector = (1.0, 1.0, 1.0)


Geometry = Box | Cylinder | Sphere | Mesh


@dataclass(frozen=True, slots=True)
class Visual:
    """A shape to show; the material is None where none is named, or there is none of that name."""

    origin: Origin
    geometry: Geometry
    material: Material | None = None


@dataclass(frozen=True, slots=True)
class Collision:
    """Where a link bumps into others."""

    origin: Origin
    geometry: Geometry


@dataclass(frozen=True, slots=True)
class Inertial:
    """How a link resists: its centre of mass, mass [kg] and moments about it [kg m²]."""

    origin: Origin
    mass: float
    ixx: float
    ixy: float
    ixz: float
    iyy: float
    iyz: float
    izz: float


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid part of the robot, in whose frame its shapes lie."""

    name: str
    visuals: tuple[Visual, ...] = ()
    collisions: tuple[Collision, ...] = ()
    inertial: Inertial | None = None


@dataclass(frozen=True, slots=True)
class Limit:
    """How far, how hard and how fast a joint goes [rad or m; N m or N; per second]."""

    lower: float
    upper: float
    effort: float
    velocity: float


@dataclass(frozen=True, slots=True)
class Mimic:
    """It follows another joint: multiplier · its position + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True)
class Joint:
    """How a child link hangs on its parent.

    Attributes:
        origin: of the child's frame in the parent's, while the joint's position is 0.
        axis: in the child's frame, of any length; (0, 0, 0) for fixed and floating joints.
    """

    name: str
    type: JointType
    parent: str
    child: str
    origin: Origin = Origin()
    axis: Vector = (0.0, 0.0, 0.0)
    limit: Limit | None = None
    mimic: Mimic | None = None


@dataclass(frozen=True, slots=True)
class Model:
    """A robot that urdfdom accepts: `links` and `joints` by name, in the order of the file.

    Exactly one link, `root`, is no joint's child. Nothing else is sure: a link may be the child of
    two joints, and links may go round in a circle. `kinematics.tree` finds the parent of each link.
    """

    name: str
    root: str
    links: Mapping[str, Link]
    joints: Mapping[str, Joint]
