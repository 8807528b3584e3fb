#!/usr/bin/env bash
# lint.sh format: layout of every tracked C++ file.
# lint.sh tidy:   static analysis of every translation unit of build/release (built before).
# lint.sh rewrite: lays every tracked C++ file out anew.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

sources() { git -c safe.directory="$root" ls-files -z -- '*.hpp' '*.cpp'; }

check_format() { sources | xargs -0 -r clang-format --dry-run -Werror; }
rewrite() { sources | xargs -0 -r clang-format -i; }

# One line per translation unit: source file, then the files of this tree that it reads.
units() {
  ninja -C build/release -t deps | awk -v root="$root/" '
    function flush() { if (source != "") print source files; source = ""; files = "" }
    /^[^ ]/ { flush(); first = 1; next }
    /^ / {
      path = $1
      if (path !~ /^\//) path = root "build/release/" path
      own = index(path, root) == 1 && index(path, root "build/") != 1 && path !~ /\/node_modules\//
      if (first && own) source = path
      if (own) files = files " " path
      first = 0
    }
    END { flush() }' | sort -u -k1,1
}

# What the verdict on one unit depends on; system headers come with the tool's version.
fingerprint() {
  local source="$1"
  shift
  {
    clang-tidy --version
    find . -name .clang-tidy -not -path './build/*' -print0 | sort -z | xargs -0 cat
    grep -F -- "-c $source\"" build/release/compile_commands.json
    cat "$@"
  } | sha256sum | cut -d' ' -f1
}

analyse_one() {
  local source="$1" stamp="$2"
  # The compile commands are GCC's, which knows warnings that Clang does not.
  if clang-tidy -p build/release --quiet --warnings-as-errors='*' \
    --extra-arg=-Wno-unknown-warning-option "$source" 2>/dev/null; then
    touch "$stamp"
  else
    echo "clang-tidy: ${source#"$root/"} has findings" >&2
    return 1
  fi
}

check_tidy() {
  [[ -f build/release/build.ninja ]] || die "lint tidy needs ./dev build first"
  mkdir -p build/tidy
  local source files key seen=0 queue=()
  while read -r source files; do
    # shellcheck disable=SC2086  # a list of files without blanks
    key="$(fingerprint "$source" $files)"
    seen=$((seen + 1))
    [[ -e "build/tidy/$key" ]] || queue+=("$source" "build/tidy/$key")
  done < <(units)
  ((seen > 0)) || die "lint tidy: build/release has compiled nothing, so there is nothing to judge"
  ((${#queue[@]} == 0)) && return 0
  note "clang-tidy on $((${#queue[@]} / 2)) changed translation units"
  export root
  export -f analyse_one
  printf '%s\0' "${queue[@]}" |
    xargs -0 -n 2 -P "$(jobs_allowed)" bash -c 'analyse_one "$@"' analyse_one
}

case "${1:-}" in
  format) check_format ;;
  tidy) check_tidy ;;
  rewrite) rewrite ;;
  *) die "lint.sh format | tidy | rewrite" ;;
esac
