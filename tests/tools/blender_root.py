# SPDX-License-Identifier: GPL-3.0-or-later
"""A real Blender with all that a window needs, in a Debian root folder of its own: nothing of the machine's changes.

Mounts are made in a mount and process namespace that ends with the command which is run there, however it ends: none
is ever left behind, and no process either.
"""

import os
import shutil
import subprocess
from pathlib import Path

SUITE = "trixie"  # Blender 4.3.2, Python 3.13
PACKAGES = "blender xvfb openbox imagemagick libgl1 libgl1-mesa-dri libglx-mesa0 libegl1 libegl-mesa0 python3-numpy"
#: Runs a command in the root folder, with folders of the machine under the same paths: ROOT [FOLDER …] -- command.
ENTER = """
root=$1; shift
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
while [ "$1" != -- ]; do mkdir -p "$root$1"; mount --bind "$1" "$root$1"; shift; done; shift
exec chroot "$root" "$@"
"""
ENVIRONMENT = {
    "HOME": "/root",  # kept: Blender's first start with an empty one takes a quarter of a minute longer
    "PATH": "/usr/sbin:/usr/bin:/sbin:/bin",
    "LIBGL_ALWAYS_SOFTWARE": "1",
    "DEBIAN_FRONTEND": "noninteractive",
}
WITHOUT = ("doc", "man", "locale")


class Missing(Exception):
    """What a Blender with a window needs cannot be had here; says why."""


def inside(root: Path, *command: str, folders: tuple[Path, ...] = ()) -> list[str]:
    """The command line that runs `command` in the root folder, where `folders` have the same paths as here."""
    namespace = ["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-ec", ENTER, "enter"]
    settings = [f"{name}={value}" for name, value in ENVIRONMENT.items()]
    return [*namespace, str(root), *map(str, folders), "--", "env", "--ignore-environment", *settings, *command]


def install(root: Path) -> None:
    """Make the root folder, if it is not there: some minutes, 350 MB to download, 1.6 GB on disk. Raises Missing."""
    if os.geteuid() != 0:
        raise Missing("a root folder with a Blender in it can be made and entered by root only")
    if not (root / "usr/bin/blender").exists():
        _install(root)
    _run(*inside(root, "true"))


def _install(root: Path) -> None:
    print(f"installing Blender from Debian {SUITE} into {root}", flush=True)
    if shutil.which("debootstrap") is None:
        _run("apt-get", "-qq", "update")
        _run("apt-get", "-qq", "install", "--yes", "--no-install-recommends", "debootstrap")
    half = root.with_name(f"{root.name}.half")
    shutil.rmtree(half, ignore_errors=True)
    half.parent.mkdir(parents=True, exist_ok=True)
    _run("debootstrap", "--variant=minbase", "--include=ca-certificates", SUITE, str(half))
    _prepare(half)
    _run(*inside(half, "apt-get", "-qq", "update"))
    _run(*inside(half, "apt-get", "-qq", "install", "--yes", "--no-install-recommends", *PACKAGES.split()))
    _run(*inside(half, "apt-get", "clean"))
    half.rename(root)


def _prepare(root: Path) -> None:
    """What Debian's installer needs to know: where the network is, to start no services, to leave out what few read."""
    shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")
    shutil.copy("/etc/ssl/certs/ca-certificates.crt", root / "etc/ssl/certs/ca-certificates.crt")
    policy = root / "usr/sbin/policy-rc.d"
    policy.write_text("#!/bin/sh\nexit 101\n")
    policy.chmod(0o755)
    slim = "".join(f"path-exclude=/usr/share/{part}/*\n" for part in WITHOUT)
    (root / "etc/dpkg/dpkg.cfg.d/slim").write_text(slim)


def _run(*command: str) -> None:
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    if done.returncode:
        last = " ".join(done.stdout.strip().splitlines()[-2:])
        name = next((word for word in command if word in ("debootstrap", "apt-get")), command[0])
        raise Missing(f"Blender could not be installed from Debian or started: {name} said: {last}")
