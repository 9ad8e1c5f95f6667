"""From the recording of a hybrid test to insight: tables, energy, timing, report."""
