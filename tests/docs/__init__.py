# SPDX-License-Identifier: GPL-3.0-or-later
"""Generators of parts of the documentation, and parsers of its commands and of the code's messages, for tests."""
