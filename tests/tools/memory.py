# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory of this process."""

from pathlib import Path


def resident() -> int:
    """Resident bytes; 0 on systems without /proc."""
    return _status_bytes("VmRSS")


def peak() -> int:
    """The most resident bytes since the start or `reset_peak`; 0 on systems without /proc."""
    return _status_bytes("VmHWM")


def reset_peak() -> None:
    """Measure the peak from now on, on Linux."""
    if (reset := Path("/proc/self/clear_refs")).exists():
        reset.write_text("5")


def _status_bytes(name: str) -> int:
    status = Path("/proc/self/status")
    lines = status.read_text().splitlines() if status.exists() else []
    return next((int(line.split()[1]) * 1024 for line in lines if line.startswith(f"{name}:")), 0)
