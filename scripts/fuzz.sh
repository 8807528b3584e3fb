#!/usr/bin/env bash
# Fuzzes every reader for so many seconds each, from the corpus in the tree. What it finds on its way
# stays in build/fuzz/found; an input that breaks a reader is named and ends with exit code 1.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

seconds="${1:-60}"
[[ "$seconds" =~ ^[1-9][0-9]*$ ]] || die "seconds: found $seconds, allowed: a whole number from 1"
build fuzz
broken=0
# matio asks for whatever a damaged header claims; that it gets nothing is part of what is tried.
export ASAN_OPTIONS=allocator_may_return_null=1
for reader in csv mat log dbc robot channels frames; do
  note "fuzz: $reader, $seconds s"
  found="$root/build/fuzz/found/$reader"
  corpus="$root/tests/fuzz/corpus/$reader"
  mkdir -p "$found"
  if [[ "$reader" == mat ]]; then
    corpus="$root/build/fuzz/corpus-mat"
    mkdir -p "$corpus"
    "$root/build/fuzz/tests/fuzz/write_mat_corpus" "$corpus"
  fi
  "$root/build/fuzz/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 \
    -malloc_limit_mb=65536 -max_len=20000 -print_final_stats=1 -seed=1 -artifact_prefix="$root/build/fuzz/broken-$reader-" \
    "$found" "$corpus" >"$root/build/fuzz/$reader.log" 2>&1 || broken=1
  grep -E 'stat::number_of_executed_units|ERROR|SUMMARY|broken-' "$root/build/fuzz/$reader.log" || true
done
exit "$broken"
