# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of a world whose radiance varies: for samples of its directions, and its irradiance."""
