# SPDX-License-Identifier: GPL-3.0-or-later
"""Links between the pages lead to files and headings that are there, and every page and picture is reached."""

import re
from collections.abc import Iterator
from pathlib import Path

from tests.docs.generated import pages
from tests.tools import project

LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```$", re.M | re.S)
#: What names a file of the project in running text.
PATH = re.compile(r"`((?:ism_addon|tests|docs|build)/[\w./]+)`")
DOCUMENTS = [*pages(), project.ROOT / "CHANGELOG.md"]


def text(page: Path) -> str:
    """Without code, whose brackets are no links."""
    return CODE.sub("", page.read_text("utf-8"))


def anchors(page: Path) -> set[str]:
    """Of its headings, as GitHub makes them."""
    titles = re.findall(r"^#+ (.+)$", text(page), re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def links() -> Iterator[tuple[Path, str]]:
    """Each page and where it links to within the project."""
    for page in DOCUMENTS:
        yield from ((page, target) for target in LINK.findall(text(page)) if "://" not in target)


def test_links_lead_somewhere():
    broken = []
    for page, target in links():
        name, _, anchor = target.partition("#")
        leads_to = page.parent / name if name else page
        if not leads_to.is_file() or (anchor and anchor not in anchors(leads_to)):
            broken.append(f"{page.name}: {target}")
    assert broken == []


def test_every_page_and_picture_is_linked_to():
    reached = {(page.parent / target.partition("#")[0]).resolve() for page, target in links()}
    documents = [*(project.ROOT / "docs").glob("*.md"), *(project.ROOT / "docs" / "pictures").iterdir()]
    assert [path.name for path in documents if path.resolve() not in reached] == []


def test_files_that_pages_name_are_there():
    missing = [
        f"{page.name}: {name}"
        for page in pages()
        for name in PATH.findall(text(page))
        if not name.startswith("build/") and not (project.ROOT / name).exists()
    ]
    assert missing == []
