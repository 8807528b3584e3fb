#!/usr/bin/env bash
# demo.sh OFFNOMINAL: the paper reproduced, then a model of a real machine improved effect by effect.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

offnominal="$1"
recordings="${OFFNOMINAL_DATA:+$(realpath -m "$OFFNOMINAL_DATA")/emps}"
cd "$root" # short names in what the command prints
recordings="${recordings:-../shared/data/emps}"
out=build/demo
fitted="$recordings/DATA_EMPS.mat"
validation="$recordings/DATA_EMPS_PULSES.mat"
pages=()

heading() { printf '\n%s\n%s\n' "$1" "${1//?/=}"; }

paper() {
  heading "The paper's section 5"
  "$offnominal" paper --report "$out/paper.html"
  pages+=("$out/paper.html")
}

# relative_error LOG ROBOT: percent, of the one joint that EMPS has.
relative_error() {
  "$offnominal" compare "$1" --robot "$2" --json |
    grep -o '"relative_error_percent": *[0-9.eE+-]*' | head -n 1 | sed 's/.*: *//'
}

# judge NAME ROBOT WORDS: compares a model with both recordings, a page for each, and keeps the line
# of the chain.
judge() {
  local name="$1" robot="$2" words="$3" here there
  "$offnominal" compare "$fitted" --robot "$robot" --report "$out/emps_$name.html"
  "$offnominal" compare "$validation" --robot "$robot" --report "$out/emps_${name}_validation.html"
  pages+=("$out/emps_$name.html" "$out/emps_${name}_validation.html")
  here="$(relative_error "$fitted" "$robot")"
  there="$(relative_error "$validation" "$robot")"
  chain+=("$(LC_ALL=C printf '%-32s %8.2f %% %10.2f %%' "$words" "$here" "$there")")
}

# improve EFFECT FROM TO: robot files by name.
improve() {
  "$offnominal" add "$1" --joint 1 --robot "$2" --log "$fitted" --holdout "$validation" -o "$3"
}

emps() {
  heading "A real machine: EMPS, one prismatic joint"
  if [[ ! -f "$fitted" || ! -f "$validation" ]]; then
    printf 'Left out: %s\nand %s\nare not there. OFFNOMINAL_DATA names the folder that holds emps/.\n' \
      "$fitted" "$validation"
    return 0
  fi
  local chain=()
  judge 1_inertia robots/emps.toml "inertia only"

  improve viscous_friction robots/emps.toml "$out/emps_viscous.toml"
  judge 2_viscous "$out/emps_viscous.toml" "+ viscous friction"

  improve coulomb_friction "$out/emps_viscous.toml" "$out/emps_coulomb.toml"
  improve torque_offset "$out/emps_coulomb.toml" "$out/emps_offset.toml"
  judge 3_coulomb "$out/emps_offset.toml" "+ Coulomb friction and offset"

  improve friction_asymmetry "$out/emps_offset.toml" "$out/emps_asymmetry.toml"
  judge 4_asymmetry "$out/emps_asymmetry.toml" "+ asymmetry of the friction"

  heading "Force error of EMPS, relative to the measured force"
  printf '%-32s %10s %12s\n' model "fitted on" "never seen"
  printf '%s\n' "${chain[@]}"
  printf '\nThe same by hand, in four clicks that a guided tour leads through:\n'
  printf '  ./dev studio %s --holdout %s --robot robots/emps.toml -o build/emps_studio.toml\n' "$fitted" "$validation"
}

mkdir -p "$out"
rm -f "$out"/*.html "$out"/*.toml
paper
emps
printf '\nPages written:\n'
printf '  %s\n' "${pages[@]/#/$root/}"
