# SPDX-License-Identifier: Apache-2.0
# ./telekerf check and ./telekerf bench; the script reads this file, and shows the following as help.
#
#   ./telekerf check [PART ..]
#
#   Runs the parts named (all of them if none is), says every half minute how far it has come, and sums up.
#   Exit code 1 if a part is red; what a part says is in build/check/PART.log.
#
#     werror    everything built with warnings as errors, all tests        build/
#     demo      the programs as the demo builds them, several sources a call   build-demo/
#     processes faults of real processes while they cut, judged by the plant   build/
#     rogues    10,000 tries of each kind to command a secured cell            build/
#     secured   the tests of real processes, each of them with keys            build/
#     headers   every header compiles alone
#     examples  the examples
#     fuzz      libFuzzer, 60 s a target
#     bench     the benchmarks
#     asan      all tests: memory and undefined behaviour                  build-asan/
#     tsan      all tests: threads                                         build-tsan/
#     tidy      clang-tidy                                                 build-tidy/
#     packages  Debian packages in bare roots of Debian 12 and 13: install, cut, upgrade during a cut, remove, purge; one
#               drives the other (as root)                              build-roots/
#     readme    the README's two commands in a bare root of Debian 13: demo and all tests (as root, an hour)   build-roots/
#     chaos     1000 chaos runs, 1000 stops with and without losses, and an hour of both sites in virtual time
#
#   ./telekerf check mutation [--count N] [--seed S] [--folder F]
#
#   Not among the parts, as it takes hours: puts N small faults (100) into the code, one at a time, and counts those
#   that the tests notice. The last line is `score NN %`.

readonly check_parts="werror demo processes rogues secured headers examples fuzz bench asan tsan tidy packages readme chaos"

# Benchmarks, all of them if none is named, on standard output.
bench() {
  local file names=("$@") name code=0 programs=()
  if ((${#names[@]} == 0)); then
    for file in "$root"/tests/bench/bench_*.{cpp,py}; do names+=("$(basename "${file%.*}")"); done
  fi
  names=("${names[@]/#bench_/}")
  for name in "${names[@]}"; do
    if [[ -f $root/tests/bench/bench_$name.cpp ]]; then
      programs+=("bench_$name")
    elif [[ -f $root/tests/bench/bench_$name.py ]]; then # of whole processes, with what the tests need
      [[ -z $(missing_packages tests) ]] || setup tests
      programs+=(telekerf-vision telekerf-slave telekerf-master telekerf-console)
    else
      fail "bench: unknown benchmark $name"
    fi
  done
  build benchmarks "${programs[@]}"
  for name in "${names[@]}"; do
    echo "== bench_$name"
    if [[ -f $root/tests/bench/bench_$name.py ]]; then
      /usr/bin/python3 "$root/tests/bench/bench_$name.py" "$build/bin" || code=1
    else
      "$build/bin/bench_$name" || code=1
    fi
  done
  return "$code"
}

# The parts of the long check; each runs on its own and says everything into a log.
check_preset() { # PRESET FOLDER
  (cd "$root" && cmake --preset "$1" -B "$2") && ninja -C "$2"
}
check_werror() { check_preset ci "$build" && TELEKERF_STATES=10000000 ctest --test-dir "$build" --output-on-failure -j2; }
check_demo() {
  cmake -S "$root" -B "$build-demo" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTELEKERF_BUILD_TESTS=OFF \
    -DTELEKERF_BUILD_EXAMPLES=OFF -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=14 && ninja -C "$build-demo"
}
check_processes() { ninja -C "$build" chaos_processes && "$build/bin/chaos_processes"; }
check_rogues() { ninja -C "$build" test_rogues && TELEKERF_TRIES=10000 "$build/bin/test_rogues"; }
check_secured() {
  ninja -C "$build" && TELEKERF_TEST_SECURITY=1 ctest --test-dir "$build" --output-on-failure -L integration
}
check_headers() { ninja -C "$build" all_verify_interface_header_sets; }
check_examples() { ninja -C "$build" && ctest --test-dir "$build" --output-on-failure --no-tests=error -L examples; }
check_fuzz() {
  local file name
  cmake "$build" || return 1 # clang may be new
  for file in "$root"/tests/fuzz/fuzz_*.cpp; do
    name=$(basename "$file" .cpp)
    [[ $name != *_bounded ]] || continue
    ninja -C "$build" "$name" || return 1
    "$build/bin/$name" -max_total_time=60 -artifact_prefix="$build/check/" || return 1
  done
}
check_bench() { bench; }
check_asan() { check_preset asan "$build-asan" && ctest --test-dir "$build-asan" --output-on-failure; }
check_tsan() { check_preset tsan "$build-tsan" && ctest --test-dir "$build-tsan" --output-on-failure; }
check_packages() { "$root/tests/packages/packages.bash" "$build-roots"; }
check_readme() { "$root/tests/packages/readme.bash" "$build-roots" trixie; }
check_chaos() {
  ninja -C "$build" telekerf-experiment test_flat_memory || return 1
  TELEKERF_FLAT_S=3600 "$build/bin/test_flat_memory" || return 1
  "$build/bin/telekerf-experiment" chaos --runs 1000 --out "$build/check/chaos" || return 1
  "$build/bin/telekerf-experiment" chaos --runs 300 --mode safety --out "$build/check/chaos-safety"
}
check_tidy() { check_preset tidy "$build-tidy"; }

check_mutation() {
  [[ -z $(missing_packages programs "${everything[@]}") ]] || setup programs "${everything[@]}"
  exec python3 "$root/tests/mutation/mutate.py" --build "$build/mutation" "$@"
}

check() {
  [[ ${1:-} != mutation ]] || check_mutation "${@:2}"
  local parts=("$@") part begun word summary=() red=0
  for part in "${parts[@]}"; do
    [[ " $check_parts " == *" $part "* ]] || fail "check: unknown part '$part': one of $check_parts"
  done
  ((${#parts[@]} > 0)) || read -ra parts <<<"$check_parts"
  [[ -z $(missing_packages programs "${everything[@]}" check) ]] || setup programs "${everything[@]}" check
  configure "${everything[@]}"
  mkdir -p "$build/check"
  for part in "${parts[@]}"; do
    begun=$SECONDS word=good
    echo "check: $part ..."
    "check_$part" </dev/null 2>&1 | progress "check: $part" "$build/check/$part.log" || word=RED
    summary+=("$(printf '  %-10s %-5s %s' "$part" "$word" "$(duration $((SECONDS - begun)))")")
    [[ $word == RED ]] || continue
    red=1 summary[-1]+="   $build/check/$part.log"
    tail -n 20 "$build/check/$part.log"
  done
  echo "check:"
  printf '%s\n' "${summary[@]}"
  return "$red"
}
