#!/usr/bin/env bash
# mutate_test.sh CASE: one promise of scripts/mutate.
# shellcheck disable=SC2317  # the cases are called by name
set -uo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
work="$(mktemp -d "${TMPDIR:-/tmp}/mutate,test.XXXXXX")"
project="$work/project"
trap 'rm -rf "$work"' EXIT
export TMPDIR="$work/tmp"
# shellcheck source=tests/support/expect.sh
source "$root/tests/support/expect.sh"

# A header whose upper bound nobody tries, and a test of it that ninja builds.
make_project() {
  mkdir -p "$TMPDIR" "$project/include" "$project/tests" "$project/build/tests"
  cat >"$project/include/limits.hpp" <<'CODE'
#pragma once
// a < b in a comment is none
#include <span>

template <int N, typename T>
constexpr T limited(T value, T low, T high) {
  static_assert(N > 0, "a > b");
  if (value < low) return low;
  if (value > high) {
    return high;
  }
  return value;
}

inline int sum(std::span<const int> values) {
  int total = 0;
  for (const int value : values) total += value;
  for (int i = 0; i < 2; ++i) total += 1;
  return total;
}
CODE
  cat >"$project/tests/limits_test.cpp" <<'CODE'
#include <limits.hpp>

static_assert(limited<1>(5, 7, 9) == 7);

int main() {
  const int values[] = {1, 2};
  return limited<1>(8, 7, 9) == 8 && sum(values) == 5 ? 0 : 1;
}
CODE
  cat >"$project/build/build.ninja" <<CODE
rule compile
  command = c++ -std=c++20 -I$project/include -MD -MT \$out -MF \$out.d -o \$out -c \$in
rule link
  command = : && c++ \$in -o \$out && :
build tests/limits.o: compile $project/tests/limits_test.cpp
build tests/limits: link tests/limits.o
CODE
  : >"$work/reasons"
}

mutate() {
  node "$root/scripts/mutate/mutate.mjs" --root "$project" --build "$project/build" --reasons "$work/reasons" "$@" \
    >"$work/out" 2>"$work/err"
}

reason() { printf 'include/limits.hpp\n- %s\n+ %s\nWhy not.\n\n' "$1" "$2" >>"$work/reasons"; }

reasons_of_all() {
  reason 'if (value < low) return low;' 'if (value <= low) return low;'
  reason 'if (value > high) {' 'if (false) {'
  reason 'if (value > high) {' 'if (value >= high) {'
  reason 'return high;' 'return {};'
}

# What is seen at run time, at compile time and by its time; what is not; the tree stays as it was.
finds() {
  cp -r "$project" "$work/before"
  mutate "$project/include/limits.hpp"
  expect "exit code" 1 $?
  expect "survivors" "$(
    cat <<'TEXT'
include/limits.hpp:8: no test sees
  - if (value < low) return low;
  + if (value <= low) return low;
include/limits.hpp:9: no test sees
  - if (value > high) {
  + if (false) {
include/limits.hpp:9: no test sees
  - if (value > high) {
  + if (value >= high) {
include/limits.hpp:10: no test comes by
  - return high;
  + return {};
TEXT
  )" "$(grep -v '^include/limits.hpp: ' "$work/out")"
  expect "sum" "include/limits.hpp: 25 errors, 19 caught, 2 do not compile, 4 survive, 0 of them for a reason" \
    "$(tail -n 1 "$work/out")"
  rm -f "$project/build/.ninja_log" "$project/build/.ninja_deps"
  diff -r "$work/before" "$project" || broken=1
  expect "files left" '' "$(ls "$TMPDIR")"
}

accepts() {
  reasons_of_all
  mutate "$project/include/limits.hpp"
  expect "exit code with a reason for each" 0 $?
  # One of them is seen, and one is not there any more.
  reason 'if (value < low) return low;' 'if (value >= low) return low;'
  reason 'if (value < lowest) return low;' 'if (value <= lowest) return low;'
  # A machine with less to do may have the time.
  reason 'for (int i = 0; i < 2; ++i) total += 1;' 'for (int i = 0; i < 2; --i) total += 1;'
  mutate "$project/include/limits.hpp"
  expect "exit code with stale reasons" 1 $?
  expect "stale reasons" 2 "$(grep -c 'a reason for what is not there, or is seen' "$work/out")"
  mutate --line 1-9 "$project/include/limits.hpp"
  expect "exit code where only a part was tried" 0 $?
}

lists() {
  mutate --list --line 9 "$project/include/limits.hpp"
  expect "exit code" 0 $?
  expect "errors of line 9" "$(
    cat <<'TEXT'
include/limits.hpp:9:
  - if (value > high) {
  + if (false) {
include/limits.hpp:9:
  - if (value > high) {
  + if (true) {
include/limits.hpp:9:
  - if (value > high) {
  + if (value >= high) {
include/limits.hpp:9:
  - if (value > high) {
  + if (value <= high) {
include/limits.hpp: 4 errors
TEXT
  )" "$(<"$work/out")"
  mutate --json --line 8 "$project/include/limits.hpp"
  expect "outcomes of line 8" 'refused caught survived caught refused' \
    "$(node -p 'JSON.parse(fs.readFileSync(0))[0].errors.map((e) => e.outcome).join(" ")' <"$work/out")"
}

limits() {
  mutate --most 2 "$project/include/limits.hpp"
  expect "exit code" 0 $?
  expect "sum" "include/limits.hpp: 2 errors, 1 caught, 1 do not compile, 0 survive, 0 of them for a reason" \
    "$(tail -n 1 "$work/out")"
}

refuses() {
  local arguments
  printf 'int unused = 1;\n' >"$project/include/unused.hpp"
  printf 'int f( {\n' >"$project/include/broken.hpp"
  for arguments in '' "--most 0 $project/include/limits.hpp" "--line x $project/include/limits.hpp" \
    "$project/include/none.hpp" "$project/include/unused.hpp" "$project/include/broken.hpp" "--odd x" /etc/passwd; do
    # shellcheck disable=SC2086  # words
    IFS=' ' mutate ${arguments//"$project"/.}
    expect "exit code of $arguments" 2 $?
    expect "lines said of $arguments" 1 "$(wc -l <"$work/err")"
  done
  echo odd >"$work/reasons"
  mutate --list "$project/include/limits.hpp"
  expect "exit code of reasons that are none" 2 $?
  expect "lines said of them" 1 "$(wc -l <"$work/err")"
  : >"$work/reasons"
  sed -i 's/sum(values) == 5/sum(values) == 6/' "$project/tests/limits_test.cpp"
  mutate "$project/include/limits.hpp"
  expect "exit code where the test fails by itself" 2 $?
}

# GIVEN a test that does not end WHEN the whole is ended THEN nothing of it is left.
endless() {
  sed -i 's/^int main() {/&\n  for (volatile int i = 0;; i = 0) {\n  }/' "$project/tests/limits_test.cpp"
  node "$root/scripts/mutate/mutate.mjs" --root "$project" --build "$project/build" --reasons "$work/reasons" \
    "$project/include/limits.hpp" >"$work/out" 2>"$work/err" &
  runner=$!
  until compgen -G "$TMPDIR/*/together/program" >/dev/null && pgrep -f "^$TMPDIR/.*/together/program" >/dev/null; do
    kill -0 "$runner" || break
    sleep 0.1
  done
}

# A program that is told to end takes a moment.
expect_no_program() {
  for _ in {1..100}; do
    pgrep -f "^$TMPDIR/.*/together/program" >/dev/null || break
    sleep 0.1
  done
  expect "programs left" '' "$(pgrep -f "^$TMPDIR/.*/together/program")"
}

terminated() {
  endless
  kill -TERM "$runner"
  wait "$runner"
  expect "exit code" 143 $?
  expect "files left" '' "$(ls "$TMPDIR")"
  expect_no_program
}

# What is killed cannot clear away, the next one does; its programs end with it.
killed() {
  endless
  kill -KILL "$runner"
  wait "$runner" 2>/dev/null
  expect_no_program
  sed -i '/volatile/,+1d' "$project/tests/limits_test.cpp"
  mutate --most 1 "$project/include/limits.hpp"
  expect "exit code of the next one" 0 $?
  expect "files left" '' "$(ls "$TMPDIR")"
}

# Every source of the project is understood, and no error is one that its own line does not hold.
whole_language() {
  (cd "$root" && git ls-files -z '*.hpp' '*.cpp' | xargs -0 node "$root/scripts/mutate/mutate.mjs" --root "$root" \
    --build "$project/build" --reasons "$work/reasons" --list) >"$work/out" 2>"$work/err"
  expect "exit code" 0 $?
  expect "standard error" '' "$(<"$work/err")"
}

# An error of another type than what it stands beside is set apart, and the others are tried.
other_types() {
  cat >"$project/include/limits.hpp" <<'CODE'
#pragma once
struct Metres {
  int value;
};
struct Seconds {
  int value;
};
struct Limits {
  static constexpr Metres kFar{3};
  static constexpr Seconds kLong{5};
};
inline int reach() {
  const Metres far = Limits::kFar;
  return far.value;
}
inline int patience() {
  const Seconds seconds = Limits::kLong;
  return seconds.value;
}
CODE
  cat >"$project/tests/limits_test.cpp" <<'CODE'
#include <limits.hpp>

int main() { return reach() == 3 && patience() == 5 ? 0 : 1; }
CODE
  mutate --json "$project/include/limits.hpp"
  expect "exit code" 0 $?
  expect "those that do not compile" "$(
    cat <<'TEXT'
const Metres far = Limits::kLong;
const Seconds seconds = Limits::kFar;
TEXT
  )" "$(node -e 'for (const { outcome, after } of JSON.parse(require("fs").readFileSync(0))[0].errors)
    if (outcome === "refused") console.log(after);' <"$work/out")"
}

make_project
"$1"
if ((broken)); then cat "$work/out" "$work/err" >&2; fi
exit "$broken"
