# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender with all that a window needs, in a Debian root folder of its own: the machine's system is not changed.

Mounts are made in a mount and process namespace that ends with the command that is run there, however that ends. So
neither mounts nor processes are left behind.
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
EXCLUDED = ("doc", "man", "locale")  # folders of /usr/share that are not installed


class Missing(Exception):
    """A Blender with a window cannot be installed or started here; the message says why."""


def command_in_root(root: Path, *command: str, folders: tuple[Path, ...] = ()) -> list[str]:
    """The command line that runs `command` in the root folder, where `folders` have the same paths as here."""
    namespace = ["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-ec", ENTER, "enter"]
    settings = [f"{name}={value}" for name, value in ENVIRONMENT.items()]
    return [*namespace, str(root), *map(str, folders), "--", "env", "--ignore-environment", *settings, *command]


def install(root: Path) -> None:
    """Make the root folder, if there is none: some minutes, a download of 350 MB, 1.6 GB on disk. Raises Missing."""
    if os.geteuid() != 0:
        raise Missing("a root folder with a Blender in it can be made and entered by root only")
    if not (root / "usr/bin/blender").exists():
        _install(root)
    _run(*command_in_root(root, "true"))


def _install(root: Path) -> None:
    print(f"installing Blender from Debian {SUITE} into {root}", flush=True)
    if shutil.which("debootstrap") is None:
        _run("apt-get", "-qq", "update")
        _run("apt-get", "-qq", "install", "--yes", "--no-install-recommends", "debootstrap")
    unfinished = root.with_name(f"{root.name}.half")
    shutil.rmtree(unfinished, ignore_errors=True)
    unfinished.parent.mkdir(parents=True, exist_ok=True)
    _run("debootstrap", "--variant=minbase", "--include=ca-certificates", SUITE, str(unfinished))
    _prepare(unfinished)
    _run(*command_in_root(unfinished, "apt-get", "-qq", "update"))
    _run(
        *command_in_root(unfinished, "apt-get", "-qq", "install", "--yes", "--no-install-recommends", *PACKAGES.split())
    )
    _run(*command_in_root(unfinished, "apt-get", "clean"))
    unfinished.rename(root)


def _prepare(root: Path) -> None:
    """Set up the network and certificates for Debian's installer; let it start no services and skip documentation."""
    shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")
    shutil.copy("/etc/ssl/certs/ca-certificates.crt", root / "etc/ssl/certs/ca-certificates.crt")
    policy = root / "usr/sbin/policy-rc.d"
    policy.write_text("#!/bin/sh\nexit 101\n")
    policy.chmod(0o755)
    slim = "".join(f"path-exclude=/usr/share/{name}/*\n" for name in EXCLUDED)
    (root / "etc/dpkg/dpkg.cfg.d/slim").write_text(slim)


def _run(*command: str) -> None:
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    if done.returncode:
        last_lines = " ".join(done.stdout.strip().splitlines()[-2:])
        name = next((word for word in command if word in ("debootstrap", "apt-get")), command[0])
        raise Missing(f"Blender could not be installed from Debian or started: {name} said: {last_lines}")
