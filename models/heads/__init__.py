"""The animatable MakeHuman head: mesh and shapes, skin, performances, baking poses into splats."""
