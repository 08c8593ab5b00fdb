#!/bin/sh
# Fetches from npm into the folder that is named: gcode-toolpath, an outside reader of programs, and TypeScript, which
# checks the types of the page's modules, and axe-core, which looks for what keeps people from using the page. Needs
# Node.js and npm.
set -eu
mkdir -p "$1"
npm install --silent --no-audit --no-fund --prefix "$1" gcode-toolpath@3.0.0 typescript@5.9.3 axe-core@4.10.3
