// Spark, updated and sorted before each frame instead of beside it.

import { SparkRenderer, SplatMesh } from "@sparkjsdev/spark";
import * as THREE from "three";

export async function open(stage, settings) {
  const scene = new THREE.Scene();
  const spark = new SparkRenderer({
    renderer: stage.renderer,
    autoUpdate: false,
    preBlurAmount: settings.dilation,
    blurAmount: 0, // the same dilation with opacities taken back, which these splats were not made for
    sortRadial: false,
  });
  spark.readPause = 0; // a wait, not work
  const mesh = new SplatMesh({ url: settings.splats });
  await mesh.initialized;
  scene.add(spark, mesh);
  return {
    sort: () => spark.update({ scene, camera: stage.camera }),
    draw: () => stage.renderer.render(scene, stage.camera),
  };
}
