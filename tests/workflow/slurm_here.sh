#!/usr/bin/env bash
# A Slurm of one node on this machine, for tests: `make slurm`, as root on Debian or Ubuntu.
# It schedules by CPUs alone, of which it pretends to have sixteen, and keeps no accounts.
set -euo pipefail
command -v slurmctld slurmd munged > /dev/null || {
    apt-get update --quiet
    apt-get install --yes --quiet --no-install-recommends slurmctld slurmd slurm-client munge
}
state=/var/lib/slurm
mkdir -p /etc/slurm /var/log/slurm "$state/ctld" "$state/d" /run/munge
cat > /etc/slurm/slurm.conf << CONF
ClusterName=study
SlurmctldHost=localhost(127.0.0.1)
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$state/ctld
SlurmdSpoolDir=$state/d
SlurmctldPidFile=/run/slurmctld.pid
SlurmdPidFile=/run/slurmd.pid
SlurmctldLogFile=/var/log/slurm/slurmctld.log
SlurmdLogFile=/var/log/slurm/slurmd.log
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=2,batch_sched_delay=1
ReturnToService=2
NodeName=localhost NodeAddr=127.0.0.1 NodeHostname=$(hostname) CPUs=16 RealMemory=64000
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
chown munge: /run/munge
pgrep -x munged > /dev/null || su -s /bin/sh munge -c /usr/sbin/munged
pgrep -x slurmctld > /dev/null || slurmctld
pgrep -x slurmd > /dev/null || slurmd -N localhost
for _ in $(seq 30); do
    sinfo --noheader --format %t | grep --quiet --extended-regexp 'idle|mix|alloc' && exec sinfo
    sleep 1
done
echo "error: Slurm does not answer; see /var/log/slurm" >&2
exit 1
