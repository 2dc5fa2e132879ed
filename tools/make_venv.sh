#!/usr/bin/env bash
# Make a virtual environment with everything in it: make_venv.sh FOLDER [PYTHON]
set -euo pipefail
venv=$1
chosen=${2:-}

usable() {  # a Python that the ROS 2 wheels exist for and that can make environments
    "$1" -c 'import sys, venv, ensurepip
sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 13))' >/dev/null 2>&1
}

# PyBullet has wheels for 3.11 and 3.10 only.
for candidate in $chosen python3.11 python3.10 python3 python3.12 python3.13; do
    if usable "$candidate"; then
        python=$candidate
        break
    fi
done
if [ -z "${python:-}" ]; then
    echo 'error: no Python 3.10 to 3.13 with venv and ensurepip found' \
        '(Debian, Ubuntu: apt install python3-venv)' >&2
    exit 1
fi

version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
echo "setting up $venv with Python $version ..."
case $version in
    3.10 | 3.11) ;;
    *) echo "PyBullet has no wheel for Python $version and is compiled: about ten minutes" \
        "(Python 3.11 would take one; a C++ compiler and python3-dev are needed)" ;;
esac
"$python" -m venv --clear "$venv"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check \
    --editable '.[ros,sim,lab,test]'
