# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a Python module in Blender's own Python: `blender -b -P inside_blender.py -- PACKAGES MODULE arguments`."""

import runpy
import sys
from pathlib import Path

packages, module, *arguments = sys.argv[sys.argv.index("--") + 1 :]
sys.path[:0] = [str(Path(__file__).parents[2]), packages]
sys.argv = [module, *arguments]
runpy.run_module(module, run_name="__main__", alter_sys=True)
