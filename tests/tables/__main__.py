# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the add-on's tables of glossy lobes anew, within a minute: python -m tests.tables"""

import numpy as np

from ism_addon.gpu.materials.lobe_tables import FILE
from tests.tables import albedo, ltc


def main() -> None:
    tables = {
        "ltc": ltc.table(),
        "albedo": albedo.albedo_table(),
        "mean_albedo": albedo.mean_albedo_table(),
        "dielectric": albedo.dielectric_table(),
        "schlick": albedo.schlick_table(),
    }
    np.savez_compressed(FILE, **{name: np.asarray(table, np.float32) for name, table in tables.items()})


if __name__ == "__main__":
    main()
