"""The messages of one topic of a bag, as columns: no object for each of thousands of messages."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Channel:
    """The n messages of a topic, in the order of the bag.

    Attributes:
        topic: its name.
        msgtype: their ROS type, as 'std_msgs/msg/String'.
        times_ns: of each, from the start of the run [ns], int64 (n,).
        places: where each stands among all messages of the bag, int64 (n,).
        data: the bytes of the bag, uint8 (m,).
        begins, ends: where in `data` the CDR of each is, int64 (n,).
    """

    topic: str
    msgtype: str
    times_ns: Ints
    places: Ints
    data: npt.NDArray[np.uint8]
    begins: Ints
    ends: Ints

    def messages(self) -> Iterator[bytes]:
        """Yield the CDR of each message."""
        for begin, end in zip(self.begins.tolist(), self.ends.tolist(), strict=True):
            yield self.data[begin:end].tobytes()

    def rows(self, layout: np.dtype[np.void]) -> npt.NDArray[Any]:
        """Return all messages of a type with a CDR of fixed length, as a structured array (n,).

        Args:
            layout: of one message, with all of its bytes.
        """
        sizes = self.ends - self.begins
        other = sizes[sizes != layout.itemsize]
        if len(other):
            expected = f"a {self.msgtype} has {layout.itemsize} bytes"
            raise ValueError(f"{self.topic}: {expected}, found {other[0]}")
        if not len(self):
            return np.empty(0, layout)
        windows = np.lib.stride_tricks.sliding_window_view(self.data, layout.itemsize)
        return windows[self.begins].view(layout)[:, 0]

    def __len__(self) -> int:
        return len(self.times_ns)
