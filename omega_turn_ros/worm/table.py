"""Reading a table of numbers, frames down and body positions across, from .npy, .csv or .mat."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]

NUMBERS = 'iuf'  # kinds of numpy arrays that hold real numbers
MISSING = ('', 'nan', 'na', 'n/a', 'null', 'none')
SEPARATORS = ';\t,'  # the first one found in a file separates its cells; else white space
SUFFIXES = ('.npy', '.csv', '.tsv', '.txt', '.mat')


def read_table(path: Path, variable: str = '') -> Array:
    """Read one table.

    Args:
        path: a .npy file; a .csv, .tsv or .txt file, whose first line may be a header and whose
            empty and NaN cells are missing values; or a .mat file up to version 7.
        variable: of a .mat file, needed where it holds several tables.

    Returns:
        The numbers as they are, NaN where missing, shape (rows, columns).

    Raises:
        BadInputError: the file is missing, of another kind, damaged, or holds no single table of
            real numbers.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise BadInputError('file', str(path), f'a file that ends in {", ".join(SUFFIXES)}')
    if not path.is_file():
        raise BadInputError('file', str(path), 'a file that exists')
    if path.suffix.lower() == '.mat':
        table = _from_mat(path, variable)
    elif variable:
        raise BadInputError('variable', variable, 'none: only .mat files have variables')
    elif path.suffix.lower() == '.npy':
        table = _from_npy(path)
    else:
        table = _from_text(path)
    if table.dtype.kind not in NUMBERS:
        raise BadInputError(str(path), f'type {table.dtype}', 'real numbers')
    if table.ndim != 2:
        raise BadInputError(str(path), f'shape {table.shape}', 'frames x body positions')
    return np.array(table, float)


def _from_npy(path: Path) -> NDArray[Any]:
    try:
        loaded = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise BadInputError('file', str(path), f'a .npy file of numbers ({error})') from error
    if not isinstance(loaded, np.ndarray):  # an .npz under a wrong name
        loaded.close()
        raise BadInputError('file', str(path), 'a .npy file of one array')
    return loaded


def _from_mat(path: Path, variable: str) -> NDArray[Any]:
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        content = loadmat(path)
    except NotImplementedError as error:
        expected = 'a .mat file up to version 7: store it anew with save(..., "-v7")'
        raise BadInputError('file', str(path), expected) from error
    except (MatReadError, OSError, ValueError, TypeError, EOFError) as error:
        raise BadInputError('file', str(path), f'a .mat file ({error})') from error
    tables = {
        name: value
        for name, value in content.items()
        if isinstance(value, np.ndarray) and value.dtype.kind in NUMBERS and min(value.shape) > 1
    }
    if variable and variable not in tables:
        raise BadInputError('variable', variable, f'one of {sorted(tables)}')
    if not variable and len(tables) != 1:
        expected = f'one table of numbers, or one named by --variable: {sorted(tables)}'
        raise BadInputError('file', str(path), expected)
    found: NDArray[Any] = tables[variable or next(iter(tables))]
    return found


def _from_text(path: Path) -> Array:
    try:
        text = path.read_text(encoding='utf-8-sig')
    except UnicodeDecodeError as error:
        raise BadInputError('file', str(path), f'text in UTF-8 ({error})') from error
    lines = [
        (number, line.strip(' '))  # no tabs: each parts two cells, if empty ones
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip(' ') and not line.lstrip().startswith('#')
    ]
    if not lines:
        raise BadInputError('file', str(path), 'a table of numbers')
    separator = next((mark for mark in SEPARATORS if mark in lines[0][1]), None)
    first = lines[0][1].split(separator)
    words = [c for c in first if c.strip().lower() not in MISSING and not _is_number(c, separator)]
    if words and not any(_is_number(cell, separator) for cell in first):
        lines = lines[1:]  # a header
    rows = [_row(path, number, line.split(separator), separator) for number, line in lines]
    for (number, _), row in zip(lines, rows):
        if len(row) != len(rows[0]):
            field = f'{path} line {number}'
            raise BadInputError(field, f'{len(row)} cells', f'{len(rows[0])}, as above')
    return np.array(rows, float)


def _row(path: Path, number: int, cells: list[str], separator: str | None) -> list[float]:
    row = []
    for place, cell in enumerate(cells, 1):
        if cell.strip().lower() in MISSING:
            row.append(math.nan)
        elif _is_number(cell, separator):
            row.append(_number(cell, separator))
        else:
            raise BadInputError(f'{path} line {number}, cell {place}', cell, 'a number')
    return row


def _number(cell: str, separator: str | None) -> float:
    """Read a number; where semicolons separate cells, a comma may be the decimal point."""
    return float(cell.replace(',', '.') if separator == ';' else cell)


def _is_number(cell: str, separator: str | None) -> bool:
    try:
        _number(cell, separator)
    except ValueError:
        return False
    return True
