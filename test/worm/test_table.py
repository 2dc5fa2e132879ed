"""Tables come out of files as they went in; what is no table is refused by place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.worm.table import read_table

TABLE = np.random.default_rng(0).normal(size=(20, 7)).round(6)
GAPPY = np.where(np.arange(20)[:, None] == 4, np.nan, TABLE)


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text, encoding='utf-8')
    return path


def lines_of(table: np.ndarray, separator: str) -> str:
    rows = (separator.join('' if np.isnan(v) else repr(float(v)) for v in row) for row in table)
    return '\n'.join(rows) + '\n'


@pytest.mark.parametrize('kind', ['f8', 'f4', 'i4'])
def test_npy(kind: str, tmp_path: Path) -> None:
    table = (10 * TABLE).astype(kind)
    np.save(tmp_path / 'k.npy', table)
    read = read_table(tmp_path / 'k.npy')
    assert read.dtype == float
    np.testing.assert_array_equal(read, table)


@pytest.mark.parametrize(
    ('separator', 'head'),
    [
        (',', ''),
        (',', 'a,b,c,d,e,f,g\n'),
        (';', '# said\n\n'),
        ('\t', '\ufeff'),
        (', ', 'p,q,r,s,t,u,v\n'),
    ],
)
def test_text(separator: str, head: str, tmp_path: Path) -> None:
    path = written(tmp_path, 'k.csv', head + lines_of(GAPPY, separator))
    np.testing.assert_array_equal(read_table(path), GAPPY)


def test_text_of_a_country_with_decimal_commas_and_words_for_missing(tmp_path: Path) -> None:
    path = written(tmp_path, 'k.csv', '1,5;NaN;3\n-0,25;2e-1;NA\n')
    np.testing.assert_array_equal(read_table(path), [[1.5, np.nan, 3.0], [-0.25, 0.2, np.nan]])


def test_text_with_white_space(tmp_path: Path) -> None:
    path = written(tmp_path, 'k.txt', '  1 2   3\n4 nan 6\n')
    np.testing.assert_array_equal(read_table(path), [[1, 2, 3], [4, np.nan, 6]])


def test_a_first_frame_without_values_is_no_header(tmp_path: Path) -> None:
    path = written(tmp_path, 'k.csv', ',,\n1,2,3\n')
    assert read_table(path).shape == (2, 3)


def test_mat(tmp_path: Path) -> None:
    path = tmp_path / 'k.mat'
    savemat(path, {'theta': TABLE, 'fps': 32.0, 'who': 'me'})
    np.testing.assert_array_equal(read_table(path), TABLE)
    savemat(path, {'theta': TABLE, 'xy': GAPPY})
    np.testing.assert_array_equal(read_table(path, 'xy'), GAPPY)
    with pytest.raises(BadInputError, match=r"--variable: \['theta', 'xy'\]"):
        read_table(path)
    with pytest.raises(BadInputError, match=r'^variable: '):
        read_table(path, 'phi')


BAD_TEXTS = {
    'empty': ('', 'a table of numbers'),
    'a word': ('1,2\n3,four\n', 'line 2, cell 2: '),
    'uneven': ('1,2\n3\n', 'line 2: '),
    'only a header': ('a,b\n', 'frames x body positions'),
}


@pytest.mark.parametrize('case', BAD_TEXTS)
def test_bad_text_is_refused_by_place(case: str, tmp_path: Path) -> None:
    text, said = BAD_TEXTS[case]
    with pytest.raises(BadInputError, match=said):
        read_table(written(tmp_path, 'k.csv', text))


@pytest.mark.parametrize('suffix', ['npy', 'csv', 'mat'])
def test_a_damaged_file_is_refused(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f'k.{suffix}'
    path.write_bytes(b'\x93NUMPY\x01\x00\xff\xfe\x80 nothing of the kind' * 10)
    with pytest.raises(BadInputError, match=r'^file: '):
        read_table(path)


def test_other_files_and_other_arrays_are_refused(tmp_path: Path) -> None:
    for name, said in (('none.npy', 'exists'), ('k.xlsx', 'ends in')):
        with pytest.raises(BadInputError, match=said):
            read_table(tmp_path / name)
    path = tmp_path / 'k.npy'
    for array, said in (
        (TABLE[0], 'frames x body positions'),
        (TABLE + 1j, 'real numbers'),
        (np.array(['a', 'b']), 'real numbers'),
        (np.array([{}]), '^file: '),  # would run code when read
    ):
        np.save(path, array)
        with pytest.raises(BadInputError, match=said):
            read_table(path)
    np.save(path, TABLE)
    with pytest.raises(BadInputError, match=r'^variable: '):
        read_table(path, 'theta')
