#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Runs in a booted container (packages.bash puts it there, with packages in /debs and their next version in /newer): both
# sites as services, a cut, an upgrade during it, a process that hangs, a removal. The last line says how it went.
set -uo pipefail
exec >/result.txt 2>&1
trap poweroff EXIT
bad() {
  systemctl --no-pager status 'telekerf-*@cell-1.service'
  echo "NOT GOOD: $*"
  exit 1
}
running() { systemctl show -p MainPID --value telekerf-{slave,vision}@cell-1 telekerf-{master,console}@cell-1; }

apt-get install -y -q /debs/*.deb || bad "the packages cannot be installed"
[[ -z $(systemctl list-units --no-legend 'telekerf*') ]] || bad "installing has started something"
sed -i 's/^#image = .*/image = "circle"/; s/^#record = .*/record = "run"/' /etc/telekerf/cell-1.toml
systemctl enable --now telekerf-cell@cell-1.target telekerf-operator@cell-1.target || bad "the targets do not start"
sleep 12
telekerf-ctl look
for service in slave vision master console; do
  [[ $(systemctl is-active "telekerf-$service@cell-1") == active ]] || bad "$service does not run"
done
slave=$(systemctl show -p MainPID --value telekerf-slave@cell-1)
# Where the container itself may not raise limits, its services cannot have them.
if setpriv --dump | grep -q 'Capability bounding set:.*sys_resource'; then
  grep -q '^Max realtime priority *60 ' "/proc/$slave/limits" || bad "real-time priority is not granted"
  ! journalctl -u telekerf-slave@cell-1 | grep -q 'refused by the system' || bad "real-time priority is refused"
fi
telekerf-ctl engage || bad "nobody engages"
sleep 10
before=$(running)
apt-get install -y -q /newer/*.deb || bad "the upgrade fails"
[[ $(running) == "$before" ]] || bad "the upgrade has touched what runs"
sleep 2
! telekerf-inspect run /var/lib/telekerf/run || bad "a record that is being written is read"
# Waits for what is named, and the services end after their target.
systemctl stop telekerf-operator@cell-1.target telekerf-cell@cell-1.target telekerf-{slave,vision,master,console}@cell-1
[[ -z $(systemctl list-units --failed --no-legend 'telekerf*') ]] || bad "a service does not end in order"
telekerf-inspect run /var/lib/telekerf/run || bad "there is no report"
grep -q '"lost": 0,' /var/lib/telekerf/run/report.json || bad "blocks were lost during the upgrade"
! grep -q '"packets_per_s": 0.0,\?$' /var/lib/telekerf/run/report.json || bad "the report lacks the stream of the master"
sed -i 's/^record = .*/#&/' /etc/telekerf/cell-1.toml # a folder is of one run
systemctl start telekerf-cell@cell-1.target
sleep 5
slave=$(systemctl show -p MainPID --value telekerf-slave@cell-1)
((slave > 0)) || bad "the slave does not start again"
kill -STOP "$slave"
sleep 5
[[ $(systemctl show -p Result --value telekerf-slave@cell-1) == watchdog ]] || bad "a slave that hangs is not killed"
[[ $(systemctl is-active telekerf-slave@cell-1) == failed ]] || bad "a slave that was killed has come back"
apt-get remove -y -q telekerf-cell || bad "the packages cannot be removed"
[[ $(systemctl is-active telekerf-vision@cell-1) == inactive ]] || bad "what was removed still runs"
apt-get purge -y -q 'telekerf*' || bad "the packages cannot be purged"
left=$(find /etc /usr -name '*telekerf*' ! -path '*/apt/*')
[[ -z $left ]] || bad "purging left $left"
[[ -d /var/lib/telekerf/run ]] || bad "purging took the data"
echo GOOD
