# SPDX-License-Identifier: GPL-3.0-or-later
"""What cannot be in view, cannot cast a shadow into it, or cannot be lit."""
