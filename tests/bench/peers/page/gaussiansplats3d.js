// GaussianSplats3D, driven frame by frame: its own loop and controls are off.

import * as GaussianSplats3D from "@mkkellogg/gaussian-splats-3d";

export async function open(stage, settings) {
  const viewer = new GaussianSplats3D.Viewer({
    renderer: stage.renderer,
    camera: stage.camera,
    selfDrivenMode: false,
    useBuiltInControls: false,
    ignoreDevicePixelRatio: true,
    sceneRevealMode: GaussianSplats3D.SceneRevealMode.Instant,
    kernel2DSize: settings.dilation,
    integerBasedSort: false, // whole numbers are millimetres, and half of a head's splats would tie
  });
  await viewer.addSplatScene(settings.splats, { showLoadingUI: false, format: GaussianSplats3D.SceneFormat.Ply });
  return {
    // left to itself it sorts again only after a turn of 8 degrees or a metre's way
    sort: async () => {
      await viewer.runSplatSort(true, true);
      await viewer.sortPromise;
    },
    draw: () => {
      viewer.update();
      viewer.render();
    },
  };
}
