// Asks the bench for one task after the other and posts what came of it. A task names a viewer (opened at its first
// task) and a lens, and wants either a picture or the times of some frames.

import * as gaussianSplats3D from "./gaussiansplats3d.js";
import { settings } from "./settings.js";
import * as spark from "./spark.js";
import { Stage } from "./stage.js";

const kinds = { "gaussian-splats-3d": gaussianSplats3D, spark };
const opened = {};

async function open(name) {
  const stage = new Stage(settings.background);
  return { stage, ...(await kinds[name].open(stage, settings)) };
}

async function work(task) {
  opened[task.viewer] ??= await open(task.viewer);
  const { stage, sort, draw } = opened[task.viewer];
  stage.setLens(task.lens);
  if (task.wants === "renderer") return { renderer: stage.rendererName() };
  if (task.wants === "picture") {
    stage.setPose(task.poses[0]);
    await sort();
    draw();
    return stage.pixels();
  }
  const frames = [];
  for (const pose of task.poses) {
    stage.setPose(pose);
    stage.finish();
    const began = performance.now();
    await sort();
    const sorted = performance.now();
    draw();
    stage.finish();
    frames.push({ sort: sorted - began, frame: performance.now() - began });
  }
  return { frames };
}

async function answer(result) {
  const bytes = result instanceof Uint8Array;
  const headers = { "Content-Type": bytes ? "application/octet-stream" : "application/json" };
  await fetch("/answer", { method: "POST", headers, body: bytes ? result : JSON.stringify(result) });
}

for (;;) {
  const response = await fetch("/task");
  if (response.status === 204) continue; // nothing to do yet
  if (!response.ok) break; // the bench is over
  let result;
  try {
    result = await work(await response.json());
  } catch (error) {
    result = { error: String(error?.stack ?? error) };
  }
  await answer(result);
}
