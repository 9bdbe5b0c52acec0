# SPDX-License-Identifier: GPL-3.0-or-later
"""Links between the pages lead to existing files and headings, and every page and picture is linked."""

import re
from collections.abc import Iterator
from pathlib import Path

from tests.docs.generated import pages
from tests.tools import project

LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```$", re.M | re.S)
#: Names of the project's files in running text.
PATH = re.compile(r"`((?:ism_addon|tests|docs|build)/[\w./]+)`")
DOCUMENTS = [*pages(), project.ROOT / "CHANGELOG.md"]


def text(page: Path) -> str:
    """The page without code, whose brackets are no links."""
    return CODE.sub("", page.read_text("utf-8"))


def anchors(page: Path) -> set[str]:
    """The anchors that GitHub generates for the page's headings."""
    titles = re.findall(r"^#+ (.+)$", text(page), re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def links() -> Iterator[tuple[Path, str]]:
    """Each link within the project: the page and the target."""
    for page in DOCUMENTS:
        yield from ((page, target) for target in LINK.findall(text(page)) if "://" not in target)


def test_targets_of_links_exist():
    broken = []
    for page, target in links():
        name, _, anchor = target.partition("#")
        path = page.parent / name if name else page
        if not path.is_file() or (anchor and anchor not in anchors(path)):
            broken.append(f"{page.name}: {target}")
    assert broken == []


def test_every_page_and_picture_is_linked_to():
    linked = {(page.parent / target.partition("#")[0]).resolve() for page, target in links()}
    documents = [*(project.ROOT / "docs").glob("*.md"), *(project.ROOT / "docs" / "pictures").iterdir()]
    assert [path.name for path in documents if path.resolve() not in linked] == []


def test_files_that_pages_name_exist():
    missing = [
        f"{page.name}: {name}"
        for page in pages()
        for name in PATH.findall(text(page))
        if not name.startswith("build/") and not (project.ROOT / name).exists()
    ]
    assert missing == []
