# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: groups of objects that lights are linked to, as receivers or as shadow blockers."""

import bpy

from ...scene import MAX_LINK_GROUPS
from .diagnostics import Diagnostics


def warn_of_many_groups(findings: Diagnostics, name: str) -> None:
    """Warn that a light cannot be linked."""
    findings.warn(f"Lights are linked to no more than {MAX_LINK_GROUPS} groups, others are not linked", name)


class LightLinks:
    """Assigns indices to groups by their members, and finds the groups of an object."""

    def __init__(self) -> None:
        self._groups: dict[tuple[frozenset[int], bool], int] = {}

    def reset(self) -> None:
        """To be called before all lights and instances are added."""
        self._groups.clear()

    def of_light(self, owners: tuple[bpy.types.Object, ...], role: str) -> int | None:
        """The group of the receivers or blockers of a light or emissive object, `owners` also has its instancer.

        As in Cycles, the instancer counts if the object itself is linked to no collection. As for `group`.
        """
        for owner in owners:
            collection = getattr(owner.light_linking, f"{role}_collection")
            if collection is not None:
                return self.group(collection)
        return -1

    def group(self, collection: bpy.types.Collection | None) -> int | None:
        """The index of a linking collection's group; -1: all objects. None if there are too many groups."""
        states: dict[str, set[int]] = {"INCLUDE": set(), "EXCLUDE": set()}
        if collection is not None:
            for link, source in zip(collection.collection_objects, collection.objects, strict=True):
                states[link.light_linking.link_state].add(source.original.session_uid)
            for link, child in zip(collection.collection_children, collection.children, strict=True):
                states[link.light_linking.link_state] |= {source.original.session_uid for source in child.all_objects}
        included, excluded = states.values()
        if not included and not excluded:
            return -1
        # Without inclusions, all objects are included except the excluded ones.
        group = frozenset(included - excluded if included else excluded), bool(included)
        if group not in self._groups and len(self._groups) == MAX_LINK_GROUPS:
            return None
        return self._groups.setdefault(group, len(self._groups))

    def of(self, owners: tuple[int, ...]) -> int:
        """The groups, bit k for group k, of an object by its session_uid and that of its instancer.

        As in Cycles, the instancer counts if no collection contains the object itself.
        """
        linked = [owner for owner in owners if any(owner in members for members, _ in self._groups)]
        owner = (linked or owners)[0]
        return sum(1 << k for (members, inside), k in self._groups.items() if (owner in members) == inside)
