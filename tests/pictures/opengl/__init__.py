# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures by an OpenGL that is guaranteed, and by another one."""
