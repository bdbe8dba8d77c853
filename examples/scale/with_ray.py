"""Runs a plan on a Ray cluster: python with_ray.py PLAN [REALGAP]. Needs: pip install ray."""

import subprocess
import sys

import ray

plan = sys.argv[1]
realgap = sys.argv[2] if len(sys.argv) > 2 else "realgap"


@ray.remote(num_cpus=1, max_retries=3, retry_exceptions=True)
def shard(numbers):
    subprocess.run([realgap, "run", plan, "--shard", numbers, "--jobs", "1"], check=True)


def pending():
    said = subprocess.run([realgap, "status", plan, "--pending"], check=True, capture_output=True, text=True)
    for part in filter(None, said.stdout.strip().split(",")):
        first, _, last = part.partition("-")
        yield from range(int(first), int(last or first) + 1)


ray.init()
while numbers := list(pending()):
    ray.get([shard.remote(str(number)) for number in numbers])
    subprocess.run([realgap, "merge", plan], check=True)
