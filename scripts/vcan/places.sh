# shellcheck shell=bash disable=SC2154,SC2034,SC2054  # vcan.sh has the variables; QEMU likes commas
# The two places where vcan.sh runs a command; sourced by it.

# Environment of this host that means nothing in another kernel: addresses of its sockets.
readonly local_variables='DBUS_SESSION_BUS_ADDRESS|DISPLAY|OLDPWD|SSH_.*|WAYLAND_DISPLAY|XDG_RUNTIME_DIR'

# What `ip -batch` is told, in both places. Room for CAN FD frames in each.
buses() {
  echo link set lo up
  printf 'link add dev %s up mtu 72 type vcan\n' vcan0 vcan1
  if ((controller)); then printf 'link set %s up type can bitrate 1000000\n' can0 can1; fi
}

# supervise SECONDS COMMAND...: runs it with an end; sets $outcome to its exit code, 124 when time is up.
# What ends this script ends the command. $watched may name processes whose end is the command's too.
supervise() {
  local seconds="$1" ended_by='' first
  shift
  # A command in the background of a script would ignore the interrupt for good.
  setpriv --pdeathsig TERM timeout -k 5 "$seconds" env --default-signal=INT,QUIT "$@" </dev/null &
  supervised=$!
  trap 'ended_by=2; kill -TERM "$supervised" 2>/dev/null' INT
  trap 'ended_by=15; kill -TERM "$supervised" 2>/dev/null' TERM
  trap 'ended_by=1; kill -TERM "$supervised" 2>/dev/null' HUP
  outcome=0
  wait -n -p first "$supervised" "${watched[@]}" || outcome=$?
  if [[ "${first:-}" != "$supervised" ]]; then
    # A signal came, or nobody reads the output any more, as after `| head`.
    [[ -n "$ended_by" ]] || ended_by=13
    kill -TERM "$supervised" 2>/dev/null || true
    while kill -0 "$supervised" 2>/dev/null; do wait "$supervised" || true; done
  fi
  trap - INT TERM HUP
  if [[ -n "$ended_by" ]]; then outcome=$((128 + ended_by)); fi
}

# Whether a network of its own with virtual buses can be had; otherwise $native_obstacle says why not.
native_possible() {
  local said
  namespace=(unshare --net --mount)
  if ((EUID == 0)); then
    modprobe -q vcan 2>/dev/null || true
    modprobe -q can-raw 2>/dev/null || true
  else
    namespace=(unshare --user --map-root-user --net --mount)
  fi
  if ! said="$("${namespace[@]}" ip link add dev vcan0 type vcan 2>&1)"; then
    native_obstacle="${said:-ip link add type vcan failed}"
    return 1
  fi
  if ! grep -q '^CAN_RAW ' /proc/net/protocols && ! modprobe -nq can-raw 2>/dev/null; then
    native_obstacle='the kernel has no can-raw'
    return 1
  fi
}

run_natively() {
  watched=()
  # The tree under /sys shows the network of whoever has mounted it.
  # shellcheck disable=SC2016  # for the inner shell
  supervise "$timeout_s" "${namespace[@]}" bash -c '
    mount -t sysfs sys /sys 2>/dev/null || true
    ip -batch /dev/stdin <<<"$1" || exit 125
    shift
    exec "$@"' vcan "$(buses)" "$@"
  if ((outcome == 124)); then printf 'vcan: time is up: ended after %s s\n' "$timeout_s" >&2; fi
  exit "$outcome"
}

# What the machine runs in the tree of the host, in the words of bash.
write_job() {
  printf 'export PATH=%q\nip -batch /dev/stdin <<<%q || exit 125\n' "$PATH" "$(buses)"
  printf 'echo running the command >/dev/job/stage\n'
  umask -p
  (
    # shellcheck disable=SC2046  # names, split on purpose
    unset -v $(compgen -e | grep -xE "$local_variables")
    export -p
  )
  printf 'cd %q || exit 125\nexec' "$PWD"
  printf ' %q' "$@"
  printf '\n'
}

# shellcheck disable=SC2317  # run by the trap
forget_job() {
  if ((keep)); then
    printf 'vcan: kept: %s\n' "$job" >&2
  else
    rm -rf "$job"
  fi
}

check_tools() {
  local tool tools=(qemu-system-x86_64 busybox cpio depmod ip)
  type -P "${tools[@]}" >/dev/null && return 0
  "$here/setup.sh" vcan
  hash -r
  for tool in "${tools[@]}"; do
    type -P "$tool" >/dev/null || die "vcan: $tool is missing; scripts/packages.txt names the package it comes from"
  done
}

run_in_machine() {
  local image machine
  check_tools
  find_image
  job="$(mktemp -d "${TMPDIR:-/tmp}/vcan.XXXXXX")"
  trap forget_job EXIT
  write_job "$@" >"$job/job.sh"
  mkfifo "$job/out" "$job/err"
  cat "$job/out" &
  watched=($!)
  cat "$job/err" >&2 &
  watched+=($!)
  # Held open until the machine has ended: a machine that never wrote ends their readers all the same.
  exec {out}>"$job/out" {err}>"$job/err"

  machine=(
    qemu-system-x86_64 -nodefaults -no-user-config -display none -no-reboot
    -accel "${accel:-tcg}" -cpu max -smp "${cpus:-2}" -m "$memory_mib"
    -kernel "$image/kernel" -initrd "$image/initramfs"
    -append "console=ttyS0 quiet panic=-1 mitigations=off controller=$controller"
    -chardev "file,id=console,path=${job//,/,,}/console" -serial chardev:console
    -virtfs local,path=/,mount_tag=root,security_model=none,multidevs=remap
    -virtfs "local,path=${job//,/,,},mount_tag=job,security_model=none"
    -device virtio-serial
    -chardev "file,id=out,path=${job//,/,,}/out" -device virtserialport,chardev=out,name=out
    -chardev "file,id=err,path=${job//,/,,}/err" -device virtserialport,chardev=err,name=err
  )
  # Asleep, the machine's time goes straight on to what it waits for.
  if [[ "$clock" == instructions ]]; then machine+=(-icount shift=0,sleep=off); fi
  if ((controller)); then
    machine+=(-object can-bus,id=bus)
    machine+=(-device kvaser_pci,canbus=bus -device kvaser_pci,canbus=bus)
  fi
  supervise "$timeout_s" "${machine[@]}" >"$job/qemu" 2>&1
  exec {out}>&- {err}>&-
  wait "${watched[@]}" || true
  finish_machine
}

# The machine has ended: with an exit code of the command, or because it was made to, or it broke.
finish_machine() {
  local stage=starting
  if [[ -e "$job/stage" ]]; then stage="$(<"$job/stage")"; fi
  if [[ -s "$job/exit_code" ]]; then exit "$(<"$job/exit_code")"; fi
  if ((outcome == 124)); then
    printf 'vcan: time is up: the machine was ended after %s s, while %s\n' "$timeout_s" "$stage" >&2
    exit 124
  fi
  if ((outcome > 128)); then exit "$outcome"; fi
  {
    printf 'vcan: the machine broke while %s (QEMU ended with %s). It said last:\n' "$stage" "$outcome"
    cat "$job/qemu"
    tail -n 20 "$job/console" 2>/dev/null
  } >&2
  exit 125
}
