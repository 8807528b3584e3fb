#!/usr/bin/env bash
# test.sh: every check of the project. The last line sums them: N passed, N failed[, N skipped].
# test.sh release: the tests of the release build alone, also those that otherwise run under the
# sanitizers only (label `once`, cmake/OffnominalTest.cmake).
# A step that breaks is counted as failed and the next one runs, so the last line is always reached.
set -uo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

passed=0
failed=0
skipped=0
failures=()
durations=()

# begin TITLE, and end: what lies between them is timed.
begin() {
  step="$1"
  step_began=$SECONDS
  note "$step"
}
end() { durations+=("$(printf '%5d s  %s' $((SECONDS - step_began)) "$step")"); }

finish() {
  local name line
  printf '\ntook:\n'
  printf '  %s\n' "${durations[@]}" "$(printf '%5d s  in all, on %d cores' "$SECONDS" "$(nproc)")"
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
  begin "$name"
  if "$@"; then
    passed=$((passed + 1))
  else
    fail "$name"
  fi
  end
}

# One line per test of a JUnit report: pass, fail or skip, how many cases that is, and its name. A test
# that runs several cases of an executable says how many passed and were skipped. CTest calls a test that
# was not built "skipped"; only a test that skipped itself is.
verdicts() {
  awk '
    function tell() {
      if (status == "run") print "pass", (cases == "" ? 1 : cases), name
      else if (status == "disabled") print "skip", 1, name
      else if (status == "notrun") { if (skip != "") print skip, 1, name }
      else {
        if (cases > 0) print "pass", cases, name
        print "fail", 1, name
      }
      if (left_out > 0) print "skip", left_out, name
    }
    /<testcase / {
      match($0, /name="[^"]*"/)
      name = substr($0, RSTART + 6, RLENGTH - 7)
      match($0, /status="[^"]*"/)
      status = substr($0, RSTART + 8, RLENGTH - 9)
      cases = skip = ""
      left_out = 0
    }
    /<skipped message=/ { skip = (/message="SKIP_/ ? "skip" : "fail") }
    status != "notrun" && match($0, /\[  PASSED  \] [0-9]+ test/) { cases = substr($0, RSTART + 13) + 0 }
    status != "notrun" && match($0, /\[  SKIPPED \] [0-9]+ test/) { left_out = substr($0, RSTART + 13) + 0 }
    /<\/testcase>/ { tell() }' "$1"
}

# words_of REPORT NAME: the last that a test said, indented. What failed is told once more at the end: the
# middle of a log of an hour is what is cut off first.
words_of() {
  awk -v name="name=\"$2\"" '
    /<testcase / { asked = index($0, name) > 0 }
    /<system-out>/ { inside = 1; sub(/.*<system-out>/, "") }
    asked && inside { sub(/<\/system-out>.*/, ""); print }
    /<\/system-out>/ { inside = 0 }' "$1" |
    sed 's/&lt;/</g; s/&gt;/>/g; s/&quot;/"/g; s/&amp;/\&/g; s/^/      /' | cut -c 1-400 | tail -n 25
}

# whole REPORT: whether a JUnit report is there to its end.
whole() { grep -qs '</testsuite>' "$1"; }

# suite PRESET [LABEL]: runs every test of a build that needs no CAN bus, but for those of a label; each
# counts by itself.
suite() { run_suite "$1" "tests ($1)" "$(nproc)" -LE "^(bus|real_time${2:+|$2})\$"; }

# bus_suite PRESET: runs the others, all of them in one place with buses.
bus_suite() {
  run_suite "$1" "tests on CAN buses ($1)" 1 -L '^bus$' "$root/scripts/vcan.sh" --controller --timeout 1800 --
}

# real_time_suite PRESET: runs those that need a bus and a clock that nobody makes late.
real_time_suite() {
  run_suite "$1" "tests in real time ($1)" 1 -L '^real_time$' "$root/scripts/vcan.sh" --in machine --clock instructions --timeout 1800 --
}

# run_suite PRESET TITLE JOBS SELECT LABEL [WHERE...]
run_suite() {
  local preset="$1" title="$2" jobs="$3" select=("${@:4:2}") where=("${@:6}")
  local report said verdict name cases outcome before=$failed
  report="$root/build/$preset/junit.xml"
  said="$root/build/$preset/said"
  begin "$title"
  rm -f "$report"
  {
    "${where[@]}" ctest --test-dir "$root/build/$preset" -j "$jobs" "${select[@]}" --timeout 900 \
      --output-on-failure --no-tests=error --output-junit "$report"
    outcome=$?
  } 2> >(tee "$said" >&2)
  wait $!
  end
  if ! whole "$report"; then
    fail "$title did not run to the end (exit code $outcome): $(tail -n 25 "$said")"
    return
  fi
  while read -r verdict cases name; do
    case "$verdict" in
      pass) passed=$((passed + cases)) ;;
      skip) skipped=$((skipped + cases)) ;;
      *) fail "$preset: $name
$(words_of "$report" "$name")" ;;
    esac
  done < <(verdicts "$report")
  if ((outcome != 0 && failed == before)); then fail "$title: ended with $outcome"; fi
}

export NINJA_OPTIONS="-k 0"

case "${1:-}" in
  "") ;;
  release)
    check "setup" "$root/scripts/setup.sh"
    check "build (release)" build release all tested_once
    check "build (firmware)" build_firmware
    suite release
    finish
    ;;
  *) die "test: found '$1', allowed: nothing, or release" ;;
esac

check "setup" "$root/scripts/setup.sh"
check "lint: layout (clang-format)" "$root/scripts/lint.sh" format
check "build (release)" build release
check "build (firmware)" build_firmware
check "lint: static analysis (clang-tidy)" "$root/scripts/lint.sh" tidy
suite release once
bus_suite release
real_time_suite release
check "build (sanitize)" build sanitize
suite sanitize
bus_suite sanitize
check "build (thread)" build thread campaign_test change_test csv_long_test live_test many_joints_test studio_test
suite thread
check "fuzz: the bus's frames, 60 s" "$root/scripts/fuzz.sh" 60 frames
check "fuzz: every reader, 10 s each" "$root/scripts/fuzz.sh" 10
finish
