"""The nine-mode shear flow: equations against the Galerkin projection, modes against a table."""

import dataclasses
import functools
import math

import numpy as np
import pytest

from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.mfe_modes import MoehlisFaisstEckhardtModes

STEP = 0.005
# of order eight, at distances of one to four steps
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)


def velocity_gradient(modes, amplitudes, *grid):
    """Gradient ``(3, 3, ..., *grid)``; ``[i, j]`` is d u_i / d x_j."""

    def shifted(direction, distance):
        moved = [axis + distance * (number == direction) for number, axis in enumerate(grid)]
        return modes.velocity(amplitudes, *moved)

    slopes = [
        sum(
            weight * (shifted(direction, n * STEP) - shifted(direction, -n * STEP)) / STEP
            for n, weight in enumerate(WEIGHTS, 1)
        )
        for direction in range(3)
    ]
    return np.stack(slopes, axis=1)


BOXES = [(4 * math.pi, 2 * math.pi), (1.75 * math.pi, 1.2 * math.pi), (3.0, 7.0)]


@functools.cache
def projection(length_x, length_z):
    """The tensors of the projection: advection, diffusion (times Re) and force (times Re)."""
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
    return (
        np.einsum("cig,cjkg,g->ijk", velocity, carried, measure, optimize=True),
        -np.einsum("cdig,cdjg,g->ij", gradient, gradient, measure, optimize=True),
        np.einsum("cig,cg,g->i", velocity, force, measure),
    )


def states(seed, count):
    return np.random.default_rng(seed).uniform(-1, 1, (9, count))


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("reynolds", [17.0, 400.0, 2000.0])
def test_right_hand_side_is_the_galerkin_projection(box, reynolds):
    a = states(1, 50)
    advection, diffusion, force = projection(*box)
    expected = -np.einsum("ijk,jn,kn->in", advection, a, a)
    expected += (diffusion @ a + force[:, np.newaxis]) / reynolds
    actual = MoehlisFaisstEckhardt(reynolds, *box).right_hand_side(a)
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12)


def test_a_replaced_parameter_recomputes_the_coefficients():
    a = states(8, 4)
    replaced = dataclasses.replace(MoehlisFaisstEckhardt(400.0), reynolds=2000.0, length_x=5.0)
    direct = MoehlisFaisstEckhardt(2000.0, length_x=5.0)
    assert replaced == direct
    assert np.array_equal(replaced.right_hand_side(a), direct.right_hand_side(a))


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize("name", ["reynolds", "length_x", "length_z"])
def test_bad_parameters_raise(name, bad):
    with pytest.raises(ValueError, match=f"{name} must be positive and finite"):
        MoehlisFaisstEckhardt(**({"reynolds": 400.0} | {name: bad}))


def test_bad_boxes_and_amplitudes_raise():
    with pytest.raises(ValueError, match="length_z must be positive"):
        MoehlisFaisstEckhardtModes(length_z=0.0)
    with pytest.raises(ValueError, match="9 amplitudes, not 3"):
        MoehlisFaisstEckhardtModes().velocity(np.zeros(3), np.zeros(1), np.zeros(1), np.zeros(1))


# -- modes and fields ------------------------------------------------------------------------------


def published_modes(box, x, y, z):
    """The table of Moehlis, Faisst and Eckhardt (2004), transcribed; ``(3, 9, *grid)``."""
    a, g, pi = 2 * math.pi / box[0], 2 * math.pi / box[1], math.pi
    x, y, z = np.broadcast_arrays(x, y, z)
    sx, cx, sz, cz = np.sin(a * x), np.cos(a * x), np.sin(g * z), np.cos(g * z)
    sy, cy = np.sin(pi * y / 2), np.cos(pi * y / 2)
    zero = np.zeros_like(sx)
    r = math.sqrt
    n3 = 2 / r(4 * g**2 + pi**2)
    n6 = 4 * r(2) / r(3 * (a**2 + g**2))
    n7 = 2 * r(2) / r(a**2 + g**2)
    n8 = 2 * r(2) / r((a**2 + g**2) * (4 * a**2 + 4 * g**2 + pi**2))
    modes = [
        [r(2) * sy, zero, zero],
        [4 / r(3) * cy**2 * cz, zero, zero],
        [zero, n3 * 2 * g * cy * cz, n3 * pi * sy * sz],
        [zero, zero, 4 / r(3) * cx * cy**2],
        [zero, zero, 2 * sx * sy],
        [-n6 * g * cx * cy**2 * sz, zero, n6 * a * sx * cy**2 * cz],
        [n7 * g * sx * sy * sz, zero, n7 * a * cx * sy * cz],
        [
            n8 * pi * a * sx * sy * sz,
            n8 * 2 * (a**2 + g**2) * cx * cy * sz,
            -n8 * pi * g * cx * sy * cz,
        ],
        [r(2) * np.sin(3 * pi * y / 2), zero, zero],
    ]
    return np.moveaxis(np.array(modes), 1, 0)


@pytest.fixture(params=BOXES)
def box(request):
    return request.param


@pytest.fixture
def modes(box):
    return MoehlisFaisstEckhardtModes(*box)


@pytest.fixture
def grid(box):
    """Uniform in x and z: exact for products of modes; ``(x, y, z)``, open."""
    x, z = (np.arange(16) * length / 16 for length in box)
    return np.meshgrid(x, np.linspace(-1, 1, 9), z, indexing="ij", sparse=True)


def amplitudes(*count):
    return np.random.default_rng(1).uniform(-1, 1, (9, *count))


def test_modes_are_the_published_ones(box, grid, modes):
    actual = modes.velocity(np.eye(9), *grid)
    np.testing.assert_allclose(actual, published_modes(box, *grid), rtol=0, atol=1e-14)


def test_vorticity_is_the_curl_of_the_velocity(grid, modes):
    gradient = velocity_gradient(modes, amplitudes(), *grid)
    curl = [gradient[i, j] - gradient[j, i] for i, j in ((2, 1), (0, 2), (1, 0))]
    np.testing.assert_allclose(modes.vorticity(amplitudes(), *grid), curl, rtol=0, atol=1e-10)


def test_fields_are_linear_and_take_any_grid(grid, modes):
    a = amplitudes(2, 3)
    for field in (modes.velocity, modes.vorticity):
        many = field(a, *grid)
        expected = np.einsum("ci...,ijk->cjk...", field(np.eye(9), *grid), a)
        np.testing.assert_allclose(many, expected, atol=1e-13)
        point = field(
            a[:, 1, 2], *(axis.ravel()[at] for axis, at in zip(grid, (3, 5, 7), strict=True))
        )
        np.testing.assert_allclose(point, many[:, 1, 2, 3, 5, 7], atol=1e-14)


def test_midplane_velocity_and_its_mean_square(grid, modes):
    a, (x, _, z) = amplitudes(25), grid
    plane = modes.midplane_velocity(a, x.ravel(), z.ravel()[:9])
    full = modes.velocity(a, x[:, 0], np.array(0.0), z.ravel()[:9])
    np.testing.assert_allclose(plane, full[0], rtol=0, atol=1e-15)
    square = modes.midplane_mean_square(a @ a.T / 25, x.ravel(), z.ravel()[:9])
    np.testing.assert_allclose(square, np.mean(plane**2, axis=0), rtol=0, atol=1e-14)


def test_the_box_is_that_of_the_equations_unless_it_is_said():
    equations, modes = MoehlisFaisstEckhardt(400.0), MoehlisFaisstEckhardtModes()
    lengths = [(flow.length_x, flow.length_z) for flow in (equations, modes)]
    assert lengths == [BOXES[0], BOXES[0]]
