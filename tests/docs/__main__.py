# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the generated parts of README.md and docs: python -m tests.docs --records FOLDER [NAME …]"""

import argparse
import sys
from pathlib import Path

from tests.tools import project

from . import generated, record


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.docs", description="Write the documentation's generated parts.")
    parser.add_argument("names", nargs="*", help="benchmarks whose new records are first copied to docs/records")
    parser.add_argument("--records", type=Path, required=True, help="folder that the benchmarks wrote to")
    options = parser.parse_args()
    for name in options.names:
        path = options.records / f"{name}.json"
        if not path.exists():
            parser.error(f"there is no {path}: run python3 dev.py bench {name}")
        record.keep(path)
    for path in generated.write():
        print(path.relative_to(project.ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())
