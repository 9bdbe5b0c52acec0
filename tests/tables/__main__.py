# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the add-on's tables of glossy lobes anew, within a minute: python -m tests.tables"""

import numpy as np

from ism_addon.gpu.materials.lobe_tables import FILE
from tests.demo.figure6 import quiet_stdout
from tests.tables import albedo, ltc, sheen


def main() -> None:
    with quiet_stdout():  # of Cycles
        sheen_table = sheen.table()
    tables = {
        "ltc": ltc.table(),
        "albedo": albedo.albedo_table(),
        "mean_albedo": albedo.mean_albedo_table(),
        "dielectric": albedo.dielectric_table(),
        "schlick": albedo.schlick_table(),
        "glass": albedo.glass_table(),
        "mean_glass": albedo.mean_glass_table(),
        "sheen": sheen_table,
    }
    np.savez_compressed(FILE, **{name: np.asarray(table, np.float32) for name, table in tables.items()})


if __name__ == "__main__":
    main()
