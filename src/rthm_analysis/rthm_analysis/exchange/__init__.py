"""Recordings from and to the files of other tools: CSV, MAT, Parquet, benchmark data."""

from rthm_analysis.exchange.columns import Columns
from rthm_analysis.exchange.exporting import export_bag
from rthm_analysis.exchange.importing import Imported, import_files
from rthm_analysis.exchange.mapping import Wanted, wanted

__all__ = ["Columns", "Imported", "Wanted", "export_bag", "import_files", "wanted"]
