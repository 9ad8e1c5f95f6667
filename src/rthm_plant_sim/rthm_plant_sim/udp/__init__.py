"""A device behind UDP, as a microcontroller: its packets, the host's side, the device's side, an emulation.

The host asks every Td1, the device answers with what its sensors read then. No clock is shared (docs/udp.md).
"""

from __future__ import annotations
