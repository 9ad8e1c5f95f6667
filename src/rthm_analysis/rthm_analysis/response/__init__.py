"""Frequency response of a loop, with and without its sampling (``docs/theory.md``)."""

from rthm_analysis.response.result import WAYS, Response, response

__all__ = ["WAYS", "Response", "response"]
