# SPDX-License-Identifier: GPL-3.0-or-later
"""Each module of the package by itself: folders are those of ism_addon, without gpu and passes."""
