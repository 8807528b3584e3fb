#!/usr/bin/env bash
# fuzz.sh [SECONDS [READER...]]: fuzzes each of these readers, or all, for so many seconds, as many at a
# time as there are processors, from the corpus in the tree. What it finds on its way stays in
# build/fuzz/found; an input that breaks a reader is named and ends with exit code 1.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

readers=(csv mat log dbc robot channels urdf dh frames)
seconds="${1:-60}"
[[ "$seconds" =~ ^[1-9][0-9]*$ ]] || die "fuzz: seconds: found '$seconds', allowed: a whole number from 1"
wanted=("${@:2}")
if ((${#wanted[@]} == 0)); then wanted=("${readers[@]}"); fi
for reader in "${wanted[@]}"; do
  [[ " ${readers[*]} " == *" $reader "* ]] || die "fuzz: reader: found '$reader', allowed: ${readers[*]}"
done
build fuzz

# fuzz_one READER
fuzz_one() {
  local reader="$1" found="$root/build/fuzz/found/$1" corpus="$root/tests/fuzz/corpus/$1" outcome=0
  mkdir -p "$found"
  if [[ "$reader" == mat ]]; then
    corpus="$root/build/fuzz/corpus-mat"
    mkdir -p "$corpus"
    "$root/build/fuzz/tests/fuzz/write_mat_corpus" "$corpus"
  fi
  "$root/build/fuzz/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 \
    -malloc_limit_mb=65536 -max_len=20000 -print_final_stats=1 -seed=1 -artifact_prefix="$root/build/fuzz/broken-$reader-" \
    "$found" "$corpus" >"$root/build/fuzz/$reader.log" 2>&1 || outcome=1
  {
    printf 'fuzz: %s, %s s\n' "$reader" "$seconds"
    grep -E 'stat::number_of_executed_units|ERROR|SUMMARY|broken-' "$root/build/fuzz/$reader.log" || true
  } >&2
  return "$outcome"
}
export -f fuzz_one
export root seconds
# matio asks for whatever a damaged header claims; that it gets nothing is part of what is tried.
export ASAN_OPTIONS=allocator_may_return_null=1
# shellcheck disable=SC2016  # for the inner shell
printf '%s\0' "${wanted[@]}" | xargs -0 -P "$(jobs_allowed)" -I {} bash -euo pipefail -c 'fuzz_one "$1"' fuzz {} || exit 1
