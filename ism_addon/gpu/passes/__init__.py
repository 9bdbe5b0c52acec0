# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps of a sample, a folder for each stage. A pass and its shaders lie side by side."""
