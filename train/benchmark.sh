#!/usr/bin/env bash
# The exact commands of every published policy and table; hours on two cores. RUNS and OUT say where.
set -euo pipefail
cd "$(dirname "$0")/.."
RUNS=${RUNS:-runs}
OUT=${OUT:-reports}
export OMP_NUM_THREADS=1

# Grasps searched on train objects -> assets/pregrasps.json (adds to what is there).
python train/pregrasps.py --per-topology 24 --generations 7 --first 2
python train/pregrasps.py --remeasure --remeasure-trials 16
python train/pregrasps.py --per-topology 24 --generations 4 --first 2 --again .8

# The shipped policies' recipe, three seeds each: one for distances, one for touch alone. Seed 1 is shipped.
policy() { # distance, teacher, seed
    python train/ppo.py --env-id TaskGrasp-v0 --topology all --noise blind --distance "$1" \
        --control-mode pd_synergy_wrist --teacher "$2" --teacher-lessons 6 --teacher-logstd -2.3 \
        --num-envs 288 --num-steps 92 --num-minibatches 4 --gamma 0.98 --gae-lambda 0.95 \
        --learning-rate 3e-5 --target-kl 0.08 --total-timesteps 264960 --eval-freq 10 --save-freq 10 \
        --eval-episodes 288 --num-eval-envs 144 --seed "$3" --runs-dir "$RUNS" --exp-name "$1_$3"
}
for seed in 1 2 3; do
    policy noisy follow "$seed"
    policy none guarded "$seed"
done
python train/ship.py "$RUNS/noisy_1/final_ckpt.pt" assets/checkpoints/policy_distance.pt
python train/ship.py "$RUNS/none_1/final_ckpt.pt" assets/checkpoints/policy_touch.pt

table() { # name, flags
    taskgrasp evaluate --seed 2026 --out "$OUT/$1" "${@:2}"
}
FOLLOW=(--policy follow --distance exact)
table table1-own --table paper --search 5 --episodes 100 "${FOLLOW[@]}"
table table1-stored --table paper --episodes 20 "${FOLLOW[@]}"
table feasible-own --table feasible --search 5 --episodes 10 "${FOLLOW[@]}"
table feasible-stored --table feasible --episodes 10 "${FOLLOW[@]}"
# The paper's learner, a run for each topology of Table I (50 000 samples), beside constant closing.
python - <<'PAIRS' | while IFS='|' read -r topology first second third; do
import json
from itertools import groupby
pairs = json.load(open("assets/evaluation_pairs.json"))["paper"]
for topology, group in groupby(pairs, key=lambda pair: pair["topology"]):
    print(topology, *(pair["object"] for pair in group), sep="|")
PAIRS
    name=paper-$(tr ' ' - <<< "$topology")
    python train/ppo.py --preset paper --topology "$topology" --runs-dir "$RUNS" --exp-name "$name" < /dev/null
    for policy in constant "$RUNS/$name/final_ckpt.pt"; do
        label=$([ "$policy" = constant ] && echo constant || echo learned)
        table "$name-$label" --topologies "$topology" --objects "$first" "$second" "$third" \
            --search 5 --episodes 100 --policy "$policy" < /dev/null
    done
done
for noise in blind hard; do  # Searches go on under wide noise: up to 768 trials more a pair.
    row() { # policy, distance
        table "$(tr / - <<< "$1")-$2-$noise" --table paper --search 5 --noise "$noise" --episodes 10 \
            --policy "$1" --distance "$2"
    }
    row constant exact
    row hover-rule noisy
    row guarded none
    row probing none
    for distance in exact noisy none; do
        row follow "$distance"
        row learned "$distance"
    done
    for seed in 1 2 3; do
        row "$RUNS/noisy_$seed/final_ckpt.pt" exact
        row "$RUNS/noisy_$seed/final_ckpt.pt" noisy
        row "$RUNS/none_$seed/final_ckpt.pt" none
    done
done
table sentences --instructions tests/data/instructions_test.jsonl --limit 100 --episodes 1 \
    --search 1 "${FOLLOW[@]}"
# MESHES: a folder of meshes of your own, such as the authors' twenty.
if [ -n "${MESHES:-}" ]; then
    table meshes --mesh-dir "$MESHES" --search 5 --episodes 20 "${FOLLOW[@]}"
fi
# FURNITURE: a folder of Sweet Home 3D catalogues, such as Debian's /usr/share/sweethome3d/furniture.
if [ -n "${FURNITURE:-}" ]; then
    taskgrasp objects import "$FURNITURE"
    table furniture --objects imported --search 1 --episodes 10 "${FOLLOW[@]}"
    table furniture-stored --objects imported --episodes 10 "${FOLLOW[@]}"
fi
# Eight primitives, constant closing, friction 1 (docs/cpu_batch.md).
python train/scripted.py --json > "$OUT/scripted.json"
