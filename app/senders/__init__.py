"""Where the avatar goes besides the window: files, a virtual camera, the network of this machine."""
