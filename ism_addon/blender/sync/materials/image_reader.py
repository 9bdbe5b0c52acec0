# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the images of nodes on first use. The index of an image never changes while any shader uses it."""

from collections.abc import Callable
from typing import NamedTuple

import bpy
import numpy as np

from ....scene import Image
from ..diagnostics import Diagnostics
from . import images

#: Sources of images that Blender makes again when it needs them after they were freed.
DECODED_AGAIN = {"FILE", "GENERATED", "TILED"}


class ImageKey(NamedTuple):
    """What makes two images of a scene different."""

    session_uid: int
    repeat: bool
    on_black: bool
    path: str  # of the file of a sequence's frame, or ""


class ImageReader:
    """All images of a scene."""

    def __init__(self, frees_buffers: bool = False) -> None:
        """With `frees_buffers`, images that Blender decodes for this reader are freed in Blender after it."""
        self._frees_buffers = frees_buffers
        #: Functions that give the indices of images in use.
        self.users: list[Callable[[], frozenset[int]]] = []
        self._read: dict[ImageKey, tuple[int, Diagnostics]] = {}
        self._images: list[Image] = []
        #: Images by the same keys, with their origin: they are read again only if that has changed.
        self._cache: dict[ImageKey, tuple[tuple, Image]] = {}
        self._mean_texels: dict[int, tuple[Image, np.ndarray]] = {}

    def forget(self) -> None:
        """Some image has changed: read all again when they are next requested."""
        if self._read:  # otherwise nothing has been read since the last call
            self._cache = {key: cached for key, cached in self._cache.items() if key in self._read}
        self._read.clear()
        self._images.clear()

    def images(self) -> tuple[Image, ...]:
        """The images that indices refer to."""
        return tuple(self._images)

    def index_of(
        self, image: bpy.types.Image, user: bpy.types.ImageUser, repeat: bool, on_black: bool
    ) -> tuple[int, Diagnostics]:
        """The index of an image, or -1 if it cannot be read; and its issues. `on_black`: see images.read."""
        path = image.filepath_from_user(image_user=user) if image.source == "SEQUENCE" else ""
        key = ImageKey(image.original.session_uid, repeat, on_black, path)
        if key not in self._read:
            self._read[key] = self._read_image(key, image)
        return self._read[key]

    def index_of_made(self, name: str, make: Callable[[], Image]) -> int:
        """The index of an image that no file has: made on first use, while any shader uses that of its name."""
        key = ImageKey(0, True, True, name)
        if key not in self._read:
            index, image = self._free_index(), make()
            self._images[index:] = [image, *self._images[index + 1 :]]
            self._read[key] = index, Diagnostics()
        return self._read[key][0]

    def mean_texel(self, index: int) -> np.ndarray:
        """(4,) mean of an image's linear colour and alpha; computed once."""
        image = self._images[index]
        if index not in self._mean_texels or self._mean_texels[index][0] is not image:
            self._mean_texels[index] = image, images.mean_texel(image)
        return self._mean_texels[index][1]

    def _read_image(self, key: ImageKey, image: bpy.types.Image) -> tuple[int, Diagnostics]:
        findings = Diagnostics()
        loaded = self._load(key, image)
        if loaded is None:
            findings.warn("Images that are missing or cannot be read are magenta, as in Blender", image.name)
            return -1, findings
        if not images.is_known_space(image, loaded.encoding):
            findings.warn("Images in a colour space that is not known are taken for sRGB", image.name)
        if image.source == "TILED":
            findings.warn("Of tiled images one tile is drawn", image.name)
        if image.source == "MOVIE":
            findings.warn("Of movies one frame is drawn", image.name)
        index = self._free_index()
        self._images[index:] = [loaded, *self._images[index + 1 :]]
        return index, findings

    def _free_index(self) -> int:
        """The index of a frame of an image sequence that no shader uses any more; otherwise a new index."""
        used = frozenset[int]().union(*(user() for user in self.users))
        for key, (index, _) in self._read.items():
            if key.path and index >= 0 and index not in used:
                del self._read[key]
                return index
        return len(self._images)

    def _load(self, key: ImageKey, image: bpy.types.Image) -> Image | None:
        """An image: the one read last time, if the origin is the same."""
        origin, cached = images.origin(image.original), self._cache.pop(key, None)
        if cached is not None and origin is not None and cached[0] == origin:
            loaded: Image | None = cached[1]
        else:
            was_decoded = image.has_data
            if key.path:
                loaded = images.read_frame(image, key.path, key.repeat, key.on_black)
            else:
                loaded = images.read(image, key.repeat, key.on_black)
            if self._frees_buffers and not was_decoded and image.source in DECODED_AGAIN:
                image.buffers_free()
        if loaded is not None and origin is not None:
            self._cache[key] = origin, loaded
        return loaded
