# SPDX-License-Identifier: Apache-2.0
# Bare roots of a Debian, and commands in them. Whoever reads this file has set `source` (the project) and `folder` (where the
# roots stay, to be used again). Needs root, debootstrap and Debian's archive.
mkdir -p "$folder/archives" "$folder/ccache"

good() { echo "packages: $*"; }
bad() { echo "packages: NOT GOOD: $*" >&2; exit 1; }

# bootstrap NAME RELEASE [PACKAGES]: a bare root, as it is installed from the archive.
bootstrap() {
  local at=$folder/$1
  if [[ ! -e $at/.whole ]]; then
    rm -rf "$at"
    debootstrap --variant=minbase "--include=systemd${3:+,$3}" --cache-dir="$folder/archives" "$2" "$at"
    # Packages stay cached.
    printf 'APT::Keep-Downloaded-Packages "true";\nAPT::Install-Recommends "false";\n' >"$at/etc/apt/apt.conf.d/90keep"
    rm -f "$at/etc/apt/apt.conf.d/docker-clean"
    touch "$at/.whole"
  fi
  mkdir -p "$at/source" "$at/build" "$at/ccache" "$at/debs"
}

# within NAME COMMAND: as root of that system. `ns` names the network namespace, if any; `apart=(--net --pid --fork
# --kill-child)` gives it a network, processes and shared memory of its own, which end with it.
ns=
apart=()
within() {
  local at=$folder/$1 net=()
  [[ -z $ns ]] || net=(nsenter "--net=/run/netns/$ns")
  cp -L /etc/resolv.conf "$at/etc/resolv.conf"
  "${net[@]}" unshare --mount "${apart[@]}" --propagation private bash -c '
    at=$0 source=$1 folder=$2
    mount -t proc proc "$at/proc"; mount --rbind /dev "$at/dev"; mount --bind "$source" "$at/source"
    mount --bind "$folder/ccache" "$at/ccache"; mount --bind "$folder/archives" "$at/var/cache/apt/archives"
    if (($4)); then mount -t tmpfs shm "$at/dev/shm"; fi
    exec chroot "$at" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 CCACHE_DIR=/ccache \
      DEBIAN_FRONTEND=noninteractive bash -ec "$3"' "$at" "$source" "$folder" "$2" "${#apart[@]}"
}
