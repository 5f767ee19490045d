"""The CNN avatar: what it answers untrained, that gradients reach all of it, and that a mesh carries its splats."""

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.captures.layout import Tracked  # noqa: E402
from gemheads.models.captures.texels import Texels, texels_of  # noqa: E402
from gemheads.models.train.avatars.cnn import Architecture, CnnAvatar  # noqa: E402
from gemheads.models.train.avatars.deform import deform, moment_of  # noqa: E402
from gemheads.models.train.avatars.focus import focus_map, regions_of  # noqa: E402
from gemheads.models.train.avatars.residuals import BOUND, Residuals  # noqa: E402
from gemheads.models.train.avatars.runs import arrays_of  # noqa: E402
from gemheads.models.train.avatars.styleunet import StyleUNet  # noqa: E402
from gemheads.render.gaussians import RawGaussians  # noqa: E402
from gemheads.render.rotations import matrix_from_wxyz, wxyz_from_rotvec  # noqa: E402
from toycapture import PARTS, cameras, template  # noqa: E402

NOWHERE = np.zeros(3, np.float32)
SMALL = Architecture(size=32, width=4, levels=2)


@pytest.fixture(scope="module")
def texels() -> Texels:
    return texels_of(template(), 32)


@pytest.fixture
def avatar(texels: Texels) -> CnnAvatar:
    torch.manual_seed(0)
    return CnnAvatar(texels, SMALL)


def tracked(vertices: np.ndarray) -> Tracked:
    return Tracked(vertices.astype(np.float32), NOWHERE, NOWHERE, None)


def talking(amount: float = 1.0) -> np.ndarray:
    vertices = template().vertices.astype(np.float64)
    vertices[:, 1] += 0.3 * amount * np.minimum(vertices[:, 1] + 0.02, 0)
    return vertices


def stirred(avatar: CnnAvatar) -> CnnAvatar:
    """With weights as if it had learned something."""
    generator = torch.Generator().manual_seed(1)
    with torch.no_grad():
        for share in avatar.network.shares:
            share.weight.copy_(0.3 * torch.randn(share.weight.shape, generator=generator))
        avatar.constant.copy_(torch.randn(avatar.constant.shape, generator=generator))
    return avatar


def assert_same(found: RawGaussians, wanted: RawGaussians, tolerance: float = 2e-6) -> None:
    for name, value in vars(wanted).items():
        np.testing.assert_allclose(getattr(found, name), value, atol=tolerance, err_msg=name)


def test_an_untrained_network_answers_nothing_at_every_size() -> None:
    for levels in (1, 3):
        maps = torch.randn(2, 5, 32, 32)
        answer = StyleUNet(5, 7, 4, levels)(maps)
        assert answer.shape == (2, 7, 32, 32)
        assert not answer.any()


def test_an_untrained_avatar_is_the_bare_mesh(avatar: CnnAvatar, texels: Texels) -> None:
    vertices = talking()
    found, residuals = avatar(moment_of(texels, tracked(vertices)))
    assert not any(part.any() for part in residuals)
    splats = texels.splats(np.full((len(texels), 3), 0.5))
    assert_same(arrays_of(found), texels.carried(splats, vertices))
    assert_same(arrays_of(avatar(moment_of(texels, tracked(vertices)), bare=True)[0]), arrays_of(found))


def test_deformation_is_that_of_the_texels(avatar: CnnAvatar, texels: Texels) -> None:
    vertices = talking()
    moment = moment_of(texels, tracked(vertices))
    canonical = avatar.canonical(stirred(avatar).residuals(moment))
    found = deform(canonical, avatar.rest, moment)
    assert_same(arrays_of(found), texels.carried(arrays_of(canonical), vertices), 1e-5)
    assert ((found.wxyz * canonical.wxyz).sum(1) > 0).all()


def test_a_rigid_motion_is_exact(avatar: CnnAvatar, texels: Texels) -> None:
    turn = matrix_from_wxyz(wxyz_from_rotvec(np.array([0.3, -0.8, 0.5])))
    still, moved = (moment_of(texels, tracked(x)) for x in (template().vertices, template().vertices @ turn.T + 0.1))
    canonical = avatar.canonical(stirred(avatar).residuals(still))
    before, after = (arrays_of(deform(canonical, avatar.rest, moment)) for moment in (still, moved))
    np.testing.assert_allclose(after.positions, before.positions @ turn.T + 0.1, atol=1e-6)
    np.testing.assert_allclose(after.log_scales, before.log_scales, atol=1e-5)
    np.testing.assert_allclose(matrix_from_wxyz(after.wxyz), turn @ matrix_from_wxyz(before.wxyz), atol=1e-5)


def test_gradients_flow_to_all_outputs_and_weights(avatar: CnnAvatar, texels: Texels) -> None:
    moment = moment_of(texels, tracked(talking()))
    raw, residuals = stirred(avatar)(moment)
    for part in residuals:
        (slope,) = torch.autograd.grad(part.sum(), avatar.constant, retain_graph=True)
        assert slope.any()
    sum((tensor * torch.randn_like(tensor)).sum() for tensor in raw).backward()
    for name, parameter in avatar.named_parameters():
        assert parameter.grad is not None, name
        assert torch.isfinite(parameter.grad).all(), name
        assert parameter.grad.any(), name


def test_residuals_are_bounded(avatar: CnnAvatar, texels: Texels) -> None:
    with torch.no_grad():
        avatar.constant.fill_(1e6)
    residuals = avatar.residuals(moment_of(texels, tracked(talking())))
    for part, bound in zip(residuals, BOUND.values(), strict=True):
        torch.testing.assert_close(part, torch.full_like(part, bound))
    raw = avatar.canonical(residuals)
    torch.testing.assert_close(raw.wxyz.norm(dim=1), torch.ones(len(texels)))


def test_the_answer_follows_the_expression_not_the_head(avatar: CnnAvatar, texels: Texels) -> None:
    stirred(avatar)
    open_mouth = tracked(talking())
    turned = Tracked(open_mouth.vertices, np.float32([0, 0.5, 0]), NOWHERE, None)
    first, second, third = (avatar(moment_of(texels, one))[0] for one in (open_mouth, turned, tracked(talking(0.2))))
    assert_same(arrays_of(first), arrays_of(second), 0)
    assert (first.opacity_logits - third.opacity_logits).abs().max() > 1e-3


def test_no_residual_is_forgotten(avatar: CnnAvatar) -> None:
    assert tuple(BOUND) == Residuals._fields


def test_people_look_at_mouth_and_eyes(texels: Texels) -> None:
    regions = regions_of(texels, PARTS)
    assert len(regions) == 3
    positions = texels.spread(template().vertices)
    camera = cameras(64)[1]
    focus = focus_map(regions, positions, camera)
    mouth = positions[texels.part == 2].mean(0)
    seen = camera.world_to_camera[:3, :3] @ mouth + camera.world_to_camera[:3, 3]
    column, row = (camera.fx * seen[:2] / seen[2] + camera.cx).astype(int)
    assert focus[row, column] > 0.9
    assert focus[2, 2] == 0
    assert 0.01 < focus.mean() < 0.3
    assert not regions_of(texels, ("skin", "skin", "skin"))
