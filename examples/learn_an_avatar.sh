#!/usr/bin/env bash
# From a capture to an avatar that follows a face, step by step; docs/learning.md says what each step does.
#
#   examples/learn_an_avatar.sh [FOLDER [STAGE ...]]
#
# FOLDER (default: learned) gets everything; each stage leaves a picture there, and the last one a table. What is
# finished is skipped; name stages to do these again. The whole takes less than half an hour on two cores.
# At the paper's size, where an NVIDIA GPU and gsplat are (100000 steps take hours, 3000 some minutes):
#   CAMERAS=16 SIZE=550x802 SPLIT=96+32 PRESET=full STEPS=3000 COMPONENTS=50 examples/learn_an_avatar.sh large
# Your own capture instead of the synthetic one:  CAPTURE=/path/to/capture examples/learn_an_avatar.sh mine
set -euo pipefail
folder=${1:-learned}
here=$(cd "$(dirname "$0")/.." && pwd)
capture=${CAPTURE:-$folder/capture}
driver=${DRIVER:-$here/assets/demo/driver.mp4}
# the environment that `make` left in .venv, unless another one is active or named
gemheads=$(command -v "${GEMHEADS:-gemheads}" || echo "$here/.venv/bin/gemheads")
python=${PYTHON:-$(dirname "$gemheads")/python3}

# How much of everything; smaller is faster, and worse.
cameras=${CAMERAS:-10} size=${SIZE:-256x256} split=${SPLIT:-48+16} noise=${NOISE:-1}
preset=${PRESET:-tiny} steps=${STEPS:-2500} components=${COMPONENTS:-30} iterations=${ITERATIONS:-2000}
maps=${MAPS:-$([ "$preset" = full ] && echo 256 || echo 128)} # the preset's own
pictures=${PICTURES:-1500} lessons=${LESSONS:-3000} perceptual=${PERCEPTUAL:---perceptual} shots=${SHOTS:-24}
network=${NETWORK:-vgg}

# 1. A person before many cameras, and a tracked mesh that is off by a millimetre, as real trackers are.
capture() {
    "$gemheads" capture "$capture" --cameras "$cameras" --size "$size" --split "$split" --tracking-noise "$noise"
    cp "$capture/images/00000_00.png" "$folder/1_capture.png"
}

# 2. What the tracked mesh alone gives: the table compares with it.
mesh() {
    "$gemheads" distill "$capture" -o "$folder/mesh.gem" --components "$components" --maps "$maps" \
        --moments "$folder/mesh.track"
    "$gemheads" modes "$folder/mesh.gem" -o "$folder/2_mesh.png" --components 2
}

# 3. The CNN avatar: from the posed mesh to splats. It goes on where it was stopped.
train() {
    "$gemheads" train "$capture" -o "$folder/run" --preset "$preset" --maps "$maps" --steps "$steps" "$perceptual"
    cp "$(find "$folder/run/previews" -name '*.png' | sort | tail -n 1)" "$folder/3_train.png"
}

# 4. The CNN's splats at every moment, as a linear model.
distill() {
    "$gemheads" distill "$folder/run" -o "$folder/distilled.gem" --components "$components" \
        --moments "$folder/distilled.track"
    "$gemheads" modes "$folder/distilled.gem" -o "$folder/4_distill.png" --components 2
}

# 5. Its bases, changed until they draw what the cameras saw.
refine() {
    "$gemheads" refine "$folder/distilled.gem" "$capture" -o "$folder/refined.gem" --iterations "$iterations" \
        --start "$folder/distilled.track" --moments "$folder/refined.track" --sheet "$folder/5_refine.png" "$perceptual"
}

# 6. Expressions it never saw, found in the pictures alone.
fit() {
    "$gemheads" fit "$folder/refined.gem" "$capture" -o "$folder/fitted.track" --errors "$folder/6_fit.png"
}

# 7. A network from a face to coefficients, learned from the person's own frames.
regressor() {
    "$gemheads" train-regressor "$folder/refined.gem" "$capture" -o "$folder/avatar.gem" --pictures "$pictures" \
        --steps "$lessons" --labels "$folder/refined.track" --report "$folder/regressor.json" \
        --strip "$folder/7_regressor.png"
}

# 8. Somebody else drives.
reenact() {
    "$gemheads" reenact "$driver" --avatar "$folder/avatar.gem" --side-by-side -o "$folder/8_reenact.mp4"
}

# 9. How good all of them are where nothing was learned from.
table() {
    "$python" "$here/tests/bench/learning_table.py" "$capture" --mesh "$folder/mesh.gem" --run "$folder/run" \
        --distilled "$folder/distilled.gem" --refined "$folder/refined.gem" --moments "$folder/refined.track" \
        --shots "$shots" --network "$network" --json "$folder/table.json" --picture "$folder/9_table.png"
}

stages=(capture mesh train distill refine fit regressor reenact table)
mkdir -p "$folder/.done"
if [ $# -gt 1 ]; then
    shift
    stages=("$@")
    for stage in "${stages[@]}"; do rm -f "$folder/.done/$stage"; done
fi
for stage in "${stages[@]}"; do
    if [ -e "$folder/.done/$stage" ]; then
        echo "$stage: finished before"
        continue
    fi
    started=$SECONDS
    if [ "$stage" = capture ] && [ -n "${CAPTURE:-}" ]; then
        echo "capture: $capture"
    else
        "$stage"
    fi
    touch "$folder/.done/$stage"
    echo "$stage: $((SECONDS - started)) s"
done
