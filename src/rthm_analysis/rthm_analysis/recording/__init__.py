"""Recordings: read any bag of a hybrid test into tables with units."""

from rthm_analysis.recording.nominal import nominal_spec, with_spec
from rthm_analysis.recording.reading import read_recording
from rthm_analysis.recording.recording import Recording
from rthm_analysis.recording.table import LinkTable, Table, hold, rows_of

__all__ = [
    "LinkTable",
    "Recording",
    "Table",
    "hold",
    "nominal_spec",
    "read_recording",
    "rows_of",
    "with_spec",
]
