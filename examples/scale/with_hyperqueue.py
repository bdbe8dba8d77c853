"""Runs a plan with HyperQueue: python with_hyperqueue.py PLAN [REALGAP]. Needs: pip install hyperqueue."""

import subprocess
import sys

from hyperqueue import Job
from hyperqueue.cluster import LocalCluster

plan = sys.argv[1]
realgap = sys.argv[2] if len(sys.argv) > 2 else "realgap"


def pending():
    said = subprocess.run([realgap, "status", plan, "--pending"], check=True, capture_output=True, text=True)
    for part in filter(None, said.stdout.strip().split(",")):
        first, _, last = part.partition("-")
        yield from range(int(first), int(last or first) + 1)


# A running server is reached with hyperqueue.Client() in place of these two lines.
with LocalCluster() as cluster:
    cluster.start_worker()
    client = cluster.client()
    while numbers := list(pending()):
        job = Job()
        for number in numbers:
            job.program([realgap, "run", plan, "--shard", str(number), "--jobs", "1"])
        client.wait_for_jobs([client.submit(job)], raise_on_error=False)
        subprocess.run([realgap, "merge", plan], check=True)
