#!/usr/bin/env bash
# vcan.sh [OPTION...] COMMAND...: runs a command where there are CAN buses; ./dev vcan --help.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
here="$root/scripts"
# shellcheck source=scripts/vcan/image.sh
source "$here/vcan/image.sh"
# shellcheck source=scripts/vcan/places.sh
source "$here/vcan/places.sh"

# Where Debian has ip, modprobe and depmod, and ordinary users have not looked.
export PATH="$PATH:/usr/sbin:/sbin"

usage() {
  cat <<'TEXT'
./dev vcan [OPTION...] COMMAND...

Runs COMMAND where there are two virtual CAN buses, vcan0 and vcan1, that nobody else uses: natively
where the kernel has them, otherwise in a throw-away QEMU machine over the tree of this host. The
working directory, the environment, the output and the exit code are those of an ordinary call; the
standard input is empty.

  --controller        also can0 and can1: two emulated controllers (kvaser_pci) on one bus at 1 Mbit/s,
                      with the kernel's own driver; always in the machine
  --in native|machine where to run it [native if possible]
  --timeout SECONDS   ends the command and what it has started [600]
  --memory MIB        of the machine [2048]
  --cpus N            of the machine [2]
  --accel tcg|kvm     how QEMU runs the machine [tcg]; kvm is quicker where it works
  --clock host|instructions
                      what the machine's time is, if it is one [host]. With instructions it has one CPU
                      that takes a nanosecond for each, and nothing is late because this host is busy
  --keep              keep what the machine was given and what it said, and say where it is
  --verbose           say on the standard error where the command runs

Exit codes: the command's own; 2 wrong arguments or something missing; 124 time is up; 125 the machine
broke. docs/vcan.md has the rest.
TEXT
}

controller=0
where=any
timeout_s=600
memory_mib=2048
cpus=''
accel=''
clock=host
keep=0
verbose=0

# number OPTION FOUND LEAST
number() {
  if ! [[ "$2" =~ ^[1-9][0-9]{0,6}$ ]] || (($2 < $3)); then
    die "vcan: $1: found '$2', allowed: a whole number from $3"
  fi
}

one_of() {
  local option="$1" found="$2"
  shift 2
  [[ " $* " == *" $found "* ]] || die "vcan: $option: found '$found', allowed: $*"
}

while (($# > 0)); do
  case "$1" in
    --controller) controller=1 ;;
    --keep) keep=1 ;;
    --verbose) verbose=1 ;;
    --in | --timeout | --memory | --cpus | --accel | --clock)
      (($# > 1)) || die "vcan: $1 needs a value"
      case "$1" in
        --in) one_of "$1" "$2" native machine && where="$2" ;;
        --timeout) number "$1" "$2" 1 && timeout_s="$2" ;;
        --memory) number "$1" "$2" 512 && memory_mib="$2" ;;
        --cpus) number "$1" "$2" 1 && cpus="$2" ;;
        --accel) one_of "$1" "$2" tcg kvm && accel="$2" ;;
        --clock) one_of "$1" "$2" host instructions && clock="$2" ;;
      esac
      shift
      ;;
    --help | -h)
      usage
      exit 0
      ;;
    --)
      shift
      break
      ;;
    -*) die "vcan: no option $1; ./dev vcan --help lists them" ;;
    *) break ;;
  esac
  shift
done
(($# > 0)) || die "vcan: no command; ./dev vcan --help"
if ((controller)) && [[ "$where" == native ]]; then
  die "vcan: --controller and --in native exclude each other: the controllers are emulated by the machine"
fi
if [[ "$clock" == instructions ]]; then
  [[ "$where" != native ]] || die "vcan: --clock instructions and --in native exclude each other: QEMU counts them"
  [[ "${accel:-tcg}" == tcg ]] || die "vcan: --clock instructions and --accel $accel exclude each other: tcg counts them"
  ((${cpus:-1} == 1)) || die "vcan: --cpus: found '$cpus', allowed with --clock instructions: 1"
  cpus=1
fi

say() {
  if ((verbose)); then printf 'vcan: %s\n' "$*" >&2; fi
}

if [[ "$where" != machine ]] && ((!controller)) && native_possible; then
  say "natively"
  run_natively "$@"
elif [[ "$where" == native ]]; then
  die "vcan: no virtual CAN bus can be made here: $native_obstacle"
else
  say "in a QEMU machine"
  run_in_machine "$@"
fi
