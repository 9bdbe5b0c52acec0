# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light by imperfect shadow maps (Ritschel et al. 2008; Beck-Norén & Valter 2013)."""
