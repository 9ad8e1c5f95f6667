"""Write a rosbag2 recording (MCAP) that a crash cannot take away.

Messages go to the file in small chunks, and `BagWriter.flush` hands all of them to the operating system: a
writer that is killed loses what came after the last flush, no more. ``log_time`` is when a message was
received, ``publish_time`` when its source sent it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

from mcap.writer import CompressionType, Writer

from rthm_analysis.recording.metadata import Summary, Topic, definition, qos_text
from rthm_core.errors import InputError

CHUNK = 24 * 1024
SEQUENCE_MASK = 0xFFFF_FFFF  # an MCAP sequence has 32 bits


class BagWriter:
    """One bag: a folder with one MCAP file, and ``metadata.yaml`` once it is closed.

    Parameters
    ----------
    folder
        Made by the writer; it must not exist, or be empty.

    Raises
    ------
    InputError
        The folder cannot be written, or the disk is full; from every method.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.custom: dict[str, str] = {}
        self._topics: dict[str, Topic] = {}
        self._schemas: dict[str, int] = {}
        self._first: int | None = None
        self._last = 0
        self._stream = _opened(self.folder)
        self._writer = Writer(self._stream, chunk_size=CHUNK, compression=CompressionType.NONE)
        with _one_sentence(self.folder):
            self._writer.start(profile="ros2", library="rthm")

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def counts(self) -> dict[str, int]:
        """Messages written so far, per topic."""
        return {topic.name: topic.count for topic in self._topics.values()}

    def add_topic(self, name: str, type_name: str, depth: int = 10, latched: bool = False) -> None:
        """Announce a topic; without it the first message does, with the usual quality of service."""
        if name in self._topics:
            return
        topic = Topic(name, type_name, depth, latched)
        metadata = {"offered_qos_profiles": qos_text(topic), "topic_type_hash": definition(type_name)[1]}
        with _one_sentence(self.folder):
            topic.channel = self._writer.register_channel(name, "cdr", self._schema(type_name), metadata)
        self._topics[name] = topic

    def write(
        self,
        topic: str,
        type_name: str,
        data: bytes,
        log_time: int,
        publish_time: int,
        sequence: int | None = None,
    ) -> None:
        """Append one message.

        Parameters
        ----------
        topic, type_name
            As ``/rthm/plant/state`` and ``sensor_msgs/msg/JointState``.
        data
            Serialised message (CDR).
        log_time, publish_time
            When it was received and sent, ns.
        sequence
            Number of the message at its publisher; by default counted here, from 1.
        """
        if topic not in self._topics:
            self.add_topic(topic, type_name)
        entry = self._topics[topic]
        entry.sequence = entry.sequence + 1 if sequence is None else sequence
        entry.count += 1
        self._first = log_time if self._first is None else min(self._first, log_time)
        self._last = max(self._last, log_time)
        try:
            self._writer.add_message(
                entry.channel, log_time, data, publish_time, entry.sequence & SEQUENCE_MASK
            )
        except OSError as error:
            raise _failure(self.folder, error) from error

    def flush(self) -> None:
        """Hand everything written so far to the operating system."""
        with _one_sentence(self.folder):
            self._writer.flush()

    def close(self) -> None:
        """Write the index of the file and ``metadata.yaml``; a second call does nothing."""
        if self._stream.closed:
            return
        summary = Summary(
            self._stream_path.name, list(self._topics.values()), self._first or 0, self._last, self.custom
        )
        try:
            self._writer.add_metadata("rosbag2", {"serialized_metadata": summary.as_yaml(root=False)})
            self._writer.finish()
            self._stream.close()
            (self.folder / "metadata.yaml").write_text(summary.as_yaml(root=True))
        except OSError as error:
            _abandon(self._stream)
            raise _failure(self.folder, error) from error

    @property
    def _stream_path(self) -> Path:
        return Path(self._stream.name)

    def _schema(self, type_name: str) -> int:
        if type_name not in self._schemas:
            text = definition(type_name)[0]
            self._schemas[type_name] = self._writer.register_schema(type_name, "ros2msg", text.encode())
        return self._schemas[type_name]


def _opened(folder: Path) -> BinaryIO:
    with _one_sentence(folder):
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise InputError(
                f"{folder} is not empty, and a recording is never overwritten; name another folder."
            )
        return (folder / f"{folder.name}_0.mcap").open("xb")


def _abandon(stream: BinaryIO) -> None:
    """Close a stream whose last bytes have no place to go."""
    try:
        stream.close()
    except OSError:
        return


@contextmanager
def _one_sentence(folder: Path) -> Iterator[None]:
    """Tell in a sentence that a folder cannot be written."""
    try:
        yield
    except OSError as error:
        raise _failure(folder, error) from error


def _failure(folder: Path, error: OSError) -> InputError:
    reason = (error.strerror or str(error)).lower()
    return InputError(
        f"The recording cannot be written to {folder} ({reason}); make room or name another folder."
    )
