// A three.js renderer on a canvas of its own, and the camera of the bench: matrices as given, nothing recomputed.

import * as THREE from "three";

export class Stage {
  constructor(background) {
    this.renderer = new THREE.WebGLRenderer({ antialias: false });
    this.renderer.setPixelRatio(1);
    // in the page, as viewers ask the page for its size, but unseen: composing the window is nobody's picture
    this.renderer.domElement.style.visibility = "hidden";
    document.body.append(this.renderer.domElement);
    this.renderer.setClearColor(new THREE.Color().setRGB(...background, THREE.SRGBColorSpace), 1);
    this.camera = new THREE.PerspectiveCamera();
    this.gl = this.renderer.getContext();
    this.pixel = new Uint8Array(4);
  }

  // width, height; near, far; projection: 16 numbers, column after column
  setLens({ width, height, near, far, projection }) {
    const canvas = this.renderer.domElement;
    if (canvas.width !== width || canvas.height !== height) this.renderer.setSize(width, height);
    const fov = (360 / Math.PI) * Math.atan(1 / projection[5]); // only for what culls by it
    Object.assign(this.camera, { near, far, fov, aspect: width / height });
    this.camera.projectionMatrix.fromArray(projection);
    this.camera.projectionMatrixInverse.copy(this.camera.projectionMatrix).invert();
  }

  // camera to world, OpenGL's axes: 16 numbers, column after column
  setPose(pose) {
    new THREE.Matrix4()
      .fromArray(pose)
      .decompose(this.camera.position, this.camera.quaternion, this.camera.scale);
    this.camera.updateMatrixWorld(true);
  }

  // gl.finish() does not wait in browsers; reading a pixel does
  finish() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, this.pixel);
  }

  // RGBA bytes, the lowest row first
  pixels() {
    const { width, height } = this.renderer.domElement;
    const bytes = new Uint8Array(4 * width * height);
    this.gl.readPixels(0, 0, width, height, this.gl.RGBA, this.gl.UNSIGNED_BYTE, bytes);
    return bytes;
  }

  rendererName() {
    const info = this.gl.getExtension("WEBGL_debug_renderer_info");
    return this.gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : this.gl.RENDERER);
  }
}
