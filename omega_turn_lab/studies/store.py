"""Finished cases on disk, one small file each, so that an interrupted sweep goes on."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from omega_turn_lab.studies.tasks import Result, Task
from omega_turn_ros import __version__

# Whose numbers go into a result.
LIBRARIES = ('numpy', 'scipy', 'numba', 'cma', 'shapely', 'pybullet')


@cache
def code_fingerprint(modules: tuple[str, ...]) -> str:
    """Hash of the sources of modules and packages, of this package's version and of libraries.

    Args:
        modules: dotted names; a package stands for all in it.

    Raises:
        ModuleNotFoundError: a module is missing.
    """
    digest = hashlib.sha256(__version__.encode())
    for name in LIBRARIES:
        digest.update(f'{name} {_installed(name)}\n'.encode())
    for name in modules:
        spec = find_spec(name)
        if spec is None or spec.origin is None:
            raise ModuleNotFoundError(name)
        origin = Path(spec.origin)
        package = origin.name == '__init__.py'
        for path in sorted(origin.parent.rglob('*.py')) if package else [origin]:
            digest.update(path.relative_to(origin.parent).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _installed(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return 'absent'


class ResultStore:
    """A folder of results, keyed by case, version and code.

    Args:
        folder: where the files lie; made when first needed.
        fresh: find nothing that was computed before.
    """

    def __init__(self, folder: Path, fresh: bool = False) -> None:
        self.folder = folder
        self.fresh = fresh

    def load(self, task: Task) -> Result | None:
        """Return the result of a finished case; None where there is none that can be read."""
        if self.fresh:
            return None
        try:
            record = json.loads(self._path(task).read_text(encoding='utf-8'))
            return record['result'] if record['task'] == repr(task) else None
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def save(self, task: Task, result: Result) -> None:
        """Write a result; a reader sees all of it or nothing.

        Raises:
            OSError: the folder cannot be written.
        """
        path = self._path(task)
        self.folder.mkdir(parents=True, exist_ok=True)
        record = {'task': repr(task), 'version': __version__, 'result': result}
        handle, draft = tempfile.mkstemp(dir=self.folder, suffix='.part')
        try:
            with os.fdopen(handle, 'w', encoding='utf-8') as stream:
                json.dump(record, stream)
            os.replace(draft, path)
        except BaseException:
            Path(draft).unlink(missing_ok=True)
            raise

    def _path(self, task: Task) -> Path:
        key = hashlib.sha256(f'{task!r}\n{code_fingerprint(task.code)}'.encode()).hexdigest()
        return self.folder / f'{type(task).__name__}-{key[:32]}.json'
