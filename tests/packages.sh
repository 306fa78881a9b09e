# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by samples/run.sh, tests/run.sh and the benchmarks: the Debian packages, in one place,
# and the way a step is run and told.

FOILGAUGE_PACKAGES="build-essential cmake pkg-config libpng-dev libisal-dev libtiff-dev libjpeg-dev libgsl-dev libcjson-dev nettle-dev libcsv-dev
libopencv-core-dev libopencv-imgproc-dev libsuitesparse-dev libsundials-dev libsqlite3-dev libmicrohttpd-dev libcurl4-openssl-dev libcmocka-dev"

# Only the comparisons need these: what a user would write in Python instead, and another reader of PNG.
FOILGAUGE_BENCH_PACKAGES="python3 python3-numpy python3-scipy python3-skimage python3-opencv libspng-dev"

# Only the long tests need them: regression is compared with R's, and the loop is tried on tables that come with R.
FOILGAUGE_R_PACKAGES="r-base-core r-cran-mass r-cran-lattice r-cran-boot r-cran-nlme r-cran-lme4 r-cran-pbkrtest"

# Only long tests need them, and builds with MQTT and PostgreSQL: without them a station has neither.
FOILGAUGE_SHOP_PACKAGES="libmosquitto-dev mosquitto libpq-dev postgresql"

# Only long tests need them: a validator of JSON and a reader of DXF that are not the project's own.
FOILGAUGE_SCHEMA_PACKAGES="python3 python3-jsonschema python3-ezdxf"

# Only long tests need them: the station and every page in a real browser.
FOILGAUGE_BROWSER_PACKAGES="chromium chromium-driver python3-selenium poppler-utils"

# Only the long test of the packages needs these: a Debian of nothing else to install them on, and its checker.
FOILGAUGE_CHROOT_PACKAGES="mmdebstrap lintian"

# step TEXT COMMAND...: one line per step; what the command says is shown only when it fails.
step() {
  local text=$1 log
  shift
  log=$(mktemp)
  printf '%s ... ' "$text"
  if "$@" >"$log" 2>&1; then
    echo "done"
    rm -f "$log"
  else
    local code=$?
    echo "failed (exit code $code): $*"
    cat "$log"
    rm -f "$log"
    return $code
  fi
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    echo "needs root: run as root, or install sudo, or install by hand: $*" >&2
    return 1
  fi
}

apt_install() {
  as_root apt-get update &&
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"
}

# install_missing PACKAGE...: touches the network only when dpkg says that something is missing.
install_missing() {
  local package missing=()
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' ||
      missing+=("$package")
  done
  if [ ${#missing[@]} -eq 0 ]; then
    echo "packages: all installed"
  else
    step "installing ${missing[*]}" apt_install "${missing[@]}"
  fi
}

# build_preset KIND FOLDER: configure by src/cmake/KIND.cmake and build; a tree that is there is brought up to date.
build_preset() {
  step "configuring $1 in $2/" cmake -S . -B "$2" -G "Unix Makefiles" -C "src/cmake/$1.cmake" || return
  step "building $1" cmake --build "$2" -j"$(nproc)"
}
