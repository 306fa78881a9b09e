# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the tests of the packages, before cli.sh: skips where there is nothing to make them of, and makes them.
if [ -n "${FOILGAUGE_TEST_BRIEF:-}" ] || [ -z "${FOILGAUGE_TEST_LONG:-}" ]; then
  echo "skipped: packages are made of a build without sanitizers, where FOILGAUGE_TEST_LONG is set"
  exit 77
fi
[ "$(id -u)" -eq 0 ] || { echo "skipped: dpkg installs for root only"; exit 77; }

# need TOOL...: skips where one is missing.
need() {
  local tool
  for tool in "$@"; do
    command -v "$tool" >/dev/null || { echo "skipped: no $tool"; exit 77; }
  done
}

# make_packages: $deb and $dev, as they are made, but for the compression, which takes longer than all the rest.
make_packages() {
  cpack --config "$(dirname "$program")/CPackConfig.cmake" -B "$work/made" -D CPACK_DEBIAN_COMPRESSION_TYPE=gzip \
    -D CPACK_DEBIAN_PACKAGE_MAINTAINER="A Packager <packager@debian.org>" \
    >"$work/log" 2>&1 || fail "cpack: $(tail -n 5 "$work/log")"
  deb=$(ls "$work"/made/foilgauge_*.deb) dev=$(ls "$work"/made/foilgauge-dev_*.deb)
}
