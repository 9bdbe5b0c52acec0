# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: the groups of objects that a light is linked to, those it lights and those that cast its shadows."""

import bpy

from ...scene import MAX_LINK_GROUPS


class LightLinks:
    """Numbers groups, each known by what is in it, and says which an object belongs to."""

    def __init__(self) -> None:
        self._groups: dict[tuple[frozenset[int], bool], int] = {}

    def begin(self) -> None:
        """Before all lights are added."""
        self._groups.clear()

    def group(self, collection: bpy.types.Collection | None) -> int | None:
        """The number of the group that a linking collection stands for; -1: all objects. None if there are too many."""
        states: dict[str, set[int]] = {"INCLUDE": set(), "EXCLUDE": set()}
        if collection is not None:
            for link, thing in zip(collection.collection_objects, collection.objects, strict=True):
                states[link.light_linking.link_state].add(thing.original.session_uid)
            for link, child in zip(collection.collection_children, collection.children, strict=True):
                states[link.light_linking.link_state] |= {thing.original.session_uid for thing in child.all_objects}
        included, excluded = states.values()
        if not included and not excluded:
            return -1
        # Where nothing is included, all is but what is excluded.
        group = frozenset(included - excluded if included else excluded), bool(included)
        if group not in self._groups and len(self._groups) == MAX_LINK_GROUPS:
            return None
        return self._groups.setdefault(group, len(self._groups))

    def of(self, owners: tuple[int, ...]) -> int:
        """The groups, bit k for group k, of an object by its session_uid and that of what makes it stand.

        As in Cycles, the latter counts if no collection speaks of the object itself.
        """
        spoken_of = [owner for owner in owners if any(owner in members for members, _ in self._groups)]
        owner = (spoken_of or owners)[0]
        return sum(1 << k for (members, inside), k in self._groups.items() if (owner in members) == inside)
