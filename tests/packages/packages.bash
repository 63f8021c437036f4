#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Debian's packages in bare roots of Debian 12 and 13: packages.bash FOLDER [RELEASE ..]
#
# For each release: a root is bootstrapped, the packages are built in it by `./telekerf package`; in a second, bare one they
# are installed, cut, are upgraded during a cut, removed and purged; in a third, booted one they run as services. Then a master
# of Debian 12 drives a slave of Debian 13 across two network namespaces, and the other way round. The roots stay in FOLDER and
# are used again. Needs root, debootstrap and Debian's archive.
set -euo pipefail

source=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mkdir -p "$1" && cd "$1" && pwd)
releases=("${@:2}")
((${#releases[@]} > 0)) || releases=(bookworm trixie)
readonly source folder releases
# shellcheck source=tests/packages/roots.bash
source "$source/tests/packages/roots.bash"

# build RELEASE: its packages, into FOLDER/debs-RELEASE.
build() {
  bootstrap "build-$1" "$1"
  within "build-$1" 'apt-get update -q; TELEKERF_BUILD=/build/telekerf /source/telekerf package
    lintian --pedantic --fail-on error,warning /build/telekerf-package/*.deb'
  rm -rf "$folder/debs-$1"
  mkdir -p "$folder/debs-$1"
  cp "$folder/build-$1"/build/telekerf-package/*.deb "$folder/debs-$1"
  local deb version debs=("$folder/debs-$1"/*.deb)
  version=$("$source/telekerf" --version)
  for deb in "${debs[@]}"; do
    [[ $(dpkg-deb -f "$deb" Version) =~ ^"$version~deb"[0-9]+$ ]] || bad "$deb is not of version $version"
  done
  good "$1: ${#debs[@]} packages of version $version, no error and no warning of lintian's"
}

# newer FROM TO: the same packages as the next version.
newer() {
  local deb tree
  mkdir -p "$2"
  for deb in "$1"/*.deb; do
    tree=$(mktemp -d -p "$folder")
    dpkg-deb -R "$deb" "$tree"
    sed -i -E '/^(Version|Depends):/s/(~deb[0-9]+)/+next\1/g' "$tree/DEBIAN/control"
    dpkg-deb --root-owner-group -Zgzip -z1 -b "$tree" "$2" >/dev/null
    rm -rf "$tree"
  done
}

# What systemd would be asked for, in a file of the root.
listen_for_systemctl() {
  mkdir -p "$folder/$1/run/systemd/system"
  printf '#!/bin/sh\necho "$*" >>/systemctl.txt\n' >"$folder/$1/usr/bin/systemctl"
  chmod +x "$folder/$1/usr/bin/systemctl"
  : >"$folder/$1/systemctl.txt"
}

# figure FILE .PATH.OF.IT
figure() { python3 -c 'import json,sys
value = json.load(open(sys.argv[1]))
for key in sys.argv[2].strip(".").split("."): value = value[key]
print(value)' "$1" "$2"; }

# exposure NAME: what the systemd of that root says of each unit of a service; above 2.0 of 10 is not good.
exposure() {
  within "$1" 'for unit in /usr/lib/systemd/system/telekerf-*.service; do
    systemd-analyze security --offline=yes --threshold=20 --no-pager "$unit" >/exposure.txt || cat /exposure.txt
    said=$(grep "Overall exposure" /exposure.txt)
    echo "${unit##*/}: ${said#* }"
    [[ $said =~ :\ ([0-9])\.([0-9])\  ]] && ((BASH_REMATCH[1] * 10 + BASH_REMATCH[2] <= 20))
  done'
}

# life RELEASE: install, cut, upgrade during a cut, remove, purge.
life() {
  local name=bare-$1 debs=$folder/debs-$1 at=$folder/bare-$1 begun lost
  rm -rf "$at"
  bootstrap "$name" "$1"
  cp "$debs"/*.deb "$at/debs"
  within "$name" 'apt-get update -q; apt-get install -y -q --download-only /debs/*.deb'
  listen_for_systemctl "$name"
  find "$at/etc" "$at/usr" "$at/var/lib" "$at/opt" -name '*telekerf*' | sort >"$folder/before-$1.txt"

  begun=$SECONDS
  within "$name" 'apt-get install -y -q /debs/*.deb >/install.txt 2>&1; cd /root; telekerf demo --no-console --out cut --domain 87'
  good "$1: installed and first cut in $((SECONDS - begun)) s, dependencies cached"
  [[ $(figure "$at/root/cut/report.json" cut.coverage) == 1* ]] || bad "$1: the first cut is not whole"
  grep -q telekerf "$at/systemctl.txt" && bad "$1: installing asked systemd for a service of ours"
  within "$name" 'for program in /usr/bin/telekerf*; do test -s "/usr/share/man/man1/${program##*/}.1.gz"; done
    for program in slave vision master console; do
      telekerf-$program --config /etc/telekerf/cell-1.toml --print-config >/dev/null
    done'
  exposure "$name" || bad "$1: a unit is exposed above 2.0 of 10, see above"

  newer "$debs" "$at/newer"
  : >"$at/systemctl.txt"
  within "$name" 'cd /root; telekerf demo --no-console --out upgraded --duration-s 40 --domain 87 & demo=$!
    sleep 12; apt-get install -y -q /newer/*.deb >/upgrade.txt 2>&1
    readlink /proc/[0-9]*/exe | grep -q "^/usr/bin/telekerf-slave (deleted)"
    echo "upgraded while the slave of before runs on"; wait $demo'
  lost=$(figure "$at/root/upgraded/report.json" link.lost)
  [[ $lost == 0 ]] || bad "$1: $lost blocks were lost during the upgrade"
  [[ $(figure "$at/root/upgraded/report.json" cut.energy_outside_corridor_j) == 0.0 ]] || bad "$1: light beside the corridor"
  grep -q telekerf "$at/systemctl.txt" && bad "$1: an upgrade asked systemd for a service of ours"
  good "$1: upgraded during a cut: $lost blocks lost"

  within "$name" 'mkdir -p /var/lib/telekerf && touch /var/lib/telekerf/record; apt-get remove -y -q "telekerf*" >/remove.txt 2>&1'
  [[ -f $at/etc/telekerf/cell-1.toml ]] || bad "$1: removing took the settings"
  [[ ! -e $at/usr/bin/telekerf-slave ]] || bad "$1: removing left programs"
  grep -q '^stop ' "$at/systemctl.txt" || bad "$1: removing did not stop what ran"
  within "$name" 'apt-get purge -y -q "telekerf*" >/purge.txt 2>&1'
  find "$at/etc" "$at/usr" "$at/var/lib" "$at/opt" -name '*telekerf*' ! -path '*/var/lib/telekerf*' ! -path '*/apt/*' | sort |
    diff "$folder/before-$1.txt" - || bad "$1: purging left the above"
  [[ -f $at/var/lib/telekerf/record ]] || bad "$1: purging took the data"
  good "$1: removed and purged, nothing left but data"
}

# services RELEASE: both sites under systemd, in a container that is booted.
left_out=()
services() {
  local name=booted-$1 at=$folder/booted-$1 hierarchy=no
  # From Debian 13 on systemd knows the cgroups of version 2 alone.
  if [[ $1 != bookworm || $(stat -fc %T /sys/fs/cgroup) == cgroup2fs ]]; then hierarchy=yes; fi
  if [[ $hierarchy == yes ]] && ! grep -qw cgroup2 /proc/filesystems; then
    left_out+=("services on $1: its systemd needs cgroups of version 2, which this computer does not have")
    echo "packages: LEFT OUT: ${left_out[-1]}"
    return
  fi
  rm -rf "$at"
  bootstrap "$name" "$1" systemd-sysv,dbus,procps
  within "$name" 'apt-get update -q'
  cp "$folder/debs-$1"/*.deb "$at/debs"
  within "$name" 'apt-get install -y -q --download-only /debs/*.deb'
  cp "$folder/archives"/*.deb "$at/var/cache/apt/archives" # it boots without a network
  newer "$folder/debs-$1" "$at/newer"
  cp "$source/tests/packages/services.bash" "$at/services.bash"
  printf '[Unit]\nAfter=multi-user.target\n[Service]\nExecStart=/bin/bash /services.bash\n' >"$at/etc/systemd/system/try.service"
  mkdir -p "$at/etc/systemd/system/multi-user.target.wants"
  ln -sf ../try.service "$at/etc/systemd/system/multi-user.target.wants/try.service"
  rm -f "$at/result.txt"
  SYSTEMD_NSPAWN_UNIFIED_HIERARCHY=$hierarchy timeout 600 systemd-nspawn --register=no --keep-unit --capability=all -b -D "$at" --private-network || true
  [[ $(tail -n 1 "$at/result.txt") == GOOD ]] || { cat "$at/result.txt" || true; bad "$1: services, see above"; }
  good "$1: both sites as services; upgraded during a cut, nothing lost"
}

# seen FILE: `telekerf-ctl look --json` at the operator lists all three: host, version, and the clock of the slave's site.
seen() { python3 - "$1" "$("$source/telekerf" --version)" <<'PYTHON'
import json, sys
all = {one["role"]: one for one in json.load(open(sys.argv[1]))}
good = sorted(all) == ["master", "slave", "vision"] and all["master"]["host"] != "10.99.25.2"
for role, one in all.items():
    ahead_s = 0 if role == "master" else 90
    good = good and one["version"] == sys.argv[2] and abs(one.get("clock_ahead_s", 1e9) - ahead_s) < 0.1
    good = good and (role == "master" or one["host"] == "10.99.25.2")
sys.exit(0 if good else 1)
PYTHON
}

# across MASTER SLAVE: two releases, two network namespaces, clocks that differ by 90 s, one cut.
across() {
  local left=telekerf-left right=telekerf-right out=$folder/across-$1-$2 pids=() name
  local later='env DONT_FAKE_MONOTONIC=1 faketime -f +90s'
  for name in "$1" "$2"; do
    bootstrap "bare-$name" "$name"
    cp "$folder/debs-$name"/*.deb "$folder/bare-$name/debs"
    within "bare-$name" 'apt-get install -y -q /debs/*.deb faketime >/dev/null 2>&1; rm -rf /root/record; mkdir /root/record'
  done
  for name in $left $right; do ip netns del "$name" 2>/dev/null || true; ip netns add "$name"; ip -n "$name" link set lo up; done
  ip link add telekerf-l netns $left type veth peer name telekerf-r netns $right
  ip -n $left addr add 10.99.25.1/24 dev telekerf-l
  ip -n $right addr add 10.99.25.2/24 dev telekerf-r
  ip -n $left link set telekerf-l up
  ip -n $right link set telekerf-r up
  ip -n $left route add 239.0.0.0/8 dev telekerf-l
  ip -n $right route add 239.0.0.0/8 dev telekerf-r
  ns=$right within "bare-$2" "exec $later telekerf-vision --insecure" & pids+=($!)
  ns=$right within "bare-$2" "exec $later telekerf-slave --insecure --record /root/record" & pids+=($!)
  (sleep 8; ns=$left within "bare-$1" 'telekerf-ctl look --insecure; telekerf-ctl look --insecure --json >/root/look.json') &
  pids+=($!)
  ns=$left within "bare-$1" 'telekerf-master --insecure --engage --duration-s 20 --record /root/record' || bad "the master of $1 failed"
  # What was started is a child of these; all of it is in the namespace.
  ip netns pids $right | xargs -r kill -TERM
  for _ in {1..50}; do
    [[ -n $(ip netns pids $right) ]] || break
    sleep 0.2
  done
  wait "${pids[@]}" || true
  rm -rf "$out"
  mkdir -p "$out"
  cp "$folder/bare-$1/root/record"/* "$folder/bare-$2/root/record"/* "$out"
  rm -rf "$folder/bare-$1/root/across"
  cp -r "$out" "$folder/bare-$1/root/across"
  within "bare-$1" 'telekerf-inspect run /root/across' || bad "the cut across $1 and $2"
  seen "$folder/bare-$1/root/look.json" || { cat "$folder/bare-$1/root/look.json"; bad "the above is not who was there"; }
  ip netns del $left
  ip netns del $right
  good "a master of $1 drives a slave of $2: tracking rms $(figure "$folder/bare-$1/root/across/report.json" tracking.rms_um) um"
}

for release in "${releases[@]}"; do
  build "$release"
  life "$release"
  services "$release"
done
if ((${#releases[@]} > 1)); then
  across "${releases[0]}" "${releases[1]}"
  across "${releases[1]}" "${releases[0]}"
fi
((${#left_out[@]} == 0)) || printf 'packages: left out: %s\n' "${left_out[@]}"
good "good$( ((${#left_out[@]} == 0)) || echo ", but for what was left out")"
