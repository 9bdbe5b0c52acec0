# SPDX-License-Identifier: GPL-3.0-or-later
"""What sentences quote of a file: it may be as long as the file."""

#: Characters.
LONGEST = 80


def cut(text: str) -> str:
    """The text, or its beginning and its end if it is longer than sentences should be."""
    if len(text) <= LONGEST:
        return text
    end = LONGEST // 3
    return f"{text[: LONGEST - end - 1]}…{text[-end:]}"
