# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's manifest: valid for Blender's own tool, and consistent with the code."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import bpy
import pytest

from ism_addon.settings import Settings
from tests.tools import project

MANIFEST = tomllib.loads((project.ROOT / "blender_manifest.toml").read_text("utf-8"))

#: Permissions, and patterns of code that needs them.
NEEDS = {
    "files": r"\batomic_write\(|\.images\.load\(",
    "network": r"^\s*(?:import|from) (?:socket|ssl|http|urllib|requests|ftplib|smtplib)\b",
    "clipboard": r"\.clipboard\b",
    "camera": r"\bVideoTexture\b|^\s*import cv2\b",
    "microphone": r"\baud\b",
}


def extension_tool() -> list[str]:
    """Blender's command line for extensions."""
    if bpy.app.binary_path:
        return [bpy.app.binary_path, "--command", "extension"]
    scripts = Path(bpy.utils.system_resource("SCRIPTS"))
    return [sys.executable, str(scripts / "addons_core/bl_pkg/cli/blender_ext.py")]


def validate(folder: Path) -> subprocess.CompletedProcess:
    return subprocess.run([*extension_tool(), "validate", str(folder)], capture_output=True, text=True, timeout=120)


def test_blenders_tool_accepts_the_manifest():
    run = validate(project.ROOT)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "error" not in (run.stdout + run.stderr).lower()


def test_blenders_tool_rejects_a_long_reason(tmp_path):
    text = (project.ROOT / "blender_manifest.toml").read_text("utf-8")
    (tmp_path / "blender_manifest.toml").write_text(text.replace('files = "', 'files = "Again and again, '), "utf-8")
    assert validate(tmp_path).returncode != 0


def test_it_names_website_copyright_maintainer_and_license():
    assert all(MANIFEST[name] for name in ("website", "copyright", "maintainer", "license"))


def test_the_tagline_names_the_default_method():
    assert Settings().shadow.method.label.lower() in MANIFEST["tagline"].lower()


@pytest.mark.parametrize("permission", NEEDS)
def test_it_requests_exactly_the_permissions_that_the_code_needs(permission):
    sources = [path.read_text("utf-8") for path in (project.ROOT / "ism_addon").rglob("*.py")]
    used = any(re.search(NEEDS[permission], source, re.M) for source in sources)
    assert used == (permission in MANIFEST["permissions"])
