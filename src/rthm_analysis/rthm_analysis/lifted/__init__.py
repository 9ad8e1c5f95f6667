"""A loop lifted to one hyperperiod: exact, for clocks and delays of any length (``docs/theory.md``)."""
