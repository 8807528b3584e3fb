#!/usr/bin/env bash
# setup.sh [build|test|vcan|firmware]: installs what the project needs and this machine lacks; with `build`,
# what a build needs, with `vcan`, what ./dev vcan needs, with `firmware`, what a firmware needs beside a
# build. Quick when nothing is missing.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

scope="${1:-test}"
[[ "$scope" =~ ^(build|test|vcan|firmware)$ ]] || die "setup.sh [build|test|vcan|firmware]"

install_packages() {
  local package stand_in purpose wanted=() missing=()
  while read -r package stand_in purpose _; do
    [[ -z "$package" || "$package" == \#* ]] && continue
    [[ "$scope" != test && "$purpose" != "$scope" ]] && continue
    if [[ "$stand_in" == - ]] || ! command -v "$stand_in" >/dev/null; then
      wanted+=("$package")
    fi
  done <"$root/scripts/packages.txt"

  if ! command -v dpkg-query >/dev/null; then
    note "not a Debian machine: this project is tested with the packages of scripts/packages.txt"
    return 0
  fi
  local installed
  # dpkg-query fails when it knows nothing of one name; what it prints of the others is right.
  # shellcheck disable=SC2016  # dpkg-query's own fields
  installed=" $(dpkg-query -W -f '${db:Status-Status}:${Package} ' "${wanted[@]}" 2>/dev/null || true)"
  for package in "${wanted[@]}"; do
    [[ "$installed" == *" installed:$package "* ]] || missing+=("$package")
  done
  ((${#missing[@]} == 0)) && return 0

  note "setup: installing ${missing[*]}"
  export DEBIAN_FRONTEND=noninteractive
  as_root apt-get update -q >&2
  as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends "${missing[@]}" >&2
}

# The stamp is the lock file itself, inside what it describes: deleting node_modules deletes it too.
install_web() {
  local web="$root/desk/web"
  cmp -s "$web/package-lock.json" "$web/node_modules/.installed-lock.json" && return 0
  note "setup: fetching what the front end is made of and with (npm ci)"
  (cd "$web" && npm ci --ignore-scripts --no-audit --no-fund) >&2
  cp "$web/package-lock.json" "$web/node_modules/.installed-lock.json"
}

install_packages
[[ "$scope" == vcan || "$scope" == firmware ]] || install_web
