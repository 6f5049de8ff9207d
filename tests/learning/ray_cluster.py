"""Sample on a Ray cluster of two nodes on this machine, of which one is killed: python ray_cluster.py PLAN OUT."""

import os
import pickle
import sys
from pathlib import Path

os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

import ray
from ray.cluster_utils import Cluster

from hydrostat.learning import sample_robot

if __name__ == "__main__":
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    other = cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    killed = []

    def tell(stage: str, done: int, total: int) -> None:
        """Kill the second node as soon as something is done."""
        if not killed:
            cluster.remove_node(other, allow_graceful=False)
            killed.append(done)

    sample_robot(pickle.loads(Path(sys.argv[1]).read_bytes()), Path(sys.argv[2]), backend="ray", progress=tell)
    assert killed
    ray.shutdown()
    cluster.shutdown()
