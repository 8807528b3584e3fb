# shellcheck shell=bash
# What shell tests judge with; sourced. `broken` is 1 once something was not as expected.
# shellcheck disable=SC2034  # for those who source it
broken=0

# expect WHAT WANTED FOUND
expect() {
  local what="$1" wanted="$2" found="$3"
  [[ "$found" == "$wanted" ]] && return
  printf '%s: expected "%s", found "%s"\n' "$what" "$wanted" "$found" >&2
  broken=1
}
