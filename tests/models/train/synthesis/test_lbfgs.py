"""L-BFGS finds minima, and finds the next one sooner with what it learned from the first."""

import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.synthesis.lbfgs import Memory, Objective, minimise  # noqa: E402

SCALES = torch.logspace(-1, 2, 12, dtype=torch.float64)


def bowl(middle: "torch.Tensor") -> Objective:
    return lambda x: (float((SCALES * (x - middle) ** 2).sum() / 2), SCALES * (x - middle))


def valley(x: "torch.Tensor") -> tuple[float, "torch.Tensor"]:
    """Rosenbrock's, the minimum 0 at (1, 1)."""
    x = x.detach().requires_grad_()
    value = (1 - x[0]) ** 2 + 100 * (x[1] - x[0] ** 2) ** 2
    return float(value.detach()), torch.autograd.grad(value, x)[0]


def test_finds_the_end_of_a_bent_valley() -> None:
    point, value, _ = minimise(valley, torch.tensor([-1.2, 1.0], dtype=torch.float64), 120)
    assert value < 1e-8
    assert torch.allclose(point, torch.ones(2, dtype=torch.float64), atol=1e-3)


def test_memory_serves_the_next_problem() -> None:
    first, middle = torch.ones(12, dtype=torch.float64), torch.full((12,), 1.3, dtype=torch.float64)
    point, value, memory = minimise(bowl(first), torch.zeros(12, dtype=torch.float64), 60)
    assert value < 1e-6
    with_memory, without = (minimise(bowl(middle), point, 6, known)[1] for known in (memory, ()))
    assert with_memory < 0.05 * without


def test_keeps_to_its_evaluations_and_never_rises() -> None:
    calls = []

    def counted(x: "torch.Tensor") -> tuple[float, "torch.Tensor"]:
        calls.append(valley(x)[0])
        return valley(x)

    _, value, memory = minimise(counted, torch.tensor([-1.2, 1.0], dtype=torch.float64), 15, history=3)
    assert len(calls) <= 15
    assert value == min(calls) < calls[0]
    assert 1 <= len(memory) <= 3


def test_a_memory_that_misleads_is_forgotten() -> None:
    wrong: Memory = ((torch.tensor([1.0, 0.0]).double() * 1e6, torch.tensor([1.0, 0.0]).double()),)
    _, value, _ = minimise(valley, torch.tensor([-1.2, 1.0], dtype=torch.float64), 150, wrong)
    assert value < 1e-6


def test_what_is_not_finite_is_refused() -> None:
    with pytest.raises(FloatingPointError, match="not finite"):
        minimise(valley, torch.tensor([float("nan"), 1.0], dtype=torch.float64), 10)
