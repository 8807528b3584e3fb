#!/bin/busybox sh
# shellcheck shell=dash
# First process of the machine that scripts/vcan.sh boots: loads the modules, lays the host's tree under
# /host, brings the buses up, runs the job inside that tree, hands its output and its exit code back.
# Busybox's shell; its commands need no links once /proc is there.

/bin/busybox mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
exec </dev/null >/dev/console 2>&1
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin

stage() { echo "$*" >/job/stage; }
give_up() {
  echo "vcan machine: $*" >/dev/console
  poweroff -f
}

while read -r module; do
  insmod "/modules/$module" || give_up "module $module does not load"
done </modules/order

options=trans=virtio,version=9p2000.L,msize=512000
mount -t 9p -o "$options,cache=none" job /job || give_up "the job's folder cannot be mounted"
stage mounting the tree of the host
# Only this machine writes to the tree while it runs, as far as it looks: it may keep what it has read.
mount -t 9p -o "$options,cache=loose" root /host || give_up "the tree of the host cannot be mounted"
mount -t proc proc /host/proc
mount -t sysfs sys /host/sys
mount -t devtmpfs dev /host/dev
ln -sf /proc/self/fd /dev/fd
ln -sf fd/0 /dev/stdin
ln -sf fd/1 /dev/stdout
ln -sf fd/2 /dev/stderr
mkdir -p /dev/shm /dev/pts /dev/job
mount -t tmpfs -o mode=1777 shm /host/dev/shm
mount -t devpts -o ptmxmode=0666 pts /host/dev/pts
mount -o bind /job /host/dev/job

# The console keeps its ports apart from what the kernel says. A pipe before each, since programs open
# their output again by name, which a port refuses.
mkfifo /out /err
writers=' '
for port in /sys/class/virtio-ports/*; do
  read -r name <"$port/name"
  cat "/$name" >"/dev/${port##*/}" &
  writers="$writers$! "
done

stage running the command
chroot /host /bin/bash /dev/job/job.sh </dev/null >/out 2>/err
code=$?

stage ending
# What the command has left behind would hold its output open. Threads of the kernel have no program.
for process in /proc/[0-9]*; do
  pid="${process#/proc/}"
  [ "$pid" = 1 ] || [ -z "$(readlink "$process/exe")" ] && continue
  case "$writers" in *" $pid "*) ;; *) kill -9 "$pid" ;; esac
done
wait
# While the tree can be written to: what is not written yet when it becomes read-only stays so.
sync
umount /host/dev/job
umount -r /host
echo "$code" >/job/exit_code
poweroff -f
