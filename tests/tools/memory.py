# SPDX-License-Identifier: GPL-3.0-or-later
"""How much memory this process has."""

from pathlib import Path


def resident() -> int:
    """Bytes in memory; 0 where the system does not say it in this way."""
    return _told("VmRSS")


def peak() -> int:
    """The most bytes in memory since the start or forget_peak; 0 where the system does not say it in this way."""
    return _told("VmHWM")


def reset_peak() -> None:
    """Count the peak from here on, on Linux."""
    if (reset := Path("/proc/self/clear_refs")).exists():
        reset.write_text("5")


def _told(name: str) -> int:
    status = Path("/proc/self/status")
    lines = status.read_text().splitlines() if status.exists() else []
    return next((int(line.split()[1]) * 1024 for line in lines if line.startswith(f"{name}:")), 0)
