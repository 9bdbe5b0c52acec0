# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the moderngl that Python finds is one that we can use: all of Blender's add-ons share it.

The extension brings one in a wheel. But of two extensions' wheels Blender keeps the newer one, and an add-on may have
loaded a copy of its own before.
"""

import re

from .errors import NoOpenGL

#: The versions that do, from the first one on and below the second one. 5.9 lacks calls that we make, 5.10 draws.
OLDEST, NEXT_MAJOR = (5, 10), (6, 0)


def check() -> None:
    """Raises NoOpenGL for another version; ImportError and OSError where there is none, or it is broken."""
    import moderngl

    version = str(getattr(moderngl, "__version__", "without a version"))
    number = re.match(r"(\d+)\.(\d+)", version)
    if number is None or not OLDEST <= (int(number[1]), int(number[2])) < NEXT_MAJOR:
        raise NoOpenGL(
            f"Another add-on has brought moderngl {version} ({moderngl.__file__}), and this engine needs "
            f"{'.'.join(map(str, OLDEST))} or a later {OLDEST[0]}: disable that add-on and start Blender again"
        )
