"""Find the storage files of a bag and read the raw messages of all of them."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import yaml

from rthm_analysis.recording import mcap_file, sqlite_file
from rthm_analysis.recording.raw import ZSTD_MAGIC, RawBag
from rthm_analysis.recording.unpacking import Allowance
from rthm_core.errors import InputError

_ENDINGS = (".mcap", ".db3", ".mcap.zstd", ".db3.zstd")


def read_raw(path: str | Path) -> RawBag:
    """Read the raw messages of a bag folder, or of one MCAP or SQLite file.

    Raises
    ------
    InputError
        There is no bag at `path`, or no message in it can be read.
    """
    bag = RawBag(Allowance(path))
    files = _storage_files(Path(path), bag)
    bag.allowance.grant(sum(_size(file) for file in files))
    for file in files:
        _read_file(file, bag)
    if not any(bag.topics.values()):
        reasons = " ".join(bag.notes)
        raise InputError(
            f"{path} holds no message that can be read: give a rosbag2 recording in MCAP or SQLite. {reasons}"
        )
    return bag


def _size(file: Path) -> int:
    try:
        return file.stat().st_size
    except OSError:
        return 0


def _storage_files(path: Path, bag: RawBag) -> list[Path]:
    try:
        if path.is_file():
            return [path]
        if path.is_dir():
            files = _listed_in_metadata(path, bag) or _found_in(path)
            if files:
                return files
            raise InputError(
                f"{path} is a folder without .mcap or .db3 files: give that of a rosbag2 recording."
            )
    except OSError as reason:
        raise InputError(
            f"{path} cannot be opened ({reason.strerror}): give a recording that you may read."
        ) from None
    raise InputError(f"{path} does not exist: give the folder of a rosbag2 recording, or its .mcap or .db3.")


def _listed_in_metadata(folder: Path, bag: RawBag) -> list[Path]:
    """Files in the order of metadata.yaml; none when that file is absent, incomplete or wrong."""
    metadata = folder / "metadata.yaml"
    if not metadata.exists():
        bag.note(f"{folder.name} has no metadata.yaml, as after a crash of its recorder: read without it.")
        return []
    try:
        content = yaml.safe_load(metadata.read_text(encoding="utf-8"))
        names = content["rosbag2_bagfile_information"]["relative_file_paths"]
        files = [folder / Path(name).name for name in names]
    except (yaml.YAMLError, UnicodeDecodeError, LookupError, TypeError, ValueError):
        bag.note(f"metadata.yaml of {folder.name} is damaged: its files were read without it.")
        return []
    missing = [file.name for file in files if not file.is_file()]
    if missing:
        bag.note(f"{folder.name} lacks the files {', '.join(missing)} that its metadata.yaml names.")
    return [file for file in files if file.is_file()]


def _found_in(folder: Path) -> list[Path]:
    """Storage files by number, as rosbag2 counts the parts of a long recording."""
    files = [file for file in folder.iterdir() if file.is_file() and file.name.endswith(_ENDINGS)]
    return sorted(files, key=lambda file: [part.zfill(20) for part in re.split(r"(\d+)", file.name)])


def _read_file(file: Path, bag: RawBag) -> None:
    """Read a file by its first bytes, which say what it is; its ending is only a name."""
    try:
        with file.open("rb") as stream:
            magic = stream.read(16)
        if magic.startswith(mcap_file.MAGIC):
            mcap_file.read_mcap(file, bag)
        elif magic.startswith(sqlite_file.MAGIC):
            sqlite_file.read_sqlite(file, bag)
        elif magic.startswith(ZSTD_MAGIC):
            _read_compressed(file, bag)
        else:
            bag.note(f"{file.name} is neither an MCAP nor an SQLite file.")
    except OSError as reason:
        bag.note(f"{file.name} cannot be read ({reason.strerror}).")


def _read_compressed(file: Path, bag: RawBag) -> None:
    """Read a file that rosbag2 compressed as a whole."""
    import zstandard

    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / file.name.removesuffix(".zstd")
        try:
            with file.open("rb") as packed, plain.open("wb") as unpacked:
                for piece in bag.allowance.zstd_pieces(packed):
                    unpacked.write(piece)
        except zstandard.ZstdError:
            bag.note(f"{file.name} is damaged: everything before the damage was read.")
        with plain.open("rb") as stream:
            nested = stream.read(4) == ZSTD_MAGIC
        if not nested:
            _read_file(plain, bag)
