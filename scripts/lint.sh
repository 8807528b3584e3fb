#!/usr/bin/env bash
# lint.sh format: layout of every tracked C++ file.
# lint.sh tidy:   static analysis of every source that the release build compiles; builds nothing but
#                 the headers that the command writes.
# lint.sh types:  types of the front end's modules, the answers of the server among them.
# lint.sh rewrite: lays every tracked C++ file out anew.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

sources() { git -c safe.directory="$root" ls-files -z -- '*.hpp' '*.cpp'; }

check_format() { sources | xargs -0 -r clang-format --dry-run -Werror; }
rewrite() { sources | xargs -0 -r clang-format -i; }

# Tests are more than half of the units: there it is the names, and what goes wrong unseen.
test_checks='-*,readability-identifier-naming,bugprone-use-after-move,bugprone-dangling-handle'
test_checks+=',bugprone-integer-division,bugprone-undelegated-constructor,modernize-use-override'
test_checks+=',performance-for-range-copy,readability-duplicate-include'
own_code=offnominal-own-code

# analyse_one FILE COMMAND: one unit of the compile commands, unless it is known to be fine. What is
# fine depends on the tool, its settings and all files of the unit, not on where the tree lies.
analyse_one() {
  local unit="$1" command="$2" files stamp checks="$own_code"
  case "${unit#"$root/"}" in tests/* | build/tidy/tests/*) checks="$test_checks,$own_code" ;; esac
  files="$(cd build/tidy && eval "${command/ -o * -c / -M }" | sed 's/^[^:]*://; s/\\$//')" || return 1
  # shellcheck disable=SC2086  # a list of files without blanks
  stamp="$known/$({
    clang-tidy --version
    find . -name .clang-tidy -not -path './build/*' -print0 | sort -z | xargs -0 cat
    printf '%s\n' "$command" "$checks"
    cat scripts/tidy/own_code.cpp
    cd build/tidy && cat $files
  } | sed "s#$root#.#g" | sha256sum | cut -d' ' -f1).fine"
  [[ -e "$stamp" ]] && return 0
  # The compile commands are GCC's, which knows warnings that Clang does not. What is used by bodies alone
  # that the plugin leaves out looks unused here; GCC tells what is.
  if clang-tidy -load="$plugin" -p build/tidy --quiet --warnings-as-errors='*' \
    --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-unneeded-internal-declaration \
    --extra-arg=-Wno-unused-function --checks="$checks" "$unit" 2>/dev/null; then
    touch "$stamp"
  else
    echo "clang-tidy: ${unit#"$root/"} has findings" >&2
    return 1
  fi
}

# Findings in system headers are never shown: the plugin keeps the checks from walking through them.
build_plugin() {
  local source=scripts/tidy/own_code.cpp tool
  plugin="$root/build/tidy/own_code.so"
  [[ "$plugin" -nt "$source" ]] && return 0
  tool="$(dirname "$(readlink -f "$(command -v clang-tidy)")")"
  "$tool/clang++" -std=c++14 -O1 -fno-rtti -fPIC -shared -isystem "$tool/../include" "$source" -o "$plugin.new" &&
    mv "$plugin.new" "$plugin" || return 1
}

# A plugin that left everything out would find nothing anywhere.
prove_plugin() {
  local wrong="build/tidy/wrong_name.cpp"
  printf 'struct wrong_name {};\n' >"$wrong"
  if clang-tidy -load="$plugin" --quiet --checks="-*,readability-identifier-naming,$own_code" \
    --warnings-as-errors='*' "$wrong" -- -std=c++20 >/dev/null 2>&1; then
    die "lint.sh tidy: the analysis does not see $wrong's wrong name: $plugin leaves too much out"
  fi
}

# Most of the time goes into headers, again for every unit: CMake puts the sources of a target
# together, a dozen to a unit.
check_tidy() {
  cmake --preset tidy --log-level=WARNING >/dev/null
  build release generated_headers
  (cd build/release && find tests -name '*.hpp' -exec cp --parents -t ../tidy {} +)
  build_plugin
  prove_plugin
  known="$(cache_dir)/tidy"
  mkdir -p "$known"
  find "$known" -name '*.fine' -mtime +60 -delete
  export root known test_checks own_code plugin
  export -f analyse_one
  # One pair per unit, file and command; not what is generated. The JSON is CMake's own, a key per line.
  sed -n 's/^ *"command": "\(.*\)",\{0,1\}$/\1/p; s/^ *"file": "\(.*\)",\{0,1\}$/\1/p' \
    build/tidy/compile_commands.json | sed 's/\\\(.\)/\1/g' |
    awk 'NR % 2 { command = $0; next }
      !/\/build\/tidy\// || /\/Unity\// { printf "%s%c%s%c", $0, 0, command, 0 }' |
    xargs -0 -n 2 -P "$(jobs_allowed)" bash -c 'analyse_one "$@"' analyse_one
}

case "${1:-}" in
  format) check_format ;;
  tidy) check_tidy ;;
  types) node desk/web/types.mjs ;;
  rewrite) rewrite ;;
  *) die "lint.sh format | tidy | types | rewrite" ;;
esac
