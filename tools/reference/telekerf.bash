# SPDX-License-Identifier: Apache-2.0
# Completes the options, choices and shipped names of every program.
# Written by `build/bin/telekerf-reference build/bin`; a test holds it against the programs.
# shellcheck shell=bash

_telekerf_commands() {
  case $1 in
    telekerf-ctl) echo 'stop clear-stop engage disengage beta ' ;;
    telekerf-netem) echo 'link tc verify trace replay list switch ' ;;
    telekerf-experiment) echo 'closed-contour codec constraint contours delay kinematics lap open-contour space-contour ' ;;
    telekerf-inspect) echo 'codec contour efd robot run ' ;;
  esac
}

_telekerf_flags() {
  case $1 in
    'telekerf-master ') echo '--robot --beta --drive --drive-stale-s --button --mismatch --seed --control-hz --stream-hz --law --estimator --codec --tracking-rad-s --timing-error-s --thesis-cutoff-rad-s --innovation-gain-per-s --predictor-rad-s --disturbance-rad-s --block --keep --max-rms --redundancy --max-redundancy --half-window --curve --corridor-mm --corridor-stiffness-n-per-m --constraint-rad-s --virtual-mass-kg --virtual-drag-ns-per-m --observer-rad-s --hand-speed-mm-s --hand-sideways-n --record --engage --duration-s --wait-s --domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-slave ') echo '--robot --drive --drive-stale-s --laser --laser-max-w --mismatch --seed --control-hz --stream-hz --codec --block --keep --max-rms --force-keep --force-max-rms --redundancy --bandwidth-rad-s --observer-rad-s --stale-s --laser-w --record --domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-machine ') echo '--robot --drive --drive-stale-s --laser --laser-max-w --laser-w --mismatch --seed --sensor --speed-mm-s --controller --corner --material --kerf-um --no-framing --machining-hz --record --wait-s --domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-vision ') echo '--image --camera --mode --anchor --select --width-mm --fit-all --robot --domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-ctl stop') echo '--domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-ctl clear-stop') echo '--domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-ctl engage') echo '--domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-ctl disengage') echo '--domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-ctl beta') echo '--domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-netem link') echo '--seed --operator-dev --slave-dev --operator-netns --slave-netns --operator-address --slave-address --operator-default-route --slave-default-route --record --seconds --config --print-config --help --version' ;;
    'telekerf-netem tc') echo '--dev --direction --config --print-config --help --version' ;;
    'telekerf-netem verify') echo '--packets --seed --rate-hz --json --config --print-config --help --version' ;;
    'telekerf-netem trace') echo '--rate-hz --packets --seed --bytes --direction --config --print-config --help --version' ;;
    'telekerf-netem replay') echo '--link --seed --operator-dev --slave-dev --operator-netns --slave-netns --operator-address --slave-address --operator-default-route --slave-default-route --record --seconds --config --print-config --help --version' ;;
    'telekerf-netem list') echo '--config --print-config --help --version' ;;
    'telekerf-netem switch') echo '--domain --cell --name --peers --netem --netem-seed --config --print-config --help --version' ;;
    'telekerf-robot ') echo '--robot --mismatch --seed --port --config --print-config --help --version' ;;
    'telekerf-experiment closed-contour') echo '--image --robot --width-mm --speed-mm-s --controller --corner --tolerance-um --plant --material --mismatch --loop-delay --no-preview --no-model-ahead --along-rad-s --across-rad-s --sweep --seed --out --config --print-config --help --version' ;;
    'telekerf-experiment codec') echo '--out --trace --rate-hz --seconds --seed --config --print-config --help --version' ;;
    'telekerf-experiment constraint') echo '--seed --duration-s --out --config --print-config --help --version' ;;
    'telekerf-experiment contours') echo '--out --config --print-config --help --version' ;;
    'telekerf-experiment delay') echo '--law --estimator --codec --block --redundancy --netem --rtt-ms --jitter-ms --loss --duration-s --seed --out --config --print-config --help --version' ;;
    'telekerf-experiment kinematics') echo '--robot --step-m --out --config --print-config --help --version' ;;
    'telekerf-experiment lap') echo '--image --width-mm --master-robot --slave-robot --netem --seed --beta --mismatch --control-hz --stream-hz --law --estimator --codec --tracking-rad-s --timing-error-s --thesis-cutoff-rad-s --innovation-gain-per-s --predictor-rad-s --disturbance-rad-s --block --keep --max-rms --redundancy --max-redundancy --half-window --curve --corridor-mm --corridor-stiffness-n-per-m --constraint-rad-s --virtual-mass-kg --virtual-drag-ns-per-m --observer-rad-s --hand-speed-mm-s --hand-sideways-n --slave-codec --slave-block --slave-keep --slave-max-rms --slave-force-keep --slave-force-max-rms --slave-redundancy --slave-bandwidth-rad-s --slave-observer-rad-s --slave-stale-s --slave-laser-w --duration-s --record --out --config --print-config --help --version' ;;
    'telekerf-experiment open-contour') echo '--image --robot --width-mm --speed-mm-s --controller --corner --tolerance-um --plant --material --mismatch --loop-delay --no-preview --no-model-ahead --along-rad-s --across-rad-s --sweep --seed --out --config --print-config --help --version' ;;
    'telekerf-experiment space-contour') echo '--speed-mm-s --radius-mm --curvature-mm --seed --out --config --print-config --help --version' ;;
    'telekerf-inspect codec') echo '--codec --block --keep --max-rms --quantum --threshold --rate-hz --columns --anchored --redundancy --loss --burst --seed --decoded --config --print-config --help --version' ;;
    'telekerf-inspect contour') echo '--mode --start --end --width-mm --height-mm --workspace-mm --anchor --harmonics --tolerance-mm --select --out --config --print-config --help --version' ;;
    'telekerf-inspect efd') echo '--harmonics --config --print-config --help --version' ;;
    'telekerf-inspect robot') echo '--ik --fk --jacobian --workspace --hall --picture --config --print-config --help --version' ;;
    'telekerf-inspect run') echo '--config --print-config --help --version' ;;
  esac
}

# What may follow a flag, as options of compgen; fails for what takes no value.
_telekerf_values() {
  case $1 in
    'telekerf-master  --robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-master  --beta') echo "" ;;
    'telekerf-master  --drive') echo "-W 'simulated udp:'" ;;
    'telekerf-master  --drive-stale-s') echo "" ;;
    'telekerf-master  --button') echo "-W 'hand pressed udp:'" ;;
    'telekerf-master  --mismatch') echo "" ;;
    'telekerf-master  --seed') echo "" ;;
    'telekerf-master  --control-hz') echo "" ;;
    'telekerf-master  --stream-hz') echo "" ;;
    'telekerf-master  --law') echo "-W 'anchored remote-acceleration local'" ;;
    'telekerf-master  --estimator') echo "-W 'predictor delayed-innovation thesis none'" ;;
    'telekerf-master  --codec') echo "-W 'raw sdct batched truncated deadband weber dpcm'" ;;
    'telekerf-master  --tracking-rad-s') echo "" ;;
    'telekerf-master  --timing-error-s') echo "" ;;
    'telekerf-master  --thesis-cutoff-rad-s') echo "" ;;
    'telekerf-master  --innovation-gain-per-s') echo "" ;;
    'telekerf-master  --predictor-rad-s') echo "" ;;
    'telekerf-master  --disturbance-rad-s') echo "" ;;
    'telekerf-master  --block') echo "" ;;
    'telekerf-master  --keep') echo "" ;;
    'telekerf-master  --max-rms') echo "" ;;
    'telekerf-master  --redundancy') echo "" ;;
    'telekerf-master  --max-redundancy') echo "" ;;
    'telekerf-master  --half-window') echo "" ;;
    'telekerf-master  --curve') echo "-W 'circles lines descriptor'" ;;
    'telekerf-master  --corridor-mm') echo "" ;;
    'telekerf-master  --corridor-stiffness-n-per-m') echo "" ;;
    'telekerf-master  --constraint-rad-s') echo "" ;;
    'telekerf-master  --virtual-mass-kg') echo "" ;;
    'telekerf-master  --virtual-drag-ns-per-m') echo "" ;;
    'telekerf-master  --observer-rad-s') echo "" ;;
    'telekerf-master  --hand-speed-mm-s') echo "" ;;
    'telekerf-master  --hand-sideways-n') echo "" ;;
    'telekerf-master  --record') echo "-d" ;;
    'telekerf-master  --duration-s') echo "" ;;
    'telekerf-master  --wait-s') echo "" ;;
    'telekerf-master  --domain') echo "" ;;
    'telekerf-master  --cell') echo "" ;;
    'telekerf-master  --name') echo "" ;;
    'telekerf-master  --peers') echo "" ;;
    'telekerf-master  --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-master  --netem-seed') echo "" ;;
    'telekerf-slave  --robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-slave  --drive') echo "-W 'simulated udp:'" ;;
    'telekerf-slave  --drive-stale-s') echo "" ;;
    'telekerf-slave  --laser') echo "-W 'simulated udp:'" ;;
    'telekerf-slave  --laser-max-w') echo "" ;;
    'telekerf-slave  --mismatch') echo "" ;;
    'telekerf-slave  --seed') echo "" ;;
    'telekerf-slave  --control-hz') echo "" ;;
    'telekerf-slave  --stream-hz') echo "" ;;
    'telekerf-slave  --codec') echo "-W 'raw sdct batched truncated deadband weber dpcm'" ;;
    'telekerf-slave  --block') echo "" ;;
    'telekerf-slave  --keep') echo "" ;;
    'telekerf-slave  --max-rms') echo "" ;;
    'telekerf-slave  --force-keep') echo "" ;;
    'telekerf-slave  --force-max-rms') echo "" ;;
    'telekerf-slave  --redundancy') echo "" ;;
    'telekerf-slave  --bandwidth-rad-s') echo "" ;;
    'telekerf-slave  --observer-rad-s') echo "" ;;
    'telekerf-slave  --stale-s') echo "" ;;
    'telekerf-slave  --laser-w') echo "" ;;
    'telekerf-slave  --record') echo "-d" ;;
    'telekerf-slave  --domain') echo "" ;;
    'telekerf-slave  --cell') echo "" ;;
    'telekerf-slave  --name') echo "" ;;
    'telekerf-slave  --peers') echo "" ;;
    'telekerf-slave  --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-slave  --netem-seed') echo "" ;;
    'telekerf-machine  --robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-machine  --drive') echo "-W 'simulated udp:'" ;;
    'telekerf-machine  --drive-stale-s') echo "" ;;
    'telekerf-machine  --laser') echo "-W 'simulated udp:'" ;;
    'telekerf-machine  --laser-max-w') echo "" ;;
    'telekerf-machine  --laser-w') echo "" ;;
    'telekerf-machine  --mismatch') echo "" ;;
    'telekerf-machine  --seed') echo "" ;;
    'telekerf-machine  --sensor') echo "-W 'encoder hall'" ;;
    'telekerf-machine  --speed-mm-s') echo "" ;;
    'telekerf-machine  --controller') echo "-W 'auto independent preview contouring'" ;;
    'telekerf-machine  --corner') echo "-W 'exact rounded slow'" ;;
    'telekerf-machine  --material') echo "-W 'wood fibreglass'" ;;
    'telekerf-machine  --kerf-um') echo "" ;;
    'telekerf-machine  --machining-hz') echo "" ;;
    'telekerf-machine  --record') echo "-d" ;;
    'telekerf-machine  --wait-s') echo "" ;;
    'telekerf-machine  --domain') echo "" ;;
    'telekerf-machine  --cell') echo "" ;;
    'telekerf-machine  --name') echo "" ;;
    'telekerf-machine  --peers') echo "" ;;
    'telekerf-machine  --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-machine  --netem-seed') echo "" ;;
    'telekerf-vision  --image') echo "-f -W 'blob cam circle figure-8 flange gear heart letter-e letter-s line octagon script-e spiral'" ;;
    'telekerf-vision  --camera') echo "-W 'none v4l2: file: folder: video:'" ;;
    'telekerf-vision  --mode') echo "-W 'auto outline stroke thesis'" ;;
    'telekerf-vision  --anchor') echo "-W 'box first image'" ;;
    'telekerf-vision  --select') echo "" ;;
    'telekerf-vision  --width-mm') echo "" ;;
    'telekerf-vision  --robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-vision  --domain') echo "" ;;
    'telekerf-vision  --cell') echo "" ;;
    'telekerf-vision  --name') echo "" ;;
    'telekerf-vision  --peers') echo "" ;;
    'telekerf-vision  --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-vision  --netem-seed') echo "" ;;
    'telekerf-ctl stop --domain') echo "" ;;
    'telekerf-ctl stop --cell') echo "" ;;
    'telekerf-ctl stop --name') echo "" ;;
    'telekerf-ctl stop --peers') echo "" ;;
    'telekerf-ctl stop --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-ctl stop --netem-seed') echo "" ;;
    'telekerf-ctl clear-stop --domain') echo "" ;;
    'telekerf-ctl clear-stop --cell') echo "" ;;
    'telekerf-ctl clear-stop --name') echo "" ;;
    'telekerf-ctl clear-stop --peers') echo "" ;;
    'telekerf-ctl clear-stop --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-ctl clear-stop --netem-seed') echo "" ;;
    'telekerf-ctl engage --domain') echo "" ;;
    'telekerf-ctl engage --cell') echo "" ;;
    'telekerf-ctl engage --name') echo "" ;;
    'telekerf-ctl engage --peers') echo "" ;;
    'telekerf-ctl engage --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-ctl engage --netem-seed') echo "" ;;
    'telekerf-ctl disengage --domain') echo "" ;;
    'telekerf-ctl disengage --cell') echo "" ;;
    'telekerf-ctl disengage --name') echo "" ;;
    'telekerf-ctl disengage --peers') echo "" ;;
    'telekerf-ctl disengage --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-ctl disengage --netem-seed') echo "" ;;
    'telekerf-ctl beta ') echo "" ;;
    'telekerf-ctl beta --domain') echo "" ;;
    'telekerf-ctl beta --cell') echo "" ;;
    'telekerf-ctl beta --name') echo "" ;;
    'telekerf-ctl beta --peers') echo "" ;;
    'telekerf-ctl beta --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-ctl beta --netem-seed') echo "" ;;
    'telekerf-netem link ') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-netem link --seed') echo "" ;;
    'telekerf-netem link --operator-dev') echo "" ;;
    'telekerf-netem link --slave-dev') echo "" ;;
    'telekerf-netem link --operator-netns') echo "" ;;
    'telekerf-netem link --slave-netns') echo "" ;;
    'telekerf-netem link --operator-address') echo "" ;;
    'telekerf-netem link --slave-address') echo "" ;;
    'telekerf-netem link --record') echo "-d" ;;
    'telekerf-netem link --seconds') echo "" ;;
    'telekerf-netem tc ') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-netem tc --dev') echo "" ;;
    'telekerf-netem tc --direction') echo "-W 'forward backward'" ;;
    'telekerf-netem verify ') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-netem verify --packets') echo "" ;;
    'telekerf-netem verify --seed') echo "" ;;
    'telekerf-netem verify --rate-hz') echo "" ;;
    'telekerf-netem trace ') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-netem trace --rate-hz') echo "" ;;
    'telekerf-netem trace --packets') echo "" ;;
    'telekerf-netem trace --seed') echo "" ;;
    'telekerf-netem trace --bytes') echo "" ;;
    'telekerf-netem trace --direction') echo "-W 'forward backward'" ;;
    'telekerf-netem replay ') echo "-f" ;;
    'telekerf-netem replay --seed') echo "" ;;
    'telekerf-netem replay --operator-dev') echo "" ;;
    'telekerf-netem replay --slave-dev') echo "" ;;
    'telekerf-netem replay --operator-netns') echo "" ;;
    'telekerf-netem replay --slave-netns') echo "" ;;
    'telekerf-netem replay --operator-address') echo "" ;;
    'telekerf-netem replay --slave-address') echo "" ;;
    'telekerf-netem replay --record') echo "-d" ;;
    'telekerf-netem replay --seconds') echo "" ;;
    'telekerf-netem switch ') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-netem switch --domain') echo "" ;;
    'telekerf-netem switch --cell') echo "" ;;
    'telekerf-netem switch --name') echo "" ;;
    'telekerf-netem switch --peers') echo "" ;;
    'telekerf-netem switch --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-netem switch --netem-seed') echo "" ;;
    'telekerf-robot  --robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-robot  --mismatch') echo "" ;;
    'telekerf-robot  --seed') echo "" ;;
    'telekerf-robot  --port') echo "" ;;
    'telekerf-experiment closed-contour --image') echo "-f -W 'blob cam circle figure-8 flange gear heart letter-e letter-s line octagon script-e spiral'" ;;
    'telekerf-experiment closed-contour --robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-experiment closed-contour --width-mm') echo "" ;;
    'telekerf-experiment closed-contour --speed-mm-s') echo "" ;;
    'telekerf-experiment closed-contour --controller') echo "-W 'auto independent preview contouring'" ;;
    'telekerf-experiment closed-contour --corner') echo "-W 'exact rounded slow'" ;;
    'telekerf-experiment closed-contour --tolerance-um') echo "" ;;
    'telekerf-experiment closed-contour --plant') echo "-W 'full ideal'" ;;
    'telekerf-experiment closed-contour --material') echo "-W 'wood fibreglass'" ;;
    'telekerf-experiment closed-contour --mismatch') echo "" ;;
    'telekerf-experiment closed-contour --loop-delay') echo "" ;;
    'telekerf-experiment closed-contour --along-rad-s') echo "" ;;
    'telekerf-experiment closed-contour --across-rad-s') echo "" ;;
    'telekerf-experiment closed-contour --seed') echo "" ;;
    'telekerf-experiment closed-contour --out') echo "-d" ;;
    'telekerf-experiment codec --out') echo "-d" ;;
    'telekerf-experiment codec --trace') echo "-f" ;;
    'telekerf-experiment codec --rate-hz') echo "" ;;
    'telekerf-experiment codec --seconds') echo "" ;;
    'telekerf-experiment codec --seed') echo "" ;;
    'telekerf-experiment constraint --seed') echo "" ;;
    'telekerf-experiment constraint --duration-s') echo "" ;;
    'telekerf-experiment constraint --out') echo "-d" ;;
    'telekerf-experiment contours --out') echo "-d" ;;
    'telekerf-experiment delay --law') echo "-W 'anchored remote-acceleration local'" ;;
    'telekerf-experiment delay --estimator') echo "-W 'predictor delayed-innovation thesis none'" ;;
    'telekerf-experiment delay --codec') echo "-W 'raw sdct batched truncated deadband weber dpcm'" ;;
    'telekerf-experiment delay --block') echo "" ;;
    'telekerf-experiment delay --redundancy') echo "" ;;
    'telekerf-experiment delay --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-experiment delay --rtt-ms') echo "" ;;
    'telekerf-experiment delay --jitter-ms') echo "" ;;
    'telekerf-experiment delay --loss') echo "" ;;
    'telekerf-experiment delay --duration-s') echo "" ;;
    'telekerf-experiment delay --seed') echo "" ;;
    'telekerf-experiment delay --out') echo "-d" ;;
    'telekerf-experiment kinematics --robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-experiment kinematics --step-m') echo "" ;;
    'telekerf-experiment kinematics --out') echo "-d" ;;
    'telekerf-experiment lap --image') echo "-f -W 'blob cam circle figure-8 flange gear heart letter-e letter-s line octagon script-e spiral'" ;;
    'telekerf-experiment lap --width-mm') echo "" ;;
    'telekerf-experiment lap --master-robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-experiment lap --slave-robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-experiment lap --netem') echo "-f -W '4g 5g geo hostile ideal lan leo lindbergh sydney thesis-constant thesis-tcp transatlantic wifi wifi-lossy'" ;;
    'telekerf-experiment lap --seed') echo "" ;;
    'telekerf-experiment lap --beta') echo "" ;;
    'telekerf-experiment lap --mismatch') echo "" ;;
    'telekerf-experiment lap --control-hz') echo "" ;;
    'telekerf-experiment lap --stream-hz') echo "" ;;
    'telekerf-experiment lap --law') echo "-W 'anchored remote-acceleration local'" ;;
    'telekerf-experiment lap --estimator') echo "-W 'predictor delayed-innovation thesis none'" ;;
    'telekerf-experiment lap --codec') echo "-W 'raw sdct batched truncated deadband weber dpcm'" ;;
    'telekerf-experiment lap --tracking-rad-s') echo "" ;;
    'telekerf-experiment lap --timing-error-s') echo "" ;;
    'telekerf-experiment lap --thesis-cutoff-rad-s') echo "" ;;
    'telekerf-experiment lap --innovation-gain-per-s') echo "" ;;
    'telekerf-experiment lap --predictor-rad-s') echo "" ;;
    'telekerf-experiment lap --disturbance-rad-s') echo "" ;;
    'telekerf-experiment lap --block') echo "" ;;
    'telekerf-experiment lap --keep') echo "" ;;
    'telekerf-experiment lap --max-rms') echo "" ;;
    'telekerf-experiment lap --redundancy') echo "" ;;
    'telekerf-experiment lap --max-redundancy') echo "" ;;
    'telekerf-experiment lap --half-window') echo "" ;;
    'telekerf-experiment lap --curve') echo "-W 'circles lines descriptor'" ;;
    'telekerf-experiment lap --corridor-mm') echo "" ;;
    'telekerf-experiment lap --corridor-stiffness-n-per-m') echo "" ;;
    'telekerf-experiment lap --constraint-rad-s') echo "" ;;
    'telekerf-experiment lap --virtual-mass-kg') echo "" ;;
    'telekerf-experiment lap --virtual-drag-ns-per-m') echo "" ;;
    'telekerf-experiment lap --observer-rad-s') echo "" ;;
    'telekerf-experiment lap --hand-speed-mm-s') echo "" ;;
    'telekerf-experiment lap --hand-sideways-n') echo "" ;;
    'telekerf-experiment lap --slave-codec') echo "-W 'raw sdct batched truncated deadband weber dpcm'" ;;
    'telekerf-experiment lap --slave-block') echo "" ;;
    'telekerf-experiment lap --slave-keep') echo "" ;;
    'telekerf-experiment lap --slave-max-rms') echo "" ;;
    'telekerf-experiment lap --slave-force-keep') echo "" ;;
    'telekerf-experiment lap --slave-force-max-rms') echo "" ;;
    'telekerf-experiment lap --slave-redundancy') echo "" ;;
    'telekerf-experiment lap --slave-bandwidth-rad-s') echo "" ;;
    'telekerf-experiment lap --slave-observer-rad-s') echo "" ;;
    'telekerf-experiment lap --slave-stale-s') echo "" ;;
    'telekerf-experiment lap --slave-laser-w') echo "" ;;
    'telekerf-experiment lap --duration-s') echo "" ;;
    'telekerf-experiment lap --out') echo "-d" ;;
    'telekerf-experiment open-contour --image') echo "-f -W 'blob cam circle figure-8 flange gear heart letter-e letter-s line octagon script-e spiral'" ;;
    'telekerf-experiment open-contour --robot') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-experiment open-contour --width-mm') echo "" ;;
    'telekerf-experiment open-contour --speed-mm-s') echo "" ;;
    'telekerf-experiment open-contour --controller') echo "-W 'auto independent preview contouring'" ;;
    'telekerf-experiment open-contour --corner') echo "-W 'exact rounded slow'" ;;
    'telekerf-experiment open-contour --tolerance-um') echo "" ;;
    'telekerf-experiment open-contour --plant') echo "-W 'full ideal'" ;;
    'telekerf-experiment open-contour --material') echo "-W 'wood fibreglass'" ;;
    'telekerf-experiment open-contour --mismatch') echo "" ;;
    'telekerf-experiment open-contour --loop-delay') echo "" ;;
    'telekerf-experiment open-contour --along-rad-s') echo "" ;;
    'telekerf-experiment open-contour --across-rad-s') echo "" ;;
    'telekerf-experiment open-contour --seed') echo "" ;;
    'telekerf-experiment open-contour --out') echo "-d" ;;
    'telekerf-experiment space-contour --speed-mm-s') echo "" ;;
    'telekerf-experiment space-contour --radius-mm') echo "" ;;
    'telekerf-experiment space-contour --curvature-mm') echo "" ;;
    'telekerf-experiment space-contour --seed') echo "" ;;
    'telekerf-experiment space-contour --out') echo "-d" ;;
    'telekerf-inspect codec ') echo "-f" ;;
    'telekerf-inspect codec --codec') echo "-W 'raw sdct batched truncated deadband weber dpcm'" ;;
    'telekerf-inspect codec --block') echo "" ;;
    'telekerf-inspect codec --keep') echo "" ;;
    'telekerf-inspect codec --max-rms') echo "" ;;
    'telekerf-inspect codec --quantum') echo "" ;;
    'telekerf-inspect codec --threshold') echo "" ;;
    'telekerf-inspect codec --rate-hz') echo "" ;;
    'telekerf-inspect codec --columns') echo "" ;;
    'telekerf-inspect codec --redundancy') echo "" ;;
    'telekerf-inspect codec --loss') echo "" ;;
    'telekerf-inspect codec --burst') echo "" ;;
    'telekerf-inspect codec --seed') echo "" ;;
    'telekerf-inspect codec --decoded') echo "-f" ;;
    'telekerf-inspect contour ') echo "-f -W 'blob cam circle figure-8 flange gear heart letter-e letter-s line octagon script-e spiral'" ;;
    'telekerf-inspect contour --mode') echo "-W 'auto outline stroke thesis'" ;;
    'telekerf-inspect contour --start') echo "" ;;
    'telekerf-inspect contour --end') echo "" ;;
    'telekerf-inspect contour --width-mm') echo "" ;;
    'telekerf-inspect contour --height-mm') echo "" ;;
    'telekerf-inspect contour --workspace-mm') echo "" ;;
    'telekerf-inspect contour --anchor') echo "-W 'box first image'" ;;
    'telekerf-inspect contour --harmonics') echo "-W 'auto'" ;;
    'telekerf-inspect contour --tolerance-mm') echo "" ;;
    'telekerf-inspect contour --select') echo "" ;;
    'telekerf-inspect contour --out') echo "-d" ;;
    'telekerf-inspect efd ') echo "-f" ;;
    'telekerf-inspect efd --harmonics') echo "" ;;
    'telekerf-inspect robot ') echo "-f -W 'asymmetric master-horizontal slave-keops vertical'" ;;
    'telekerf-inspect robot --ik') echo "" ;;
    'telekerf-inspect robot --fk') echo "" ;;
    'telekerf-inspect robot --jacobian') echo "" ;;
    'telekerf-inspect robot --picture') echo "-f" ;;
    'telekerf-inspect run ') echo "-d" ;;
    *' --config') echo '-f' ;;
    *) return 1 ;;
  esac
}

_telekerf() {
  local program=${1##*/} word=$2 previous=$3 command='' commands how one
  commands=$(_telekerf_commands "$program")
  for one in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [[ " $commands" != *" $one "* ]] || { command=$one; break; }
  done
  COMPREPLY=()
  if [[ $previous == --* ]] && how=$(_telekerf_values "$program $command $previous"); then
    eval "mapfile -t COMPREPLY < <(compgen $how -- \"\$word\")"
  elif [[ -n $commands && -z $command && $word != -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_telekerf_flags "$program $command")" -- "$word")
  elif how=$(_telekerf_values "$program $command "); then
    eval "mapfile -t COMPREPLY < <(compgen $how -- \"\$word\")"
  fi
}
complete -o filenames -F _telekerf telekerf-master telekerf-slave telekerf-machine telekerf-vision telekerf-ctl telekerf-netem telekerf-robot telekerf-experiment telekerf-inspect
