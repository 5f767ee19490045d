"""What the subject's surfaces and the studio's light are like, as nodes of Cycles."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ..heads.skinflow import SPREAD_M
from .bending import PORE_M
from .lamps import BULBS, LAMPS, ROOM
from .mirroring import BULB_COS
from .raster import CUT, LASH_OPACITY
from .shading import OILY
from .subject import Subject, linear

SKY_WIDTH = 512
"""Pixels around the horizon; the sharpest thing in it, a bulb, is 9 degrees wide."""
BULB_RADIANCE = 20.0
"""Of what eyes and wet skin mirror as a glint; it lights nothing, for the lamps around it already do."""
SUBSURFACE = 0.8
SKIN_ROUGHNESS = 0.45
SKIN_IOR, EYE_IOR, TOOTH_IOR = 1.40, 1.376, 1.54
"""Of the surface's mirroring: the reflectances of ``shading``, (n - 1)^2 / (n + 1)^2."""
LASH_COLOR = (0.012, 0.012, 0.012)


def sky(bpy: Any) -> Any:
    """A world whose light is that of ``lamps``, from every direction."""
    world = bpy.data.worlds.new("studio")
    tree = _nodes(world)
    background = tree.nodes["Background"]
    add = tree.nodes.new("ShaderNodeMixRGB")
    add.blend_type = "ADD"
    path = tree.nodes.new("ShaderNodeLightPath")
    lamps, bulbs = sky_images()
    for socket, name, image in (("Color1", "lamps", lamps), ("Color2", "bulbs", bulbs)):
        node = tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = picture(bpy, name, image)
        tree.links.new(node.outputs["Color"], add.inputs[socket])
    tree.links.new(path.outputs["Is Glossy Ray"], add.inputs["Fac"])
    tree.links.new(add.outputs["Color"], background.inputs["Color"])
    return world


def sky_images() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Radiance [H, W, 3] of the lamps and the room, and of the bulbs: Blender's panoramas, whose axis is our z."""
    width, height = SKY_WIDTH, SKY_WIDTH // 2
    around = -2 * np.pi * ((np.arange(width) + 0.5) / width - 0.5)
    up = np.pi * (0.5 - (np.arange(height) + 0.5) / height)[:, None]
    toward = np.stack(np.broadcast_arrays(np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)), -1)
    lamps = np.tile(np.array(ROOM), (height, width, 1))
    for direction, color, width_of, _ in LAMPS:
        axis = np.array(direction) / np.linalg.norm(direction)
        lamps += np.exp(width_of * (toward @ axis - 1))[..., None] * np.array(color)
    bulbs = np.zeros_like(lamps)
    for direction, strength in BULBS:
        cos = toward @ (np.array(direction) / np.linalg.norm(direction))
        edge = np.clip((cos - BULB_COS[0]) / (BULB_COS[1] - BULB_COS[0]), 0, 1)
        bulbs += BULB_RADIANCE * strength * edge[..., None]
    return lamps.astype(np.float32), bulbs.astype(np.float32)


def surfaces(bpy: Any, subject: Subject) -> list[Any]:
    """Materials of skin, eyes, teeth, tongue, hair and lashes: the parts' numbers, then one more for lashes."""
    albedo = picture(bpy, "albedo", subject.albedo)
    # half of everything, so that a quarter of OILY brings half of it to a level whose neutral value is 0.5;
    # all of it, as in ``shading``, would be chalky on what really lets light in
    detail = picture(bpy, "detail", subject.detail * np.array([0.25 * OILY, 1, 0.5]) + np.array([0, 0, 0.5]))
    skin, shader = _material(bpy, "skin", albedo)
    _set(shader, {"Roughness": SKIN_ROUGHNESS, "IOR": SKIN_IOR, "Subsurface Weight": SUBSURFACE})
    _set(shader, {"Subsurface Radius": SPREAD_M, "Subsurface Scale": 1.0})
    _add_detail(skin.node_tree, shader, detail)
    eyes, shader = _material(bpy, "eyes", albedo)
    _set(shader, {"Roughness": 0.5, "Coat Weight": 0.6, "Coat Roughness": 0.03, "Coat IOR": EYE_IOR})
    _set(shader, {"Specular IOR Level": 0.0})
    teeth, shader = _material(bpy, "teeth", albedo)
    _set(shader, {"Roughness": 0.3, "IOR": TOOTH_IOR, "Subsurface Weight": 0.3})
    _set(shader, {"Subsurface Radius": SPREAD_M, "Subsurface Scale": 0.5})
    tongue, shader = _material(bpy, "tongue", albedo)
    _set(shader, {"Roughness": 0.4, "IOR": SKIN_IOR})
    hair, shader = _material(bpy, "hair", picture(bpy, "hair", hair_image(subject)))
    # cards are smooth: what they mirror at a slant would be a grey helmet
    _set(shader, {"Roughness": 1.0, "Specular IOR Level": 0.0})
    lash, shader = _material(bpy, "lash", picture(bpy, "lash", lash_image(subject)))
    _set(shader, {"Roughness": 0.6, "Specular IOR Level": 0.0})
    return [skin, eyes, teeth, tongue, hair, lash]


def hair_image(subject: Subject) -> NDArray[np.float32]:
    """Linear colour and opacity [H, W, 4] of the cards of hair; what ``raster`` takes as there is there."""
    mean, light = linear(subject.hair_color)
    level = subject.hair[..., :1]
    color = (mean + (light - mean) * np.clip((level - 0.45) * 1.6, 0, 1)) * (0.35 + 0.9 * level)
    # steep, not a step: Cycles interpolates what is stored
    opaque = np.clip((subject.hair[..., 1:] - CUT) * 8 + 0.5, 0, 1)
    return np.concatenate([color, opaque], -1).astype(np.float32)


def lash_image(subject: Subject) -> NDArray[np.float32]:
    """The same of lashes."""
    opaque = LASH_OPACITY * subject.lash[..., 1:]
    color = np.broadcast_to(np.array(LASH_COLOR), (*opaque.shape[:2], 3))
    return np.concatenate([color, opaque], -1).astype(np.float32)


def picture(bpy: Any, name: str, image: Floats) -> Any:
    """An image of linear colours [H, W, 3 or 4], row 0 on top."""
    height, width, channels = image.shape
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :channels] = image
    made = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True)
    made.colorspace_settings.name = "Non-Color"
    made.alpha_mode = "CHANNEL_PACKED"
    made.pixels.foreach_set(np.ascontiguousarray(pixels[::-1]).ravel())
    made.update()
    return made


def _material(bpy: Any, name: str, image: Any) -> tuple[Any, Any]:
    """A material whose colour and opacity are an image's, and its shader."""
    material = bpy.data.materials.new(name)
    tree = _nodes(material)
    shader = tree.nodes["Principled BSDF"]
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.extension = image, "EXTEND"
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(node.outputs["Alpha"], shader.inputs["Alpha"])
    return material, shader


def _add_detail(tree: Any, shader: Any, detail: Any) -> None:
    """Sheen and pores of the skin."""
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = detail
    split = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(node.outputs["Color"], split.inputs["Color"])
    tree.links.new(split.outputs["Red"], shader.inputs["Specular IOR Level"])
    bump = tree.nodes.new("ShaderNodeBump")
    bump.inputs["Distance"].default_value = 2 * PORE_M
    tree.links.new(split.outputs["Blue"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])


def _nodes(owner: Any) -> Any:
    """The nodes of a new material or world: there from the start since Blender 5, which warns of asking for them."""
    if owner.node_tree is None:
        owner.use_nodes = True
    return owner.node_tree


def _set(shader: Any, values: dict[str, Any]) -> None:
    for name, value in values.items():
        shader.inputs[name].default_value = value
