"""A first spec from a recording that has none: names, timing, and numbers with how well they are known."""

from rthm_analysis.first_spec.draft import Draft
from rthm_analysis.first_spec.drafting import draft_of

__all__ = ["Draft", "draft_of"]
