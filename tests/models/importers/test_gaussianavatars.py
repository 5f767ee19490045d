"""Splats on the triangles of a mesh: they go where it goes, and what is broken is refused."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.models.gemfile import load_gem
from gemheads.models.importers.adopt import adopt
from gemheads.models.importers.foreign import ForeignFormatError
from gemheads.models.importers.gaussianavatars import is_bound, open_bound
from gemheads.models.importers.meshes import open_meshes
from gemheads.render.rotations import matrix_from_wxyz, normalized, wxyz_from_rotvec
from plyfile import PlyData, PlyElement

SIDE = 10
NAMES = "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()


def mesh(smile: float = 0.0, turn: float = 0.0) -> np.ndarray:
    """[100, 3] a bent sheet as high as a head; ``smile`` pulls its lowest row, ``turn`` radians about y."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-0.08, 0.08, SIDE), np.linspace(-0.1, 0.15, SIDE)))
    vertices = np.stack([x, y, 0.05 - 4 * x * x], 1)
    vertices[:SIDE] += [0, -0.02 * smile, 0.01 * smile]
    return (vertices @ matrix_from_wxyz(wxyz_from_rotvec(np.array([0, turn, 0]))).T).astype(np.float32)


def triangles() -> np.ndarray:
    corner = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)[:-1, :-1].ravel()
    quads = np.stack([corner, corner + 1, corner + SIDE, corner + 1, corner + SIDE + 1, corner + SIDE], 1)
    return quads.reshape(-1, 3)


def write_ply(path: Path, binding: np.ndarray | None = None, **columns: float) -> Path:
    """Two splats a triangle, as GaussianAvatars writes them."""
    rng = np.random.default_rng(4)
    count = 2 * len(triangles())
    names = [*NAMES, "binding_0"]
    table = np.zeros(count, [(name, "<f4") for name in names])
    for axis in "xyz":
        table[axis] = rng.normal(0, 0.2, count)
    quaternions = normalized(rng.normal(size=(count, 4)))
    for i in range(4):
        table[f"rot_{i}"] = quaternions[:, i]
    for i in range(3):
        table[f"scale_{i}"] = rng.uniform(-2, -1, count)
    table["opacity"] = 2
    table["binding_0"] = np.arange(count) // 2 if binding is None else binding
    for name, value in columns.items():
        table[name] = value
    path.parent.mkdir(parents=True, exist_ok=True)
    PlyData([PlyElement.describe(table, "vertex")], byte_order="<").write(str(path))
    return path


def write_meshes(folder: Path, frames: list[np.ndarray]) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    for index, vertices in enumerate(frames):
        extra = {"triangles": triangles()} if index == 0 else {}
        np.savez(folder / f"{index}.npz", vertices=vertices, **extra)
    return folder


def test_a_splat_lies_in_the_frame_of_its_triangle(tmp_path: Path) -> None:
    """The published rule, for one triangle by hand: edge along x, so the normal is z and the third axis y."""
    corners = np.float32([[0, 0, 0], [0.3, 0, 0], [0, 0.2, 0]])
    np.savez(tmp_path / "0.npz", vertices=corners, triangles=[[0, 1, 2]])
    table = np.zeros(1, [(name, "<f4") for name in [*NAMES, "binding_0"]])
    table["x"], table["y"], table["z"] = 0.1, 0.5, -0.2
    table["rot_0"], table["opacity"], table["scale_1"] = 1, 1, np.log(0.5)
    PlyData([PlyElement.describe(table, "vertex")], byte_order="<").write(str(tmp_path / "one.ply"))
    from gemheads.models.importers import gaussianavatars as ga
    from gemheads.models.importers.splatply import read_splats

    frames = ga.triangle_frames(corners, np.array([[0, 1, 2]]), None)
    assert frames.sizes[0] == pytest.approx(0.25)
    raw = ga.carried(read_splats(tmp_path / "one.ply"), np.array([0]), frames)
    # x along the edge, y along the normal, z against the height: the third axis is edge x normal
    np.testing.assert_allclose(raw.positions[0], [0.1 + 0.025, 1 / 15 + 0.2 * 0.25, 0.125], atol=1e-6)
    np.testing.assert_allclose(np.exp(raw.log_scales[0]), [0.25, 0.125, 0.25], rtol=1e-5)
    np.testing.assert_allclose(matrix_from_wxyz(raw.wxyz)[0], [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-6)


def test_an_avatar_comes_of_it_and_the_head_is_held_still(tmp_path: Path) -> None:
    smiles = [0, 0.5, 1, 0.25, 0.75]
    write_meshes(tmp_path / "meshes", [mesh(smile, 0.2 * i) for i, smile in enumerate(smiles)])
    path = write_ply(tmp_path / "point_cloud.ply")
    assert is_bound(path)
    source = open_bound(path)
    gem, distilled = adopt(source, "Sheet", 10)
    assert distilled.variance_kept["position"][0] > 0.98, "one smile, and next to no head motion"
    first, smiling = list(source.frames())[:3:2]
    np.testing.assert_allclose(gem.compose(gem.rest_coefficients).positions, first.positions, atol=1e-5)
    still = np.arange(len(first)) >= 4 * (SIDE - 1)
    assert np.abs(smiling.positions - first.positions)[still].max() < 1e-3
    assert np.abs(smiling.positions - first.positions)[~still].max() > 0.01
    # stretched triangles stretch what lies on them
    assert (smiling.log_scales - first.log_scales)[~still].max() > 0.05


def test_the_command_reads_the_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, out = tmp_path / "avatar", tmp_path / "s.gem"
    write_ply(folder / "point_cloud.ply")
    assert main(["distill", str(folder), "-o", str(out)]) == 3
    assert "give --meshes" in capsys.readouterr().err
    meshes = write_meshes(tmp_path / "frames", [mesh(s) for s in (0, 1, 0.5)])
    assert main(["distill", str(folder), "-o", str(out), "--meshes", str(meshes)]) == 0
    assert "324 splats from 3 frames" in capsys.readouterr().out
    assert load_gem(out).about["source"] == "GaussianAvatars PLY avatar, 3 frames"


def test_meshes_in_one_file_as_obj_and_beside_a_template_are_the_same(tmp_path: Path) -> None:
    frames = [mesh(s) for s in (0, 0.5)]
    np.savez(tmp_path / "all.npz", vertices=np.stack(frames), faces=triangles())
    (tmp_path / "objs").mkdir()
    for index, vertices in enumerate(frames):
        lines = [f"v {x} {y} {z}" for x, y, z in vertices.tolist()] + ["vn 0 0 1"]
        lines += [f"f {a}/1/1 {b}//1 {c}" for a, b, c in (triangles() + 1).tolist()]
        (tmp_path / "objs" / f"mesh_{index}.obj").write_text("\n".join(lines))
    (tmp_path / "bare").mkdir()
    for index, vertices in enumerate(frames):
        np.savez(tmp_path / "bare" / f"{index}.npz", vertices=vertices)
    np.savez(tmp_path / "template.npz", vertices=frames[0], triangles=triangles())
    for place in ("all.npz", "objs", "bare"):
        sequence = open_meshes(tmp_path / place)
        assert sequence.count == 2
        np.testing.assert_array_equal(sequence.triangles, triangles())
        np.testing.assert_allclose(sequence.vertices(1), frames[1], atol=1e-6)


def test_what_macos_puts_beside_a_mesh_is_none(tmp_path: Path) -> None:
    folder = write_meshes(tmp_path / "meshes", [mesh(), mesh(1.0)])
    (folder / "._0.npz").write_bytes(b"attributes")
    assert open_meshes(folder).count == 2


def lying(path: Path) -> None:
    """A header that claims a hundred thousand million vertices."""
    header = b"{'descr': '<f4', 'fortran_order': False, 'shape': (100000000000, 3), }\n"
    with zipfile.ZipFile(path, "w") as packed:
        packed.writestr("vertices.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + b"\0" * 64)


HOSTILE: dict[str, tuple[Callable[[Path], object], str]] = {
    "no files": (lambda at: (at / "meshes" / "0.npz").unlink(), "there is no mesh"),
    "objects": (lambda at: np.savez(at / "meshes" / "0.npz", vertices=np.array([{}])), "plain arrays"),
    "no zip": (lambda at: (at / "meshes" / "0.npz").write_bytes(b"PK nonsense"), "plain arrays"),
    "a lying header": (lambda at: lying(at / "meshes" / "0.npz"), "cannot be read|more than there is"),
    "NaN": (
        lambda at: np.savez(at / "meshes" / "0.npz", vertices=mesh() * np.float32(np.nan), triangles=triangles()),
        "not finite",
    ),
    "far": (
        lambda at: np.savez(at / "meshes" / "0.npz", vertices=mesh() * np.float64(1e30), triangles=triangles()),
        "beyond 1000",
    ),
    "no triangles": (lambda at: np.savez(at / "meshes" / "0.npz", vertices=mesh()), "no template.npz"),
    "triangles beyond": (
        lambda at: np.savez(at / "meshes" / "0.npz", vertices=mesh(), triangles=triangles() + 1),
        "none of its 100 vertices",
    ),
    "negative triangles": (
        lambda at: np.savez(at / "meshes" / "0.npz", vertices=mesh(), triangles=triangles() - 1),
        "none of its 100 vertices",
    ),
    "another mesh later": (lambda at: np.savez(at / "meshes" / "1.npz", vertices=mesh()[:50]), "50x3"),
    "an .obj of quads": (lambda at: (at / "meshes" / "0.npz").rename(at / "x") and quad(at), "nor triangle in line 5"),
    "bound beyond": (lambda at: write_ply(at / "point_cloud.ply", binding_0=162), "among the 162 triangles"),
    "bound below": (lambda at: write_ply(at / "point_cloud.ply", binding_0=-1), "among the 162 triangles"),
    "bound between": (lambda at: write_ply(at / "point_cloud.ply", binding_0=0.5), "among the 162 triangles"),
    "bound nowhere": (lambda at: write_ply(at / "point_cloud.ply", binding_0=np.nan), "among the 162 triangles"),
}


def quad(at: Path) -> None:
    (at / "meshes" / "0.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_broken_is_refused_with_its_name(name: str, tmp_path: Path) -> None:
    spoil, said = HOSTILE[name]
    write_meshes(tmp_path / "meshes", [mesh()])
    write_ply(tmp_path / "point_cloud.ply")
    spoil(tmp_path)
    with pytest.raises(ForeignFormatError, match=said) as caught:
        list(open_bound(tmp_path / "point_cloud.ply").frames())
    assert "; " in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_triangle_without_an_area_keeps_its_splats_finite(tmp_path: Path) -> None:
    flat = mesh()
    flat[:3] = flat[0]
    write_meshes(tmp_path / "meshes", [mesh(), flat])
    for frame in open_bound(write_ply(tmp_path / "point_cloud.ply")).frames():
        for values in vars(frame).values():
            assert np.isfinite(values).all()
