# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the version of moderngl, which all of Blender's add-ons share.

The extension includes it as a wheel. But Blender keeps only the newest of several extensions' wheels, and another
add-on may have imported a different copy before.
"""

import re

from .errors import NoOpenGL

#: The oldest supported version, and the next major version, which is not supported. 5.9 lacks functions that we call.
OLDEST, NEXT_MAJOR = (5, 10), (6, 0)


def check() -> None:
    """Raises NoOpenGL for an unsupported version; ImportError or OSError if it is missing or broken."""
    import moderngl

    version = str(getattr(moderngl, "__version__", "without a version"))
    number = re.match(r"(\d+)\.(\d+)", version)
    if number is None or not OLDEST <= (int(number[1]), int(number[2])) < NEXT_MAJOR:
        raise NoOpenGL(
            f"Another add-on has brought moderngl {version} ({moderngl.__file__}), and this engine needs "
            f"{'.'.join(map(str, OLDEST))} or a later {OLDEST[0]}: disable that add-on and start Blender again"
        )
