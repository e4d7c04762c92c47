"""Compiled code is pickles: it is read only where nobody else can have put it."""

import os
import pickle
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from watched import ALL, ELASTIC, ZERO, fill

import viscopoint as vp
from viscopoint.kernels import cache_folder as folders

STRANGER = 12345  # a user id that is neither ours nor root's


def python(code: str, **settings: str | Path) -> tuple[str, str]:
    """Run code in a new process; return what it printed as results and as messages."""
    environment = os.environ | {key: str(value) for key, value in settings.items()}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


def opened(monkeypatch: pytest.MonkeyPatch, named: Path, usual: Path) -> Path:
    """Return the cache folder of a new process with a folder named and a user's one."""
    monkeypatch.setenv("VISCOPOINT_CACHE", str(named))
    monkeypatch.setattr("platformdirs.user_cache_path", lambda name: usual / name)
    return folders.cache_folder.__wrapped__()


def given_away(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a folder, file or link belong to another user; who has not the rights for that becomes another one."""
    if os.geteuid() == 0:
        os.chown(path, STRANGER, STRANGER, follow_symlinks=False)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: STRANGER)


def test_a_sound_folder_is_used_and_made_for_us_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    before = os.umask(0)
    try:
        folder = opened(monkeypatch, tmp_path / "deep" / "cache", tmp_path)
    finally:
        os.umask(before)
    assert folder.parent == tmp_path / "deep" / "cache"
    for made in (folder, folder.parent, folder.parent.parent):
        assert stat.S_IMODE(made.stat().st_mode) == 0o700
    assert opened(monkeypatch, tmp_path / "deep" / "cache", tmp_path) == folder


KINDS = (
    "cache of another", "cache others write", "kernels of another", "kernels others write", "kernels a link",
    "cache a link to another's", "a folder on the way of another", "a file of another", "a file others write",
)  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_a_cache_that_others_could_have_written_to_is_told_and_not_used(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    cache, usual = tmp_path / "way" / "cache", tmp_path / "usual"
    folder = opened(monkeypatch, cache, usual)
    inside = folder / "mpm" / "kernel.code"
    inside.parent.mkdir(mode=0o700)
    inside.write_bytes(b"code")
    inside.chmod(0o600)
    assert opened(monkeypatch, cache, usual) == folder
    if kind == "cache a link to another's":
        cache.rename(tmp_path / "elsewhere")
        cache.symlink_to(tmp_path / "elsewhere")
        given_away(tmp_path / "elsewhere", monkeypatch)
    elif kind == "kernels a link":
        folder.rename(tmp_path / "elsewhere")
        folder.symlink_to(tmp_path / "elsewhere")
    elif kind.endswith("of another"):
        place = {"cache": cache, "kernels": folder, "a folder on the way": cache.parent, "a file": inside}
        given_away(place[kind.removesuffix(" of another")], monkeypatch)
    else:
        place = {"cache": cache, "kernels": folder, "a file": inside}[kind.removesuffix(" others write")]
        place.chmod(place.stat().st_mode | stat.S_IWGRP)
    with pytest.warns(vp.ViscopointWarning, match=f"cache folder {cache} .*not used"):
        instead = opened(monkeypatch, cache, usual)
    assert cache not in instead.parents
    assert folder not in (instead, *instead.parents)
    assert stat.S_IMODE(instead.stat().st_mode) == 0o700
    assert instead.stat().st_uid == os.getuid()


def test_a_common_folder_for_temporary_files_may_hold_the_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    tmp_path.chmod(0o1777)
    assert opened(monkeypatch, tmp_path, tmp_path).parent == tmp_path


class Payload:
    """An attacker's pickle: who reads it leaves a file."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self):
        return Path.touch, (self.mark,)


def test_planted_code_is_not_executed(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory):
    cache, usual, mark = tmp_path / "cache", tmp_path / "usual", tmp_path / "mark"
    sound, _ = (fill(place, tmp_path_factory) for place in (cache, usual / "viscopoint"))
    files = list(cache.rglob("*.code"))
    assert files
    for file in files:
        file.write_bytes(pickle.dumps(Payload(mark)))
    python(f"import pickle; pickle.load(open({str(files[0])!r}, 'rb'))")
    assert mark.exists()  # such a file does what its author wants
    mark.unlink()
    for folder in cache.glob("kernels-*"):
        folder.chmod(0o777)  # as one that another user made for us
    found, messages = python(ELASTIC, VISCOPOINT_CACHE=cache, XDG_CACHE_HOME=usual)
    assert not mark.exists()
    assert found.split() == [sound, str(len(ALL))]  # code from the user's own folder
    assert "others can write to" in messages


def test_without_any_cache_a_private_one_ends_with_the_process(tmp_path: Path):
    blocked, place = tmp_path / "blocked", tmp_path / "temporary"
    blocked.touch()  # a file, in which nobody makes a folder, whatever the rights
    place.mkdir()
    planted = place / f"viscopoint-{os.getuid()}"  # where earlier versions looked
    planted.mkdir(mode=0o777)
    settings = {"HOME": blocked, "XDG_CACHE_HOME": blocked, "VISCOPOINT_CACHE": blocked, "TMPDIR": place}
    told = "from viscopoint.kernels.cache_folder import cache_folder as f; print(f(), oct(f().stat().st_mode & 0o777))"
    out, messages = python(ZERO + told, **settings)
    folder, mode = out.splitlines()[1].split()
    assert Path(folder).parent == place
    assert mode == "0o700"
    assert str(blocked) in messages
    assert folder in messages
    assert list(place.iterdir()) == [planted]
    assert list(planted.iterdir()) == []


def test_what_is_kept_is_ours_alone_whatever_the_mask_and_used_again(tmp_path: Path):
    open_to_all = "import os; os.umask(0)\n" + ZERO
    cold, _ = python(open_to_all, VISCOPOINT_CACHE=tmp_path)
    kept = list(tmp_path.rglob("*.code"))
    assert kept
    for path in (*kept, *(path for path in tmp_path.rglob("*") if path.is_dir())):
        assert path.stat().st_mode & 0o022 == 0, path
    warm, messages = python(open_to_all, VISCOPOINT_CACHE=tmp_path)
    assert (warm.split(), messages) == ([cold.split()[0], str(len(kept))], "")


def test_code_of_other_settings_of_the_compiler_is_not_mixed_up(tmp_path: Path):
    loaded = [
        python(ZERO, VISCOPOINT_CACHE=tmp_path, **settings)[0].split()[1]
        for settings in ({}, {"NUMBA_OPT": "1"}, {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}, {})
    ]
    assert loaded == ["0", "0", "0", "1"]
