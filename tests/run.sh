#!/bin/sh
# Sets up everything and runs the tests: lint, types, import layers, the docs site, the test suite.
# `sh tests/run.sh --all` runs the tests marked `full` too. Whatever is given is handed to pytest.
# Needs Python 3.11 or newer and, on Debian or Ubuntu, root or sudo for MiniZinc; all else comes from PyPI.
# PYTHON=/path/to/python chooses the interpreter.
set -eu
cd "$(dirname "$0")/.."
here=$(pwd)
said=$(mktemp -d)
unset PYTHONDONTWRITEBYTECODE # without it each process would compile all modules and tests anew

say() { printf '\n== %s\n' "$*"; }
fail() { printf '%s\n' "$*" >&2; exit 1; }

# Steps run side by side, as two cores can. `beside NAME COMMAND…` begins one; `told NAME` waits for it, prints what it
# says, and ends all where it has failed.
beside() {
  name=$1; shift
  ( set +e; ( set -e; "$@" ) >"$said/$name" 2>&1; echo $? >"$said/$name.code" ) &
  eval "process_$name=$!"
}
told() {
  eval "wait \$process_$1" || :
  cat "$said/$1"
  [ "$(cat "$said/$1.code")" = 0 ] || exit 1
}

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"
  elif command -v sudo >/dev/null 2>&1; then sudo "$@"
  else fail "this step needs root: $*"; fi
}
case " $* " in *" --all "*) all=yes ;; *) all= ;; esac
updated=
from_debian() {
  command -v apt-get >/dev/null 2>&1 || fail "$1 is missing: install it with your system's packages, then run this again"
  [ -n "$updated" ] || { as_root apt-get update -qq; updated=yes; }
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "$1" >/dev/null
}

programs() {
  say "MiniZinc"
  command -v minizinc >/dev/null 2>&1 || from_debian minizinc
  minizinc --version | head -1

  say "LinuxCNC's interpreter, for reading the programs back"
  if [ ! -x .tools/rs274/bin/rs274 ]; then
    command -v apt-get >/dev/null 2>&1 || fail "rs274 is fetched from Debian's packages: run this on Debian 12, or set RS274=/path/to/rs274"
    [ -n "$updated" ] || { as_root apt-get update -qq; updated=yes; }
    sh tests/tools/get_rs274.sh .tools/rs274 >.rs274.log 2>&1 || { cat .rs274.log >&2; fail "rs274 could not be fetched"; }
    rm -f .rs274.log
  fi

  say "gcode-toolpath, another reader of programs, and TypeScript, from npm"
  if [ ! -d .tools/node/node_modules/gcode-toolpath ] || [ ! -d .tools/node/node_modules/typescript ]; then
    command -v npm >/dev/null 2>&1 || from_debian npm
    sh tests/tools/get_node_readers.sh .tools/node || fail "gcode-toolpath and TypeScript could not be fetched from npm"
  fi

  say "Chromium, for the page"
  command -v chromium >/dev/null 2>&1 || from_debian chromium
  chromium --version
  [ -z "$all" ] || command -v firefox-esr >/dev/null 2>&1 || command -v firefox >/dev/null 2>&1 || from_debian firefox-esr
}

environment() {
  say "environment in .venv"
  asked=$(cksum <pyproject.toml)
  if [ "$(cat .venv/installed 2>/dev/null)" != "$asked $here" ]; then
    needed='.[cluster,docs,nest,serve,sheets,test]'
    # uv takes a sixth of the time that pip takes; where it cannot be had, or does not reach the index that pip uses, pip
    { .venv/bin/python -m pip install -q --no-compile --disable-pip-version-check uv &&
      .venv/bin/uv pip install -q --no-cache --python .venv/bin/python -e "$needed"; } ||
      .venv/bin/python -m pip install -q --disable-pip-version-check -e "$needed"
    echo "$asked $here" >.venv/installed
  fi
  [ -e .typing/kerfwise ] || { mkdir -p .typing; ln -s .. .typing/kerfwise; } # left out of source distributions
}

# What is compiled here is there for the tests: kernels, and the tests themselves. What goes wrong the tests tell.
compiled() {
  (cd / && "$here/.venv/bin/python" -m kerfwise.tests.tools.kernels >/dev/null 2>&1) || :
  .venv/bin/pytest --collect-only -q --all >/dev/null 2>&1 || :
}

docs() {
  say "docs site, every link checked"
  NO_MKDOCS_2_WARNING=1 .venv/bin/mkdocs build # not --quiet: it would hide warnings, and pass in spite of them
}

looked_at() {
  say "lint, layers"
  .venv/bin/ruff check .
  .venv/bin/ruff format --check .
  .venv/bin/lint-imports
}

types() {
  say "types"
  .venv/bin/mypy
}

PYTHON=${PYTHON:-python3}
"$PYTHON" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
  fail "kerfwise needs Python 3.11 or newer; $("$PYTHON" --version 2>&1) was found (set PYTHON=/path/to/python)"
[ -x .venv/bin/python ] || "$PYTHON" -m venv .venv 2>/dev/null || { from_debian python3-venv; "$PYTHON" -m venv .venv; }

beside programs programs
environment
beside compiled compiled
looked_at
docs
beside types types # it takes the longest, and goes on beside the first tests
told programs
told compiled

say "tests"
failed=0
KERNELS_ARE_COMPILED=1 .venv/bin/pytest -q -n 2 --dist worksteal "$@" || failed=$?
told types
rm -rf "$said"
exit "$failed"
