"""The amplitude equations against the Galerkin projection of Navier-Stokes by quadrature."""

import dataclasses
import functools
import math
from typing import NamedTuple

import numpy as np
import pytest
from helpers_modes import velocity_gradient
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.arrays import FloatArray
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.mfe_modes import MoehlisFaisstEckhardtModes

BOXES = [(4 * math.pi, 2 * math.pi), (1.75 * math.pi, 1.2 * math.pi), (3.0, 7.0)]


class Projection(NamedTuple):
    """The tensors of the projection: advection, diffusion (times Re) and force (times Re)."""

    advection: FloatArray
    diffusion: FloatArray
    force: FloatArray


@functools.cache
def projection(length_x: float, length_z: float) -> Projection:
    modes = MoehlisFaisstEckhardtModes(length_x, length_z)
    x = np.arange(12) * length_x / 12  # exact for the products of three first harmonics
    z = np.arange(12) * length_z / 12
    y, weight = np.polynomial.legendre.leggauss(40)
    grid = np.meshgrid(x, y, z, indexing="ij")
    measure = (np.ones((12, 1, 12)) * weight[:, np.newaxis] / (2 * 12 * 12)).ravel()
    velocity = modes.velocity(np.eye(9), *grid).reshape(3, 9, -1)
    gradient = velocity_gradient(modes, np.eye(9), *grid).reshape(3, 3, 9, -1)
    carried = np.einsum("djg,cdkg->cjkg", velocity, gradient)
    force = np.zeros_like(velocity[:, 0])
    force[0] = math.sqrt(2) * math.pi**2 / 4 * np.sin(math.pi / 2 * grid[1].ravel())
    return Projection(
        advection=np.einsum("cig,cjkg,g->ijk", velocity, carried, measure, optimize=True),
        diffusion=-np.einsum("cdig,cdjg,g->ij", gradient, gradient, measure, optimize=True),
        force=np.einsum("cig,cg,g->i", velocity, force, measure),
    )


def states(seed: int, count: int) -> FloatArray:
    return np.random.default_rng(seed).uniform(-1, 1, (9, count))


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("reynolds", [17.0, 400.0, 2000.0])
def test_right_hand_side_is_the_galerkin_projection(
    box: tuple[float, float], reynolds: float
) -> None:
    a = states(1, 50)
    tensors = projection(*box)
    expected = -np.einsum("ijk,jn,kn->in", tensors.advection, a, a)
    expected += (tensors.diffusion @ a + tensors.force[:, np.newaxis]) / reynolds
    actual = MoehlisFaisstEckhardt(reynolds, *box).right_hand_side(a)
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("box", BOXES)
def test_energy_changes_by_force_and_viscosity_only(box: tuple[float, float]) -> None:
    a = states(2, 50)
    tensors = projection(*box)
    system = MoehlisFaisstEckhardt(250.0, *box)
    work = tensors.force @ a / 250.0
    dissipation = np.einsum("in,ij,jn->n", a, tensors.diffusion, a) / 250.0
    change = np.sum(a * system.right_hand_side(a), axis=0)
    np.testing.assert_allclose(change, work + dissipation, rtol=0, atol=1e-12)


@pytest.mark.parametrize("box", BOXES)
def test_jacobian_is_the_complex_step_derivative(box: tuple[float, float]) -> None:
    a = states(3, 20)
    system = MoehlisFaisstEckhardt(400.0, *box)
    expected = np.empty((9, 9, 20))
    for j in range(9):
        perturbed = a.astype(complex)
        perturbed[j] += 1e-30j
        expected[:, j] = system.right_hand_side(perturbed).imag / 1e-30
    np.testing.assert_allclose(system.jacobian(a), expected, rtol=0, atol=1e-14)


def test_laminar_state_is_a_stable_fixed_point_of_energy_one_half() -> None:
    system = MoehlisFaisstEckhardt(400.0)
    laminar = np.eye(9)[0]
    assert not system.right_hand_side(laminar).any()
    assert system.observable(laminar) == 0.5
    assert (np.linalg.eigvals(system.jacobian(laminar)).real < 0).all()


@pytest.mark.parametrize(
    "signs",
    [(1, 1, 1, -1, -1, -1, -1, -1, 1), (1, -1, -1, 1, 1, -1, -1, -1, 1)],
    ids=["half a period in x", "half a period in z"],
)
def test_translations_by_half_a_period_are_symmetries(signs: tuple[int, ...]) -> None:
    a = states(4, 30)
    system = MoehlisFaisstEckhardt(600.0)
    flip = np.array(signs)[:, np.newaxis]
    assert np.array_equal(system.right_hand_side(flip * a), flip * system.right_hand_side(a))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 40), data=st.data())
def test_trajectories_of_a_batch_are_independent_bit_for_bit(
    seed: int, count: int, data: st.DataObject
) -> None:
    a = states(seed, count)
    index = data.draw(st.integers(0, count - 1))
    own_reynolds = np.random.default_rng(seed).uniform(50, 2000, count)
    for system, alone in [
        (MoehlisFaisstEckhardt(400.0), MoehlisFaisstEckhardt(400.0)),
        (MoehlisFaisstEckhardt(own_reynolds), MoehlisFaisstEckhardt(float(own_reynolds[index]))),
    ]:
        for method in ("right_hand_side", "jacobian", "observable"):
            in_batch = getattr(system, method)(a)[..., index]
            assert np.array_equal(in_batch, getattr(alone, method)(a[:, index]))
            in_view = getattr(alone, method)(a.T.copy().T[:, index : index + 1])
            assert np.array_equal(in_batch, in_view[..., 0])


def test_further_axes_of_the_state_are_independent_too() -> None:
    a = states(5, 12).reshape(9, 2, 6)
    system = MoehlisFaisstEckhardt(np.linspace(100, 600, 6))
    for method in ("right_hand_side", "jacobian", "observable"):
        both = getattr(system, method)(a)
        assert np.array_equal(both[..., 1, :], getattr(system, method)(a[:, 1]))


def test_observable_is_half_the_sum_of_squares() -> None:
    a = states(6, 10)
    energy = MoehlisFaisstEckhardt(400.0).observable(a)
    np.testing.assert_allclose(energy, 0.5 * (a**2).sum(axis=0), rtol=1e-15)


def test_right_hand_side_leaves_the_state_alone() -> None:
    a = states(7, 5)
    before = a.copy()
    MoehlisFaisstEckhardt(400.0).right_hand_side(a)
    assert np.array_equal(a, before)


def test_empty_batch() -> None:
    assert MoehlisFaisstEckhardt(400.0).right_hand_side(np.empty((9, 0))).shape == (9, 0)


def test_replace_recomputes_the_coefficients() -> None:
    a = states(8, 4)
    replaced = dataclasses.replace(MoehlisFaisstEckhardt(400.0), reynolds=2000.0, length_x=5.0)
    direct = MoehlisFaisstEckhardt(2000.0, length_x=5.0)
    assert replaced == direct
    assert np.array_equal(replaced.right_hand_side(a), direct.right_hand_side(a))


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize("name", ["reynolds", "length_x", "length_z"])
def test_bad_parameters_raise(name: str, bad: float) -> None:
    with pytest.raises(ValueError, match=f"{name} must be positive and finite"):
        MoehlisFaisstEckhardt(**({"reynolds": 400.0} | {name: bad}))


def test_bad_arrays_of_parameters_raise() -> None:
    with pytest.raises(ValueError, match="reynolds must be positive"):
        MoehlisFaisstEckhardt(np.array([400.0, 0.0]))
    with pytest.raises(ValueError, match="length_x must be one number"):
        MoehlisFaisstEckhardt(400.0, length_x=np.array([1.0, 2.0]))  # type: ignore[arg-type]
