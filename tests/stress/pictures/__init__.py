# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of extreme scenes, against closed forms, reference images, Cycles and each other."""
