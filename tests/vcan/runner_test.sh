#!/usr/bin/env bash
# runner_test.sh CASE: one promise of scripts/vcan.sh.
# shellcheck disable=SC2317  # the cases are called by name
set -uo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
vcan="$root/scripts/vcan.sh"
work="$(mktemp -d "${TMPDIR:-/tmp}/vcan test,.XXXXXX")"
trap 'rm -rf "$work"' EXIT
# shellcheck source=tests/support/expect.sh
source "$root/tests/support/expect.sh"

# How many machines run whose folder lies here. QEMU wants commas doubled.
machines() {
  local process found=0
  for process in /proc/[0-9]*; do
    tr '\0' ' ' 2>/dev/null <"$process/cmdline" | grep -qF "qemu-system-x86_64 " || continue
    if tr '\0' ' ' 2>/dev/null <"$process/cmdline" | grep -qF "${work//,/,,}/"; then found=$((found + 1)); fi
  done 2>/dev/null
  echo "$found"
}

hands_back() {
  local quick code
  # Whoever is first on this computer is told of the kernel that is fetched.
  "$vcan" --in machine true 2>/dev/null
  # Another caller at the same time has a machine of its own.
  "$vcan" --in machine bash -c 'echo second; exit 5' >"$work/second" 2>&1 &
  quick=$!
  # A program: every byte there is, and a million of them.
  cp /bin/bash "$work/bytes"
  export VCAN_TEST=$'a "quoted"\nvalue'
  # shellcheck disable=SC2016  # for the shell inside
  (cd "$work" && "$vcan" --in machine bash -c '
    cat bytes
    echo again >/dev/stdout
    printf "to stderr: %s|%s|%s|%s" "$VCAN_TEST" "$PWD" "$(cat)" "$1" >&2
    cat /sys/class/net/vcan0/mtu /sys/class/net/vcan1/flags >found
    sleep 1000 & exit 37' shell 'an  argument') >"$work/out" 2>"$work/err"
  expect "exit code" 37 $?
  echo again >>"$work/bytes"
  cmp "$work/bytes" "$work/out" || broken=1
  expect "standard error" "to stderr: $VCAN_TEST|$work||an  argument" "$(<"$work/err")"
  expect "buses, seen in a file that the command wrote" $'72\n0x81' "$(<"$work/found")"
  wait "$quick"
  code=$?
  expect "exit code of the second caller" 5 "$code"
  expect "output of the second caller" second "$(<"$work/second")"
}

# The machine keeps what is written in memory for a while: none of it may be lost where it ends at once.
writes_back() {
  head -c 60000000 /dev/urandom >"$work/read"
  "$vcan" --in machine cp "$work/read" "$work/written" 2>"$work/err"
  expect "exit code" 0 $?
  cmp "$work/read" "$work/written" || broken=1
  if ((broken)); then cat "$work/err" >&2; fi
}

time_up() {
  TMPDIR="$work" "$vcan" --in machine --timeout 2 sleep 1000 >"$work/out" 2>"$work/err"
  expect "exit code" 124 $?
  expect "standard output" '' "$(<"$work/out")"
  [[ "$(tail -n 1 "$work/err")" == "vcan: time is up: the machine was ended after 2 s, while "* ]] ||
    expect "standard error" 'time is up ...' "$(<"$work/err")"
  expect "machines left" 0 "$(machines)"
}

terminated() {
  local runner left
  TMPDIR="$work" "$vcan" --in machine sleep 1000 >"$work/out" 2>"$work/err" &
  runner=$!
  until (($(machines) > 0)); do
    kill -0 "$runner" || break
    sleep 0.1
  done
  kill -TERM "$runner"
  wait "$runner"
  expect "exit code" 143 $?
  expect "machines left" 0 "$(machines)"
  left=("$work"/vcan.*)
  expect "folders left" 0 "$([[ -e "${left[0]}" ]] && echo "${#left[@]}" || echo 0)"
}

# As after `| head`: nobody reads the output any more, and the command writes without end.
output_closed() {
  TMPDIR="$work" "$vcan" --in machine --timeout 120 yes 2>"$work/err" | head -n 1 >"$work/out"
  expect "exit code" 141 "${PIPESTATUS[0]}"
  expect "machines left" 0 "$(machines)"
}

# Two hours of waiting pass at once, and are two hours in there: time owes nothing to this host. But what
# the machine reads from the host for the first time it waits for, and in waiting its clock runs ahead, to
# the next timer of the kernel: a program that is started in between cost ten seconds of it on a busy host.
# So the shell itself waits, and has done all of it once before.
clock_of_instructions() {
  local before after
  # shellcheck disable=SC2016  # for the shell inside
  "$vcan" --in machine --clock instructions --timeout 300 bash -c '
    exec {silent}<> <(:)
    for seconds in 0.1 7200; do
      read -r before _ </proc/uptime
      read -rt "$seconds" -u "$silent" _
      read -r after _ </proc/uptime
    done
    echo "$before $after"' >"$work/out" 2>"$work/err"
  expect "exit code" 0 $?
  read -r before after <"$work/out"
  awk -v before="$before" -v after="$after" 'BEGIN {exit !(after - before >= 7200 && after - before < 7201)}' ||
    expect "seconds in the machine" "7200 to 7201" "$before to $after"
}

refused() {
  "$vcan" "$@" >"$work/out" 2>"$work/err"
  expect "exit code of: $*" 2 $?
  [[ -s "$work/err" && ! -s "$work/out" ]] || expect "output of: $*" 'a message' "$(<"$work/out")"
}

arguments() {
  refused
  refused --no-such-option true
  refused --timeout
  refused --timeout soon true
  refused --memory 8 true
  refused --in space true
  refused --in native --controller true
  refused --clock sun true
  refused --clock instructions --in native true
  refused --clock instructions --cpus 2 true
  refused --clock instructions --accel kvm true
  "$vcan" --help | grep -q -- --controller
  expect "exit code of --help" 0 $?
}

native() {
  # shellcheck disable=SC2016  # for the shell inside
  "$vcan" --in native bash -c '
    cat /sys/class/net/vcan0/mtu
    ls /sys/class/net | tr "\n" " "
    ip link add dev mine type vcan
    echo apart >&2
    exit 9' >"$work/out" 2>"$work/err"
  expect "exit code" 9 $?
  expect "buses" $'72\nlo vcan0 vcan1 ' "$(<"$work/out")"
  expect "standard error" apart "$(<"$work/err")"
  ip link show dev mine >/dev/null 2>&1
  expect "exit code of looking for its network outside" 1 $?
}

case "${1:-}" in
  hands_back | writes_back | time_up | terminated | output_closed | clock_of_instructions | arguments | native) "$1" ;;
  *)
    echo "no case ${1:-}" >&2
    exit 2
    ;;
esac
exit "$broken"
