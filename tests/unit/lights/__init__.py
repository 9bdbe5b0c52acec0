# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of ism_addon/gpu/lights: irradiance and radiometry of lights, without occluders in most of them."""
