"""What the class page adds to the colours of all pages can be told apart as well."""

from itertools import product

import pytest

from tests.grader.reports.page.test_contrast import OTHER, SCHEMES, TEXT, contrast


@pytest.mark.parametrize("scheme", SCHEMES)
def test_points_can_be_read_in_every_row_and_in_the_chosen_one(scheme):
    colors = SCHEMES[scheme]
    texts = ("ink", "link", "good", "bad", "open")
    for text, ground in product(texts, ("card", "open-wash")):
        assert contrast(colors[text], colors[ground]) >= TEXT, (text, ground)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_chosen_path_is_seen(scheme):
    colors = SCHEMES[scheme]
    assert contrast(colors["bad"], colors["paper"]) >= OTHER
