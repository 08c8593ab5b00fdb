#!/bin/sh
# Fetches gcode-toolpath, an outside reader of programs, from npm into the folder that is named. Needs Node.js and npm.
set -eu
mkdir -p "$1"
npm install --silent --no-audit --no-fund --prefix "$1" gcode-toolpath@3.0.0
