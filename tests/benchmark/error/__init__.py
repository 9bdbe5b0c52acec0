# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against time for this engine, Cycles and EEVEE. The reference is the direct light that Cycles renders."""
