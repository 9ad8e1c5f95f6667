"""Raw messages of a rosbag2 SQLite file, whole or damaged."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

from rthm_analysis.recording.raw import RawBag, RawTopic

MAGIC = b"SQLite format 3\x00"


def read_sqlite(path: Path, bag: RawBag) -> None:
    """Add the messages of the file to `bag`; what a damaged file still gives is taken, with a note."""
    try:
        with closing(_opened(path)) as database:
            topics = _topics(database, bag)
            rows = database.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY id")
            for number, received_ns, payload in rows:
                topic = topics.get(number)
                if topic is not None and isinstance(received_ns, int) and isinstance(payload, bytes):
                    topic.append(received_ns, payload)
    except (sqlite3.Error, OverflowError, UnicodeDecodeError) as reason:
        bag.note(f"{path.name} is damaged ({reason}): everything before the damage was read.")


def _opened(path: Path) -> sqlite3.Connection:
    """Open without writing: an unfinished journal on a read-only medium is left aside."""
    where = path.absolute().as_uri()
    database = sqlite3.connect(f"{where}?mode=ro", uri=True)
    try:
        database.execute("SELECT count(*) FROM topics").fetchone()
    except sqlite3.OperationalError:
        database.close()
        database = sqlite3.connect(f"{where}?mode=ro&immutable=1", uri=True)
    return database


def _topics(database: sqlite3.Connection, bag: RawBag) -> dict[int, RawTopic]:
    topics = {}
    rows = database.execute("SELECT id, name, type, serialization_format FROM topics")
    for number, name, message_type, encoding in rows:
        if encoding == "cdr":
            topics[number] = bag.topic(str(name), str(message_type))
        else:
            bag.note(f"{name} is encoded as {encoding!r}, not as CDR: left out.")
    return topics
