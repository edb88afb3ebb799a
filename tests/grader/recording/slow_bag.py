"""A bag as rosbags writes it, with what rosbag2 adds: one message after the other.

And types and messages as it reads them.
"""

from collections.abc import Mapping
from io import BytesIO

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter, write_channel, write_string
from rosbags.typesys import Stores, get_types_from_msg, get_typestore


class _Storage(McapWriter):
    def add_connection(self, connection, offered_qos_profiles):
        """Write a channel with the hash of its type."""
        records = self.chunk.bio
        begin = records.tell()
        super().add_connection(connection, offered_qos_profiles)
        more = BytesIO()
        write_string(more, "topic_type_hash")
        write_string(more, connection.digest)
        channel = self.channels.pop()
        channel = channel._replace(metadata=channel.metadata + more.getvalue())
        self.channels.append(channel)
        # A channel's record stands among the messages too, and may be there once only.
        records.seek(begin)
        records.truncate()
        write_channel(records, channel, self.schemas)

    def close(self, version, metadata):
        """Write the rest, the metadata too."""
        super().close(version, _with_distro(metadata))


class Rosbag2Writer(Writer):
    """Writes a bag into a new folder; a context manager, as rosbags' own."""

    STORAGE_PLUGINS: Mapping[StoragePlugin, type[McapWriter]] = {StoragePlugin.MCAP: _Storage}

    def __init__(self, folder):
        super().__init__(folder, version=9, storage_plugin=StoragePlugin.MCAP)
        # Chunks inside the file: 0.2 MB instead of 2 MB a run, and every reader of MCAP can
        # unpack it.
        self.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)

    def close(self):
        """Finish the bag; last comes metadata.yaml."""
        super().close()
        text = self.metapath.read_text(encoding="utf-8")
        whole = self.metapath.with_suffix(".yaml.tmp")
        whole.write_text(_with_distro(text), encoding="utf-8")
        whole.replace(self.metapath)


def _with_distro(metadata):
    return metadata.replace("ros_distro: rosbags", "ros_distro: jazzy")


def types_of(definitions):
    """Rosbags' types of definitions, as BagTypes are."""
    types = get_typestore(Stores.EMPTY)
    for msgtype, text in definitions.items():
        types.register(get_types_from_msg(text, msgtype))
    return types


def plain(value):
    """A message of rosbags', or a value of one, as plain data."""
    fields = getattr(value, "__dataclass_fields__", None)
    if fields is not None:
        return {n: plain(getattr(value, n)) for n in fields if n != "__msgtype__"}
    if hasattr(value, "tolist"):
        return value.tolist()
    return [plain(each) for each in value] if isinstance(value, list) else value
