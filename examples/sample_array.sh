#!/bin/bash
#SBATCH --array=1-8
#SBATCH --ntasks=1
# Samples of a robot by an array of jobs: sbatch examples/sample_array.sh ROBOT COUNT OUT, OUT in a folder that all nodes share.
# Where a job was lost, submit the same again: what is there stays, and the bytes are those of one process.
set -euo pipefail
hydrostat sample "$1" --count "$2" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --jobs 1 --out "$3"
