# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by cli.sh, station.sh and scripts that need neither.
# checks - [ARGUMENT...] <<'P', checks FILE [ARGUMENT...]: as python3, but a failed assertion says the expected value and
# the one that came, with its line in the script (checks.py).
checks_program=$(realpath "${BASH_SOURCE[0]%/*}")/checks.py
checks_script=$(realpath "$0")
checks() {
  python3 "$checks_program" "$checks_script" "${BASH_LINENO[0]}" "$@"
}
