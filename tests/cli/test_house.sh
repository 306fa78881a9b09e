#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The rules of the house that a program can check (tests/house): words, functions, files, rooms. A count above its limit fails.
set -u
python3 -B tests/house/test_house.py 2>&1 || exit 1
python3 -B tests/house/house.py
