"""Compiled code is read only from where nobody else can put any."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest

from rthm_core.compile_cache import cache_folder
from rthm_core.errors import InputError
from rthm_core.private_folder import NotPrivateError, make_private

SOMEBODY = 4711


@pytest.fixture
def root() -> None:
    if os.geteuid() != 0:
        pytest.skip("only root can make files of another user")


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """Temporary folder, with root as the only owner up to it."""
    return tmp_path


def test_a_new_folder_is_closed_to_others(place: Path) -> None:
    make_private(place / "a" / "b")
    assert {(place / name).stat().st_mode & 0o777 for name in ("a", "a/b")} == {0o700}


def test_a_folder_of_ones_own_is_closed_from_now_on(place: Path) -> None:
    (place / "mine").mkdir()
    (place / "mine").chmod(0o777)
    (place / "mine" / "code").touch()
    make_private(place / "mine")
    assert (place / "mine").stat().st_mode & 0o777 == 0o700


@pytest.mark.usefixtures("root")
@pytest.mark.parametrize("planted", [".", "inner", "inner/code"])
def test_a_folder_with_anything_of_another_user_is_refused(place: Path, planted: str) -> None:
    (place / "cache" / "inner").mkdir(parents=True)
    (place / "cache" / "inner" / "code").touch()
    os.chown(place / "cache" / planted, SOMEBODY, SOMEBODY)
    with pytest.raises(NotPrivateError, match=f"belongs to user {SOMEBODY}"):
        make_private(place / "cache")


def test_a_link_is_not_followed(place: Path) -> None:
    (place / "elsewhere").mkdir()
    (place / "cache").symlink_to(place / "elsewhere")
    with pytest.raises(NotPrivateError, match="is a link"):
        make_private(place / "cache")


def test_a_folder_that_others_can_replace_is_refused_and_a_sticky_one_is_not(place: Path) -> None:
    (place / "shared").mkdir()
    (place / "shared").chmod(0o777)
    with pytest.raises(NotPrivateError, match=r"others can write .*shared"):
        make_private(place / "shared" / "cache")
    (place / "shared").chmod(0o1777)
    make_private(place / "shared" / "cache")


@pytest.mark.usefixtures("root")
def test_a_cache_that_another_user_has_planted_is_refused_in_one_sentence(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("RTHM_CACHE_DIR", raising=False)
    (place / "home").touch()  # no folder can be made in it
    monkeypatch.setenv("XDG_CACHE_HOME", str(place / "home"))
    (place / "tmp").mkdir()
    (place / "tmp").chmod(0o1777)
    monkeypatch.setattr(tempfile, "tempdir", str(place / "tmp"))
    assert cache_folder().parent == place / "tmp" / "rthm-compiled-0"
    os.chown(place / "tmp" / "rthm-compiled-0", SOMEBODY, SOMEBODY)
    with pytest.raises(InputError, match=f"belongs to user {SOMEBODY}, .*; set RTHM_CACHE_DIR"):
        cache_folder()


@pytest.mark.usefixtures("root")
def test_the_home_of_another_user_is_not_used_unless_it_was_chosen(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("RTHM_CACHE_DIR", raising=False)
    (place / "home").mkdir()
    os.chown(place / "home", SOMEBODY, SOMEBODY)
    monkeypatch.setenv("XDG_CACHE_HOME", str(place / "home"))
    (place / "tmp").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(place / "tmp"))
    assert cache_folder().is_relative_to(place / "tmp")
    monkeypatch.setenv("RTHM_CACHE_DIR", str(place / "home"))
    with pytest.raises(InputError, match="cannot be kept"):
        cache_folder()
