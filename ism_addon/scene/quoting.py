# SPDX-License-Identifier: GPL-3.0-or-later
"""What sentences quote of a file: it may be as long as the file."""

#: Characters.
MAX_LENGTH = 80


def shortened(text: str) -> str:
    """The text, or its beginning and its end if it is longer than sentences should be."""
    if len(text) <= MAX_LENGTH:
        return text
    end = MAX_LENGTH // 3
    return f"{text[: MAX_LENGTH - end - 1]}…{text[-end:]}"
