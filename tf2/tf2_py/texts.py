"""What a buffer says: why it takes a transform not, and what it holds. tf2's words."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator

from .caches import Cache, seconds
from .geometry import Pose


def refusals(parent: str, child: str, pose: Pose, authority: str) -> Iterator[str]:
    """Everything for which a transform is not taken."""
    ignoring = "Ignoring transform for child_frame_id"
    no_rotation = any(math.isnan(number) for number in pose.rotation)
    if child == parent:
        yield (
            f'TF_SELF_TRANSFORM: Ignoring transform from authority "{authority}" with frame_id and '
            f' child_frame_id "{child}" because they are the same'
        )
    if not child:
        yield (
            f'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "{authority}" because '
            "child_frame_id not set "
        )
    if not parent:
        yield (
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  from authority '
            f'"{authority}" because frame_id not set'
        )
    if no_rotation or any(math.isnan(number) for number in pose.translation):
        yield (
            f'TF_NAN_INPUT: {ignoring} "{child}" from authority "{authority}" because of a nan '
            f"value in the transform ({_printed(pose.translation)}) ({_printed(pose.rotation)})"
        )
    if no_rotation:
        yield (
            f'TF_DENORMALIZED_QUATERNION: {ignoring} "{child}" from authority "{authority}" '
            f"because of an invalid quaternion in the transform ({_printed(pose.rotation)})"
        )


def _printed(numbers: tuple[float, ...]) -> str:
    """Numbers as C prints them by %f, the sign of NaN included."""
    texts = (f"{number:f}" for number in numbers)
    return " ".join(
        "-nan" if math.isnan(number) and math.copysign(1.0, number) < 0 else text
        for number, text in zip(numbers, texts, strict=True)
    )


def say(level: str, *texts: str) -> None:
    """Print as console_bridge does, but for the line that names a line of C++."""
    print(*(f"{level}{text}" for text in texts), sep="\n", file=sys.stderr, flush=True)


def entry(name: str, cache: Cache, authority: str) -> str:
    """What `all_frames_as_yaml` tells of one frame."""
    newest_ns, parent = cache.latest()
    oldest_ns = cache.oldest_ns()
    length_ns = newest_ns - oldest_ns
    return (
        f"{name}: \n"
        f"  parent: '{parent}'\n"
        f"  broadcaster: '{authority}'\n"
        f"  rate: {len(cache) * 1e9 / max(length_ns, 100_000):.3f}\n"
        f"  most_recent_transform: {seconds(newest_ns)}\n"
        f"  oldest_transform: {seconds(oldest_ns)}\n"
        f"  buffer_length: {length_ns * 1e-9:.3f}\n"
    )
