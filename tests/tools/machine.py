# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds and installs the libraries and programs that a bare Debian lacks for bpy and for OpenGL without a screen."""

import ctypes
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

#: Libraries that bpy (4.2 to 5.2) links and moderngl opens, to Debian's packages. Their dependencies are not listed.
LIBRARIES = {
    "libEGL.so.1": "libegl1",
    "libEGL_mesa.so.0": "libegl-mesa0",
    "libGL.so.1": "libgl1",
    "libSM.so.6": "libsm6",
    "libX11.so.6": "libx11-6",
    "libXfixes.so.3": "libxfixes3",
    "libXi.so.6": "libxi6",
    "libXrender.so.1": "libxrender1",
    "libXxf86vm.so.1": "libxxf86vm1",
    "libgomp.so.1": "libgomp1",
    "libxkbcommon.so.0": "libxkbcommon0",
}
#: Programs to Debian's packages, where the names differ.
PACKAGES = {"glslangValidator": "glslang-tools", "lavapipe": "mesa-vulkan-drivers"}
#: The folder of descriptions of Vulkan drivers.
VULKAN_DRIVERS = Path("/usr/share/vulkan/icd.d")


def prepare(*programs: str) -> None:
    """Install missing libraries and these programs ("lavapipe" may be one), or exit with the command that does."""
    missing = missing_packages(*programs)
    if not missing:
        return
    names = " ".join(missing)
    if shutil.which("apt-get") is None:
        sys.exit(f"This machine lacks what Debian has in these packages: {names}. Install them and try again.")
    if os.geteuid() != 0:
        command = f"apt-get update && apt-get install --no-install-recommends {names}"
        sys.exit(f"Some of Debian's packages are missing. Type this, and try again:\n\n    sudo sh -c '{command}'\n")
    print(f"installing from Debian: {names}", flush=True)
    _apt("update")
    _apt("install", "--yes", "--no-install-recommends", *missing)
    if still_missing := missing_packages(*programs):
        sys.exit(
            f"Debian's packages are installed, but still missing is what they should bring: {' '.join(still_missing)}"
        )


def missing_packages(*programs: str) -> list[str]:
    """Debian's packages that have to be installed, sorted; none on systems other than Linux."""
    if not sys.platform.startswith("linux"):
        return []
    missing = {package for library, package in LIBRARIES.items() if not _is_loadable(library)}
    if importlib.util.find_spec("ensurepip") is None:
        missing.add(f"python{sys.version_info.major}.{sys.version_info.minor}-venv")
    missing |= {PACKAGES.get(program, program) for program in programs if not _is_installed(program)}
    return sorted(missing)


def lavapipe() -> list[Path]:
    """Descriptions of Mesa's Vulkan driver for CPUs, one for each CPU architecture; none if it is missing."""
    return sorted(VULKAN_DRIVERS.glob("lvp_icd*.json"))


def _is_installed(program: str) -> bool:
    return bool(lavapipe() if program == "lavapipe" else shutil.which(program))


def _is_loadable(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def _apt(*arguments: str) -> None:
    done = subprocess.run(
        ["apt-get", "-qq", *arguments],
        env={**os.environ, "DEBIAN_FRONTEND": "noninteractive"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode:
        sys.exit(f"apt-get {arguments[0]} failed:\n{done.stdout}")
