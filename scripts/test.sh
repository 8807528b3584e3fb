#!/usr/bin/env bash
# Every check of the project. The last line sums them: N passed, N failed[, N skipped].
# A step that breaks is counted as failed and the next one runs, so the last line is always reached.
set -uo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

passed=0
failed=0
skipped=0
failures=()

finish() {
  local name line
  if ((${#failures[@]} > 0)); then
    printf '\nfailed:\n'
    for name in "${failures[@]}"; do printf '  %s\n' "$name"; done
  fi
  line="$passed passed, $failed failed"
  if ((skipped > 0)); then line+=", $skipped skipped"; fi
  printf '\n%s\n' "$line"
  exit $((failed > 0))
}

fail() {
  failed=$((failed + 1))
  failures+=("$1")
}

# shellcheck disable=SC2317  # run by the trap
interrupted() {
  fail "interrupted"
  finish
}
trap interrupted INT TERM

# check NAME COMMAND...: one step that passes or fails as a whole.
check() {
  local name="$1"
  shift
  note "$name"
  if "$@"; then
    passed=$((passed + 1))
  else
    fail "$name"
  fi
}

# One line per test of a JUnit report: pass, fail or skip, and its name. CTest calls a test that was
# not built "skipped"; only a test that skipped itself is.
verdicts() {
  awk '
    /<testcase / {
      match($0, /name="[^"]*"/)
      name = substr($0, RSTART + 6, RLENGTH - 7)
      match($0, /status="[^"]*"/)
      status = substr($0, RSTART + 8, RLENGTH - 9)
      if (status == "run") print "pass", name
      else if (status == "disabled") print "skip", name
      else if (status != "notrun") print "fail", name
    }
    /<skipped message=/ && status == "notrun" {
      print (/message="SKIP_/ ? "skip" : "fail"), name
    }' "$1"
}

# suite PRESET: runs every test of a build; each counts by itself.
suite() {
  local preset="$1" report verdict name outcome before=$failed
  report="$root/build/$preset/junit.xml"
  rm -f "$report"
  note "tests ($preset)"
  ctest --test-dir "$root/build/$preset" -j "$(nproc)" --timeout 900 --output-on-failure \
    --no-tests=error --output-junit "$report"
  outcome=$?
  if [[ ! -s "$report" ]]; then
    fail "tests ($preset) did not run"
    return
  fi
  while read -r verdict name; do
    case "$verdict" in
      pass) passed=$((passed + 1)) ;;
      skip) skipped=$((skipped + 1)) ;;
      *) fail "$preset: $name" ;;
    esac
  done < <(verdicts "$report")
  if ((outcome != 0 && failed == before)); then fail "tests ($preset): ctest ended with $outcome"; fi
}

export NINJA_OPTIONS="-k 0"

check "setup" "$root/scripts/setup.sh"
check "lint: layout (clang-format)" "$root/scripts/lint.sh" format
check "build (release)" build release
check "lint: static analysis (clang-tidy)" "$root/scripts/lint.sh" tidy
suite release
check "build (sanitize)" build sanitize
suite sanitize
check "fuzz: every reader, 10 s each" "$root/scripts/fuzz.sh" 10
finish
