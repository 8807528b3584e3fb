# shellcheck shell=bash disable=SC2154  # vcan.sh has the variables
# Kernel and first file system of the machine, made once and kept outside of the tree; sourced by vcan.sh.
# The kernel is Debian's with PREEMPT_RT: downloaded and unpacked, never installed.

kernel_package=linux-image-rt-amd64
# What the machine loads, in the words of modprobe; their dependencies come along.
kernel_modules=(virtio_pci virtio_console 9pnet_virtio 9p can-raw vcan kvaser_pci sch_plug)

# The package that holds the kernel, and its version, or nothing where apt knows none.
kernel_candidate() {
  local holder
  holder="$(apt-cache depends "$kernel_package" 2>/dev/null | awk '/Depends: linux-image/ {print $2; exit}')"
  [[ -n "$holder" ]] || return 1
  apt-cache show --no-all-versions "$holder" 2>/dev/null |
    awk -v holder="$holder" '/^Version:/ {print holder, $2; exit}'
}

# make_image DIRECTORY PACKAGE: DIRECTORY/kernel and DIRECTORY/initramfs.
make_image() {
  local into="$1" package="$2" version module path
  # As root, apt says that it could not become another user; it is of no use here.
  (cd "$into" && apt-get download -q -o APT::Sandbox::User=root "$package") >&2 || return 1
  dpkg -x "$into"/*.deb "$into/unpacked" || return 1
  version="$(ls "$into/unpacked/lib/modules")"
  depmod -b "$into/unpacked" "$version" || return 1

  mkdir -p "$into/first"/{bin,dev,host,job,modules,proc,sys} || return 1
  cp "$(static_busybox)" "$into/first/bin/busybox" || return 1
  install -m 755 "$here/vcan/init.sh" "$into/first/init" || return 1
  for module in "${kernel_modules[@]}"; do
    modprobe -d "$into/unpacked" -S "$version" --show-depends "$module" || return 1
  done | awk '$1 == "insmod" && !seen[$2]++ {print $2}' >"$into/paths"
  while read -r path; do
    cp "$path" "$into/first/modules/" || return 1
    basename "$path"
  done <"$into/paths" >"$into/first/modules/order"
  (cd "$into/first" && find . | cpio --quiet -o -H newc -R 0:0) >"$into/initramfs" || return 1
  plain_kernel "$into/unpacked/boot/vmlinuz-$version" >"$into/kernel"
}

# The kernel unpacked, or as it is where it is not packed with xz: it would unpack itself in the machine,
# which takes 3 s there and a tenth of that here.
plain_kernel() {
  local packed="$1" at
  at="$(LC_ALL=C grep -abom1 $'\xfd7zXZ' "$packed" | head -n 1 | cut -d: -f1)"
  # What follows the packed part in the file is none of xz's business, and its only complaint.
  if [[ -n "$at" ]] && { tail -c "+$((at + 1))" "$packed" | xz -dc 2>/dev/null || true; } >"$packed.plain" &&
    [[ "$(head -c 4 "$packed.plain" | tail -c 3)" == ELF ]]; then
    cat "$packed.plain"
  else
    cat "$packed"
  fi
}

static_busybox() {
  local found
  found="$(command -v busybox)" || die "busybox is missing (package busybox-static)"
  if ldd "$found" >/dev/null 2>&1; then
    die "$found is linked dynamically and cannot start a machine; package busybox-static can"
  fi
  echo "$found"
}

# Names in $image the folder of a kernel and a first file system, makes it when there is none.
find_image() {
  local cache recipe known=() package='' version='' work
  cache="$(cache_dir)/vcan"
  recipe="$(cat "$here/vcan/image.sh" "$here/vcan/init.sh" | sha256sum | cut -c1-12)"
  mkdir -p "$cache" || die "$cache: the folder for the machine's kernel cannot be made (XDG_CACHE_HOME names another)"

  read -r package version < <(kernel_candidate) || true
  if [[ -n "$version" ]]; then
    image="$cache/${package}_${version}_$recipe"
    [[ -e "$image/initramfs" ]] && return 0
  else
    # Without lists of packages, the youngest kernel that has been fetched before is as good.
    mapfile -t known < <(ls -td "$cache"/*_"$recipe" 2>/dev/null)
    if ((${#known[@]} > 0)); then
      image="${known[0]}"
      return 0
    fi
    note "vcan: asking for the list of packages"
    as_root apt-get update -q >&2 || die "apt-get update failed, and no kernel for the machine is in $cache"
    read -r package version < <(kernel_candidate) || die "apt knows no package $kernel_package"
    image="$cache/${package}_${version}_$recipe"
  fi

  exec {lock}>"$cache/lock"
  flock "$lock"
  rm -rf "$cache"/making.* # of a caller that was killed: nobody else is at it
  if [[ ! -e "$image/initramfs" ]]; then
    note "vcan: fetching $package $version for the machine (once, 70 MB)"
    work="$(mktemp -d "$cache/making.XXXXXX")"
    if ! make_image "$work" "$package"; then
      rm -rf "$work"
      die "the machine's kernel could not be fetched and unpacked"
    fi
    rm -rf "$work"/{unpacked,first,paths} "$work"/*.deb
    chmod 755 "$work"
    rm -rf "$image"
    mv -T "$work" "$image"
  fi
  exec {lock}>&-
}
