"""The format of avatars: golden bytes, round trips, and what a plain safetensors reader sees."""

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gemheads.models.compaction import compact
from gemheads.models.gem import CHANNELS, MODALITIES, Basis, Gem, Viewing
from gemheads.models.gemfile import load_gem, read_info, save_gem
from safetensors.numpy import load_file

GOLDEN_SIZE = 4641
GOLDEN_SHA256 = "e1428670d264eacc5113eccef839cacd92752fe6883972877655fb555bb0d555"


def saved(gem: Gem, folder: Path, basis: str = "int8", name: str = "a.gem") -> Path:
    save_gem(gem, folder / name, basis)
    return folder / name


def same(first: Gem, second: Gem) -> None:
    for name in ("colors", "neck_weights", "neck_pivot", "uv_index", "arkit_weights", "rest"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name), name)
    for name in MODALITIES:
        np.testing.assert_array_equal(first.bases[name].rows, second.bases[name].rows, name)
        np.testing.assert_array_equal(first.bases[name].sigma, second.bases[name].sigma, name)
    assert (first.name, first.about, first.viewing, first.uv_size) == (
        second.name,
        second.about,
        second.viewing,
        second.uv_size,
    )


def test_golden_bytes(tiny_gem: Gem, tmp_path: Path) -> None:
    content = saved(replace(tiny_gem, regressor=b"graph"), tmp_path).read_bytes()
    assert (len(content), hashlib.sha256(content).hexdigest()) == (GOLDEN_SIZE, GOLDEN_SHA256)


def test_a_plain_reader_can_compose(tiny_gem: Gem, tmp_path: Path) -> None:
    tensors = load_file(saved(tiny_gem, tmp_path))
    k = np.float32([0.5, -0.25, 0.125])
    positions = tensors["position.mean"].copy()
    components = tensors["position.components"] * tensors["position.scale"][:, None, None]
    positions[tensors["position.kept"]] += np.tensordot(k, components, 1)
    flat = np.concatenate([k, np.zeros(4, np.float32)])
    np.testing.assert_allclose(positions, tiny_gem.compose(flat).positions, atol=0.01)
    assert tensors["position.components"].dtype == np.int8
    assert tensors["position.kept"].tolist() == [0, 1, 2, 3]
    assert tensors["opacity.components"].shape == (0, 0, 1)


@pytest.mark.parametrize("basis", ["int8", "fp16"])
def test_nothing_else_is_lost(tiny_gem: Gem, tmp_path: Path, basis: str) -> None:
    gem = load_gem(saved(tiny_gem, tmp_path, basis))
    exact = replace(gem, bases=tiny_gem.bases)
    same(exact, tiny_gem)
    for name in MODALITIES:
        largest = np.abs(tiny_gem.bases[name].components).max(initial=0)
        error = np.abs(gem.bases[name].rows - tiny_gem.bases[name].rows)
        assert error[0].max() == 0
        assert error.max() <= (largest / 254 * 1.001 if basis == "int8" else largest / 2**11)


@pytest.mark.parametrize("basis", ["int8", "fp16"])
def test_saving_what_was_loaded_changes_no_byte(tmp_path: Path, basis: str) -> None:
    first = saved(random_gem(), tmp_path, basis)
    assert saved(load_gem(first), tmp_path, basis, "b.gem").read_bytes() == first.read_bytes()


def test_a_regressor_is_added_without_touching_the_rest(tmp_path: Path) -> None:
    gem = load_gem(saved(random_gem(), tmp_path))
    again = load_gem(saved(replace(gem, regressor=b"graph"), tmp_path, name="b.gem"))
    same(gem, again)
    assert gem.regressor is None
    assert again.regressor == b"graph"


def test_splats_that_stand_still_are_left_out_unseen() -> None:
    gem = random_gem()
    basis = gem.bases["position"]
    stored = compact("position", basis, "int8")
    assert len(stored.kept) == 60
    left = np.setdiff1d(np.arange(100), stored.kept)
    lost = 3 * basis.sigma[:, None, None] * basis.components.reshape(8, 100, 3)[:, left]
    assert np.linalg.norm(np.abs(lost).sum(0), axis=-1).max() < 60e-6


def test_the_header_tells_without_the_tensors(tiny_gem: Gem, tmp_path: Path) -> None:
    path = saved(replace(tiny_gem, regressor=b"graph"), tmp_path)
    info = read_info(path)
    assert info.card.name == "Tiny"
    assert info.layout.components == {"position": 3, "rotation": 2, "scale": 2, "opacity": 0}
    assert info.layout.splats == 6
    assert info.bytes == path.stat().st_size
    assert info.card.regressor is not None
    assert info.card.regressor.sha256 == hashlib.sha256(b"graph").hexdigest()


def test_the_payload_checksum_is_of_the_payload(tiny_gem: Gem, tmp_path: Path) -> None:
    content = saved(tiny_gem, tmp_path).read_bytes()
    header = json.loads(content[8 : 8 + int.from_bytes(content[:8], "little")])
    payload = content[8 + int.from_bytes(content[:8], "little") :]
    card = json.loads(header["__metadata__"]["gemheads"])
    assert card["payload_sha256"] == hashlib.sha256(payload).hexdigest()
    assert (len(content) - len(payload)) % 8 == 0


def test_a_name_in_any_script_survives(tiny_gem: Gem, tmp_path: Path) -> None:
    assert load_gem(saved(replace(tiny_gem, name='Zoë "Ω" \n🙂'), tmp_path)).name == 'Zoë "Ω" \n🙂'


def test_a_typical_head_has_at_most_8_mb(tmp_path: Path) -> None:
    counts = {"position": 0.55, "rotation": 0.55, "scale": 0.45, "opacity": 0.1}
    path = saved(random_gem(25_000, 50, counts), tmp_path)
    assert path.stat().st_size <= 8 * 2**20


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"colors": np.full((6, 3), 1.5, np.float32)}, "'colors' has values outside 0 to 1"),
        ({"neck_weights": np.full(6, np.nan, np.float32)}, "'neck_weights' has values that are not finite"),
        ({"about": {"source": "x" * 70_000}}, "shorten them"),
        ({"about": {"source": 3}}, "name or origin is not text"),
        ({"viewing": Viewing((0.0, 0.0, 0.0), 0.0)}, "viewing"),
        ({"uv_size": 2}, "outside of a map of 2 texels"),
        ({"neck_pivot": np.float32([0, 0, 2e4])}, "'neck_pivot' has values beyond"),
    ],
)
def test_what_could_not_be_opened_is_not_saved(tiny_gem: Gem, tmp_path: Path, change: dict, said: str) -> None:
    path = saved(tiny_gem, tmp_path)
    before = path.read_bytes()
    with pytest.raises(ValueError, match=said):
        saved(replace(tiny_gem, **change), tmp_path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("row", "value", "said"),
    [
        (0, np.nan, "'position.mean' has values"),
        (1, np.nan, "components that are not"),
        (1, 1e9, "moves splats by more"),
    ],
)
def test_a_basis_that_could_not_be_opened_is_not_saved(
    tiny_gem: Gem, tmp_path: Path, row: int, value: float, said: str
) -> None:
    tiny_gem.bases["position"].rows[row, 2] = value
    with pytest.raises(ValueError, match=said):
        saved(tiny_gem, tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_rest_beyond_all_bounds_is_not_saved(tiny_gem: Gem, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="moves splats by more"):
        saved(replace(tiny_gem, rest=np.full(tiny_gem.coefficient_count, 1e6, np.float32)), tmp_path)


def test_another_basis_type_is_refused(tiny_gem: Gem, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not 'int4'"):
        saved(tiny_gem, tmp_path, "int4")


def test_a_save_that_fails_leaves_nothing(tiny_gem: Gem, tmp_path: Path) -> None:
    (tmp_path / "a.gem").mkdir()
    with pytest.raises(OSError, match="directory"):
        saved(tiny_gem, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["a.gem"]


def random_gem(splats: int = 100, count: int = 8, moving: dict[str, float] | None = None) -> Gem:
    """An avatar of which a part of the splats moves."""
    rng = np.random.default_rng(0)
    bases = {}
    for name in MODALITIES:
        shape = (count, splats, CHANNELS[name])
        components = rng.normal(size=shape).astype(np.float32) / np.float32(np.sqrt(splats))
        components[:, int(splats * (moving or {}).get(name, 0.6)) :] *= 1e-6
        rows = np.concatenate([rng.normal(size=(1, shape[1] * shape[2])), components.reshape(count, -1)])
        bases[name] = Basis(rows.astype(np.float32), np.linspace(2, 0.1, count).astype(np.float32))
    total = 4 * count
    return Gem(
        name="Random",
        bases=bases,
        colors=rng.random((splats, 3), np.float32).astype(np.float16).astype(np.float32),
        neck_weights=rng.random(splats, np.float32),
        neck_pivot=np.zeros(3, np.float32),
        uv_index=rng.integers(0, 256, (splats, 2)).astype(np.uint16),
        uv_size=256,
        viewing=Viewing((0.0, 0.0, 0.0), 0.25),
        arkit_weights=rng.normal(size=(52, total)).astype(np.float32),
        rest=np.zeros(total, np.float32),
        about={},
    )
