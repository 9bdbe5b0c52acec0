# SPDX-License-Identifier: GPL-3.0-or-later
"""Unit tests of single modules. The folders are those of ism_addon, without gpu and passes."""
