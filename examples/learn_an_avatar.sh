#!/usr/bin/env bash
# From a capture to an avatar that follows a face, step by step; docs/learning.md says what each step does.
#
#   examples/learn_an_avatar.sh [FOLDER [STAGE ...]]
#
# FOLDER (default: learned) gets everything; each stage leaves a picture there, and the last one a table. What is
# finished is skipped; name stages to do these anew, and what is made of them the next time. What was stopped goes on.
# The whole takes less than half an hour on two cores.
# At the paper's size, where an NVIDIA GPU and gsplat are (100000 steps take hours, 3000 some minutes):
#   CAMERAS=16 SIZE=550x802 SPLIT=96+32 PRESET=full STEPS=3000 COMPONENTS=50 examples/learn_an_avatar.sh large
# Your own capture instead of the synthetic one:  CAPTURE=/path/to/capture examples/learn_an_avatar.sh mine
# NAME (default: the folder's), AUTHOR, LICENCE and CONSENT say in the avatars whose face it is, and what was agreed to.
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

# Whose face it is: the avatars' files keep it.
mkdir -p "$folder/.done"
about=(--name "${NAME:-$(basename "$(cd "$folder" && pwd)")}" --author "${AUTHOR:-}" --licence "${LICENCE:-}"
    --consent "${CONSENT:-}")

# Whether the capture has pictures in a split, of which only train has to be there.
has() {
    grep -qs '"file_path"' "$capture/transforms_$1.json"
}

# 1. A person before many cameras, and a tracked mesh that is off by a millimetre, as real trackers are.
capture() {
    "$gemheads" capture "$capture" --cameras "$cameras" --size "$size" --split "$split" --tracking-noise "$noise"
    cp "$capture/images/00000_00.png" "$folder/1_capture.png"
}

# 2. What the tracked mesh alone gives: the table compares with it.
mesh() {
    "$gemheads" distill "$capture" -o "$folder/mesh.gem" --components "$components" --maps "$maps" \
        --moments "$folder/mesh.track" "${about[@]}"
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
        --moments "$folder/distilled.track" "${about[@]}"
    "$gemheads" modes "$folder/distilled.gem" -o "$folder/4_distill.png" --components 2
}

# 5. Its bases, changed until they draw what the cameras saw.
refine() {
    "$gemheads" refine "$folder/distilled.gem" "$capture" -o "$folder/refined.gem" --iterations "$iterations" \
        --start "$folder/distilled.track" --moments "$folder/refined.track" --sheet "$folder/5_refine.png" "$perceptual"
}

# 6. Expressions it never saw, found in the pictures alone; where none are held out, what another camera or training saw.
fit() {
    local split=train
    if has test; then split=test; elif has val; then split=val; fi
    "$gemheads" fit "$folder/refined.gem" "$capture" -o "$folder/fitted.track" --errors "$folder/6_fit.png" \
        --split "$split"
}

# 7. A network from a face to coefficients, learned from the person's own frames; shown on expressions held out.
regressor() {
    local strip=()
    if has test; then strip=(--strip "$folder/7_regressor.png"); fi
    "$gemheads" train-regressor "$folder/refined.gem" "$capture" -o "$folder/avatar.gem" --pictures "$pictures" \
        --steps "$lessons" --labels "$folder/refined.track" --report "$folder/regressor.json" \
        ${strip[@]+"${strip[@]}"}
}

# 8. Somebody else drives.
reenact() {
    "$gemheads" reenact "$driver" --avatar "$folder/avatar.gem" --side-by-side -o "$folder/8_reenact.mp4"
}

# 9. How good all of them are where nothing was learned from.
table() {
    if ! has val && ! has test; then
        echo "table: $capture holds out no pictures (transforms_val.json, transforms_test.json), so nothing is judged"
        return
    fi
    "$python" "$here/tests/bench/learning_table.py" "$capture" --mesh "$folder/mesh.gem" --run "$folder/run" \
        --distilled "$folder/distilled.gem" --refined "$folder/refined.gem" --moments "$folder/refined.track" \
        --shots "$shots" --network "$network" --json "$folder/table.json" --picture "$folder/9_table.png"
}

# Which stages use what one makes.
followers() {
    case $1 in
        capture) echo mesh train distill refine fit regressor reenact table ;;
        mesh) echo table ;;
        train) echo distill refine fit regressor reenact table ;;
        distill) echo refine fit regressor reenact table ;;
        refine) echo fit regressor reenact table ;;
        regressor) echo reenact ;;
    esac
}

# Removes what a stage made, but never a capture of yours.
clear_away() {
    cd "$folder"
    case $1 in
        capture) if [ -z "${CAPTURE:-}" ]; then rm -rf capture 1_capture.png; fi ;;
        mesh) rm -f mesh.gem mesh.track 2_mesh.png ;;
        train) rm -rf run 3_train.png ;;
        distill) rm -f distilled.gem distilled.track 4_distill.png ;;
        refine) rm -f refined.gem refined.track 5_refine.png ;;
        fit) rm -f fitted.track 6_fit.png ;;
        regressor) rm -f avatar.gem regressor.json 7_regressor.png ;;
        reenact) rm -f 8_reenact.mp4 ;;
        table) rm -f table.json 9_table.png ;;
    esac
}

stages=(capture mesh train distill refine fit regressor reenact table)
if [ $# -gt 1 ]; then
    shift
    stages=("$@")
    for stage in "${stages[@]}"; do
        for old in "$stage" $(followers "$stage"); do
            if [ -e "$folder/.done/$old" ]; then mv "$folder/.done/$old" "$folder/.done/$old.old"; fi
        done
    done
fi
for stage in "${stages[@]}"; do
    if [ -e "$folder/.done/$stage" ]; then
        echo "$stage: finished before"
        continue
    fi
    if [ -e "$folder/.done/$stage.old" ]; then
        (clear_away "$stage")
        rm "$folder/.done/$stage.old"
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
