"""What a page was made of, by what, where and when."""

from __future__ import annotations

import platform
import shlex
import sys
from datetime import UTC, datetime
from hashlib import sha256
from html import escape
from importlib.metadata import version


def provenance(spec: str = "") -> str:
    """Line for the foot of a page.

    Parameters
    ----------
    spec : str, optional
        Text of the spec; its hash tells two specs apart, and is what ``sha256sum`` prints for the text.
    """
    told = [
        f"rthm {version('rthm_analysis')} on {platform.node()}, {datetime.now(UTC):%Y-%m-%d %H:%M} UTC",
        *([f"spec {sha256(spec.encode()).hexdigest()[:12]}"] if spec else []),
    ]
    command = escape(shlex.join([sys.argv[0].rpartition("/")[2], *sys.argv[1:]]))
    return f'<p class="provenance">{escape("; ".join(told))}; <code>{command}</code></p>'
