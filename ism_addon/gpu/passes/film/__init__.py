# SPDX-License-Identifier: GPL-3.0-or-later
"""From radiance to the image: composition, accumulation of samples, error estimation."""
