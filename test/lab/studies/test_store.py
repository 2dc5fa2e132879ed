"""What is finished stays finished, and nothing else is taken for it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cases import Hopeless, Square

from omega_turn_lab.studies import store as store_module
from omega_turn_lab.studies.store import ResultStore, code_fingerprint


def test_a_result_comes_back_to_the_last_bit(tmp_path: Path) -> None:
    store = ResultStore(tmp_path / 'deep' / 'cache')
    assert store.load(Square(7)) is None
    store.save(Square(7), Square(7).run())
    assert store.load(Square(7)) == Square(7).run()
    assert store.load(Square(8)) is None and store.load(Hopeless(7)) is None


def test_a_fresh_store_finds_nothing_but_keeps_what_it_is_given(tmp_path: Path) -> None:
    ResultStore(tmp_path).save(Square(7), {'square': 0})
    fresh = ResultStore(tmp_path, fresh=True)
    assert fresh.load(Square(7)) is None
    fresh.save(Square(7), {'square': 49})
    assert ResultStore(tmp_path).load(Square(7)) == {'square': 49}


def test_a_result_of_other_code_or_version_is_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = ResultStore(tmp_path)
    store.save(Square(7), {'square': 49})
    monkeypatch.setattr(Square, 'code', ('omega_turn_ros.robot',))
    assert store.load(Square(7)) is None
    monkeypatch.undo()
    assert store.load(Square(7)) is not None
    code_fingerprint.cache_clear()
    monkeypatch.setattr(store_module, '__version__', '99.0')
    assert store.load(Square(7)) is None
    monkeypatch.undo()
    code_fingerprint.cache_clear()


def test_the_fingerprint_sees_every_file_of_a_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / 'some_science'
    (package / 'deep').mkdir(parents=True)
    for name in ('__init__.py', 'deep/__init__.py', 'deep/law.py'):
        (package / name).write_text('')
    monkeypatch.syspath_prepend(str(tmp_path))
    code_fingerprint.cache_clear()
    before = code_fingerprint(('some_science',))
    (package / 'deep' / 'law.py').write_text('mu = 0.5\n')
    assert code_fingerprint(('some_science',)) == before  # once per process
    code_fingerprint.cache_clear()
    assert code_fingerprint(('some_science',)) != before
    with pytest.raises(ModuleNotFoundError, match='no_science'):
        code_fingerprint(('no_science',))


@pytest.mark.parametrize('damage', ['', '{"task": ', '[]', '{"result": {"square": 1}}', '\x00'])
def test_a_damaged_file_counts_as_missing(tmp_path: Path, damage: str) -> None:
    store = ResultStore(tmp_path)
    store.save(Square(7), {'square': 49})
    (path,) = tmp_path.iterdir()
    path.write_text(damage)
    assert store.load(Square(7)) is None
    store.save(Square(7), {'square': 49})
    assert store.load(Square(7)) == {'square': 49}


def test_a_write_that_fails_leaves_no_half_file_and_the_old_result(tmp_path: Path) -> None:
    store = ResultStore(tmp_path)
    store.save(Square(7), {'square': 49})
    with pytest.raises(TypeError):
        store.save(Square(7), {'square': object()})
    (path,) = tmp_path.iterdir()
    assert json.loads(path.read_text())['result'] == {'square': 49}
