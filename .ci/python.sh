#!/bin/sh
# Make a virtual environment: python.sh PYTHON VENV. Debian keeps venv in a package of its own.
set -eu
"$1" -m venv "$2" && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        python3-venv >/dev/null
    rm -rf "$2"
    exec "$1" -m venv "$2"
fi
echo "$1 -m venv failed: install your system's package for Python virtual environments" >&2
exit 1
