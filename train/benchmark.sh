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

# The shipped policies' recipe, three seeds each: one track with distances, one with touch alone.
policy() { # distance, teacher, seed
    python train/ppo.py --env-id TaskGrasp-v0 --topology all --noise blind --distance "$1" \
        --control-mode pd_synergy_wrist --teacher "$2" --teacher-lessons 6 --teacher-logstd -2.3 \
        --num-envs 144 --num-steps 92 --num-minibatches 12 --gamma 0.98 --gae-lambda 0.95 \
        --learning-rate 5e-5 --target-kl 0.02 --total-timesteps 132480 --eval-freq 5 --save-freq 5 \
        --eval-episodes 288 --num-eval-envs 144 --seed "$3" --runs-dir "$RUNS" --exp-name "$1_$3"
}
for seed in 1 2 3; do  # The files that are shipped are ckpt_0.pt of seed 1: PPO gained nothing.
    policy noisy follow "$seed"
    policy none guarded "$seed"
done

# The paper's learner, one topology: 50 000 samples.
python train/ppo.py --preset paper --topology "precision pad abd 2-3" --runs-dir "$RUNS" --exp-name paper

table() { # name, flags
    taskgrasp evaluate --seed 2026 --out "$OUT/$1" "${@:2}"
}
FOLLOW=(--policy follow --distance exact)
table table1-own --table paper --search 5 --episodes 100 "${FOLLOW[@]}"
table table1-stored --table paper --episodes 20 "${FOLLOW[@]}"
table feasible-own --table feasible --search 5 --episodes 10 "${FOLLOW[@]}"
table feasible-stored --table feasible --episodes 10 "${FOLLOW[@]}"
for noise in blind hard; do
    row() { # policy, distance
        table "$1-$2-$noise" --table paper --search 5 --noise "$noise" --episodes 10 \
            --policy "$1" --distance "$2"
    }
    row constant exact
    row hover-rule noisy
    row guarded none
    for distance in exact noisy none; do
        row follow "$distance"
        row learned "$distance"
    done
done
table sentences --instructions tests/data/instructions_test.jsonl --limit 100 --episodes 1 \
    --search 1 "${FOLLOW[@]}"
# MESHES: a folder of meshes of your own, such as the authors' twenty.
if [ -n "${MESHES:-}" ]; then
    table meshes --mesh-dir "$MESHES" --search 5 --episodes 20 "${FOLLOW[@]}"
fi
