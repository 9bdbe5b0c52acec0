# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against time: this engine beside Cycles and EEVEE, on scenes whose truth is Cycles' direct light."""
