# SPDX-License-Identifier: GPL-3.0-or-later
"""Random numbers of objects, as in Cycles: of instances those that Blender gives, of others hashes of their names."""

MASK = 0xFFFFFFFF
#: Start values of Jenkins' lookup3 for two numbers, and the rotations of its last step.
START = 0xDEADBEEF + (2 << 2) + 13
ROTATIONS = 14, 11, 25, 16, 4, 14, 24


def random_number(random_id: int | None, name: str) -> float:
    """A number in 0 to 1. `random_id`: Blender's, 32 bits with or without a sign; None if the object is no instance."""
    return ((name_hash(name) if random_id is None else random_id) & MASK) / MASK


def name_hash(name: str) -> int:
    """The hash of a name."""
    number = 0
    for byte in name.encode():
        number = (number * 37 + byte) & MASK
    a, b, c = (START + number) & MASK, START, START
    for bits in ROTATIONS:
        c = ((c ^ b) - ((b << bits | b >> (32 - bits)) & MASK)) & MASK
        a, b, c = b, c, a
    return b
