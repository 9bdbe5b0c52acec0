# SPDX-License-Identifier: GPL-3.0-or-later
"""All mutations apply to the current code, and the tool reports which test detects a mutation."""

import pytest

from tests.tools import project
from tests.tools.mutation_table import MUTATIONS, Mutation
from tests.tools.mutations import detecting_test, source_file
from tests.tools.mutations import test_files as files_of


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.about)
def test_each_mutation_applies_once_and_has_tests(mutation):
    source_file(mutation, project.ROOT)
    assert files_of(mutation.tests, project.ROOT)
    assert mutation.new != mutation.old


@pytest.fixture
def small_project(tmp_path):
    """A package with two constants, and a test of the first."""
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
def test_notice_names_the_test_that_fails(small_project, old, new, noticed):
    before = (small_project / "ism_addon" / "numbers.py").read_bytes()
    mutation = Mutation("a number", old, new, ("test_numbers",))
    assert detecting_test(mutation, small_project, everything=False, seconds=60.0) == noticed
    assert (small_project / "ism_addon" / "numbers.py").read_bytes() == before


def test_a_test_that_fails_without_a_mutation_is_an_error(small_project):
    (small_project / "tests" / "test_numbers.py").write_text("def test_one():\n    assert False\n")
    with pytest.raises(ValueError, match="fails without a mutation"):
        mutation = Mutation("a number", "1, 2", "1, 3", ("test_numbers",))
        detecting_test(mutation, small_project, everything=False, seconds=60.0)


@pytest.mark.parametrize("old", ["THREE", ", "], ids=["gone", "not only once"])
def test_a_text_that_does_not_occur_exactly_once_is_an_error(small_project, old):
    with pytest.raises(ValueError, match="times in the package"):
        detecting_test(Mutation("a number", old, "", ("test_numbers",)), small_project, everything=False, seconds=60.0)
    with pytest.raises(ValueError, match="no tests are called test_others"):
        files_of(("test_others",), small_project)
