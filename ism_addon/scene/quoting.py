# SPDX-License-Identifier: GPL-3.0-or-later
"""Quotes of file contents in messages, which may be as long as the file."""

#: Maximum length of a quote, in characters.
MAX_LENGTH = 80


def shortened(text: str) -> str:
    """The text, or its beginning and end if it is longer than MAX_LENGTH."""
    if len(text) <= MAX_LENGTH:
        return text
    end = MAX_LENGTH // 3
    return f"{text[: MAX_LENGTH - end - 1]}…{text[-end:]}"
