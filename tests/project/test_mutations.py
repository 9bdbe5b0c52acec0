# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of mutations fits the code as it is, and the tool tells a test that notices from one that does not."""

import pytest

from tests.tools import project
from tests.tools.mutations import MUTATIONS, Mutation, notice, place
from tests.tools.mutations import test_files as files_of


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.about)
def test_each_has_one_place_and_tests(mutation):
    place(mutation, project.ROOT)
    assert files_of(mutation.tests, project.ROOT)
    assert mutation.new != mutation.old


@pytest.fixture
def small_project(tmp_path):
    """A package of one number, and a test that it is one."""
    for folder in ("ism_addon", "tests"):
        (tmp_path / folder).mkdir()
    (tmp_path / "ism_addon" / "numbers.py").write_text("ONE, SPARE = 1, 2\n")
    test = "from ism_addon.numbers import ONE\n\n\ndef test_one():\n    assert ONE == 1\n"
    (tmp_path / "tests" / "test_numbers.py").write_text(test)
    (tmp_path / "pyproject.toml").write_text("[tool.pytest.ini_options]\npythonpath = ['.']\n")
    return tmp_path


@pytest.mark.parametrize(
    ("old", "new", "noticed"),
    [(" = 1", " = 3", "tests/test_numbers.py::test_one"), ("1, 2", "1, 3", "")],
    ids=["noticed", "survives"],
)
def test_who_notices(small_project, old, new, noticed):
    before = (small_project / "ism_addon" / "numbers.py").read_bytes()
    mutation = Mutation("a number", old, new, ("test_numbers",))
    assert notice(mutation, small_project, everything=False, seconds=60.0) == noticed
    assert (small_project / "ism_addon" / "numbers.py").read_bytes() == before


@pytest.mark.parametrize("old", ["THREE", ", "], ids=["gone", "not only once"])
def test_a_text_that_is_not_there_once_is_an_error(small_project, old):
    with pytest.raises(ValueError, match="times in the package"):
        notice(Mutation("a number", old, "", ("test_numbers",)), small_project, everything=False, seconds=60.0)
    with pytest.raises(ValueError, match="no tests are called test_others"):
        files_of(("test_others",), small_project)
