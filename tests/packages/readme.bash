#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The README's two commands where nothing is installed: readme.bash FOLDER [RELEASE]
#
# A bare root of the release (trixie) gets git, as the README wants it, and this project; there `./telekerf demo` and
# `./telekerf test` run, with a network of their own once their packages are installed. The root stays in FOLDER, and what it
# has compiled. Needs root, debootstrap and Debian's archive; an hour where nothing is compiled yet.
set -euo pipefail

source=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mkdir -p "$1" && cd "$1" && pwd)
readonly source folder release=${2:-trixie}
# shellcheck source=tests/packages/roots.bash
source "$source/tests/packages/roots.bash"

name=readme-$release
checkout=$folder/$name/root/telekerf
bootstrap "$name" "$release" git,ca-certificates
mkdir -p "$checkout"
find "$checkout" -mindepth 1 -maxdepth 1 ! -name build -exec rm -rf {} +
tar -C "$source" --exclude='./build*' --exclude=./out --exclude=./.git -cf - . | tar -C "$checkout" -xf -

within "$name" 'cd /root/telekerf; apt-get update -q; ./telekerf setup'
apart=(--net --pid --fork --kill-child)
# Something like a network card.
card='ip link set lo up; ip link add eth0 type veth peer name eth1; ip addr add 10.99.26.1/24 dev eth0
  ip link set eth0 up; ip link set eth1 up'
within "$name" "$card; cd /root/telekerf; ./telekerf demo --out out/demo" || bad "$release: ./telekerf demo"
good "$release: ./telekerf demo"
apart=()
within "$name" 'cd /root/telekerf; ./telekerf build'
apart=(--net --pid --fork --kill-child)
within "$name" "$card; cd /root/telekerf; ./telekerf test" || bad "$release: ./telekerf test"
good "$release: ./telekerf test"
