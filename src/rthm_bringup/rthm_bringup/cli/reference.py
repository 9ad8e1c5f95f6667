"""The reference page of the command line: ``python -m rthm_bringup.cli.reference FILE`` writes it."""

from __future__ import annotations

import sys
from pathlib import Path

from typer import Context
from typer.main import get_command

from rthm_bringup.cli.main import application

HELP_COLUMNS = 100
"""Columns of a help on the page."""

BEFORE = """# The command line

Every verb as `rthm VERB --help` shows it. Written by
`python -m rthm_bringup.cli.reference docs/reference/command-line.md`; a test keeps it true.

Exit status: 0, done; 1, the answer is no, as of a comparison out of tolerance; 2, bad input, and one
sentence says what, the value, what is allowed and the way out; 3, the test was aborted; 130, interrupted.
A shell completes verbs, options and specs after `rthm --install-completion`.
"""


def reference() -> str:
    """The page, in Markdown."""
    verbs = get_command(application())
    whole = Context(
        verbs,
        info_name="rthm",
        terminal_width=HELP_COLUMNS,
        max_content_width=HELP_COLUMNS,
        **verbs.context_settings,
    )
    parts = [BEFORE, f"## rthm\n\n```text\n{verbs.get_help(whole)}\n```\n"]
    for name, verb in sorted(verbs.commands.items()):  # type: ignore[attr-defined]
        own = verb.get_help(Context(verb, parent=whole, info_name=name))
        parts.append(f"## rthm {name}\n\n```text\n{own}\n```\n")
    return "\n".join(parts)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(reference(), encoding="utf-8")
