"""A page of results replaces an older one of its kind, and nothing else."""

from __future__ import annotations

import os

import pytest

from experiments.pages import made_by, prepare_page
from scenes.errors import InputError


def test_its_own_page_may_be_replaced(tmp_path):
    folder = tmp_path / "new" / "folder"
    prepare_page(folder, "A title")
    (folder / "README.md").write_text("# A title\n\nold numbers\n", encoding="utf-8")
    prepare_page(folder, "A title")


@pytest.mark.parametrize("text", ["# Another title\n", "", "\xff"])
def test_another_page_is_kept(tmp_path, text):
    page = tmp_path / "README.md"
    page.write_text(text, encoding="latin-1")
    with pytest.raises(InputError, match=r"README.md is another page.*choose another --out"):
        prepare_page(tmp_path, "A title")
    assert page.read_text(encoding="latin-1") == text


def test_a_folder_that_cannot_be_written_to(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # root may write anywhere
    with pytest.raises(InputError, match="cannot be written to: choose another --out"):
        prepare_page(tmp_path, "A title")


def test_where_it_comes_from():
    text = made_by("airlight x --out results/x", "numpy")
    assert "    airlight x --out results/x\n" in text
    assert "numpy 2." in text
