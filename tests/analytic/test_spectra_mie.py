"""Spheres against Mie's series in multiple precision, published values and the known limits."""

from __future__ import annotations

import miepython
import mpmath
import numpy as np
import pytest

from analytic import phase, spectra
from analytic.spectra.bands import WAVELENGTHS
from analytic.spectra.mie_phase import intensity_moments, table

WAVELENGTH = 500.0  # [nm]


def radius_of(size):
    """Radius [um] of size parameter `size` at WAVELENGTH."""
    return size * WAVELENGTH * 1e-3 / (2 * np.pi)


class Oracle:
    """Mie's solution by Bessel functions in 30 digits (Bohren and Huffman 1983, Eqs. 4.46, 4.53, 4.61, 4.62, 4.74)."""

    def __init__(self, size, index):
        with mpmath.workdps(30):
            self.size, m = mpmath.mpf(size), mpmath.mpc(index)
            self.a, self.b = zip(*(self._coefficients(n, m) for n in range(1, int(size) + 25)), strict=True)

    def _coefficients(self, n, m):
        def psi(z, order=0):
            return mpmath.diff(psi, z) if order else mpmath.sqrt(mpmath.pi * z / 2) * mpmath.besselj(n + 0.5, z)

        def xi(z, order=0):
            # Hankel's second function: waves that leave, in the convention of n - ik
            return mpmath.diff(xi, z) if order else mpmath.sqrt(mpmath.pi * z / 2) * mpmath.hankel2(n + 0.5, z)

        x, y = self.size, m * self.size
        a = (m * psi(y) * psi(x, 1) - psi(x) * psi(y, 1)) / (m * psi(y) * xi(x, 1) - xi(x) * psi(y, 1))
        b = (psi(y) * psi(x, 1) - m * psi(x) * psi(y, 1)) / (psi(y) * xi(x, 1) - m * xi(x) * psi(y, 1))
        return a, b

    def efficiency(self, kind):
        terms = zip(self.a, self.b, strict=True)
        value = {"extinction": lambda a, b: (a + b).real, "scattering": lambda a, b: abs(a) ** 2 + abs(b) ** 2}[kind]
        return float(2 / self.size**2 * sum((2 * n + 1) * value(a, b) for n, (a, b) in enumerate(terms, 1)))

    def intensity(self, mu):
        """(|S_1|^2 + |S_2|^2) / 2; pi_n = P_n' and tau_n by derivatives of Legendre's polynomials."""
        mu = mpmath.mpf(mu)
        s_1 = s_2 = 0
        pi, before = mpmath.mpf(1), mpmath.mpf(0)
        for n, (a, b) in enumerate(zip(self.a, self.b, strict=True), 1):
            tau = n * mu * pi - (n + 1) * before
            s_1 += mpmath.mpf(2 * n + 1) / (n * (n + 1)) * (a * pi + b * tau)
            s_2 += mpmath.mpf(2 * n + 1) / (n * (n + 1)) * (a * tau + b * pi)
            pi, before = ((2 * n + 1) * mu * pi - (n + 1) * before) / n, pi
        return float((abs(s_1) ** 2 + abs(s_2) ** 2) / 2)


@pytest.fixture(scope="module", params=[(0.5, 1.5), (3.0, 1.33 - 0.1j), (6.0, 1.7 - 0.01j)], ids=str)
def sphere(request):
    size, index = request.param
    return size, index, Oracle(size, index), spectra.mie_optics(WAVELENGTH, radius_of(size), index, angles=9)


def test_cross_sections_are_those_of_the_series(sphere):
    size, _, oracle, optics = sphere
    disk = np.pi * radius_of(size) ** 2
    # measured: 3e-12
    assert optics.extinction[0] / disk == pytest.approx(oracle.efficiency("extinction"), rel=1e-10)
    assert optics.scattering[0] / disk == pytest.approx(oracle.efficiency("scattering"), rel=1e-10)


def test_the_table_is_the_mean_over_each_hat(sphere):
    _, _, oracle, optics = sphere
    nodes, weights = np.polynomial.legendre.leggauss(24)
    cosines = np.linspace(-1, 1, 9)
    half = 0.125
    values, total = [], 0.0
    for middle in cosines:
        sums = np.zeros(2)
        for side in (-half, half):
            mu = middle + side * (1 + nodes)
            if np.all(np.abs(mu) <= 1):
                hat = weights * (1 - (1 + nodes) / 2)
                sums += hat @ [oracle.intensity(float(cosine)) for cosine in mu], hat.sum()
        values.append(sums[0] / sums[1])
        total += sums[0] * half
    # measured: 1.1e-11
    np.testing.assert_allclose(optics.tables[0], np.array(values) / (2 * np.pi * total), rtol=1e-10)


def test_light_balances(sphere):
    # the optical theorem: what leaves the forward beam is 4 pi / k^2 Re S(0), Bohren and Huffman 1983, Eq. 4.76
    size, index, _, optics = sphere
    s_1, _ = miepython.S1_S2(index, size, 1.0, norm="wiscombe")
    forward = 4 * np.real(s_1[0]) / size**2 * np.pi * radius_of(size) ** 2
    # measured: 3e-16
    assert optics.extinction[0] == pytest.approx(forward, rel=1e-12)
    absorbed = optics.extinction[0] - optics.scattering[0]
    assert absorbed == 0 if np.imag(index) == 0 else absorbed > 0


def test_a_published_sphere():
    # Bohren and Huffman 1983, appendix A, page 482: radius 0.525 um, index 1.55, 632.8 nm
    optics = spectra.mie_optics(632.8, 0.525, 1.55)
    assert optics.scattering[0] / (np.pi * 0.525**2) == pytest.approx(3.10543, abs=5e-6)
    assert optics.extinction[0] / (np.pi * 0.525**2) == pytest.approx(3.10543, abs=5e-6)
    assert optics.mean_cosine[0] == pytest.approx(0.63314, abs=5e-6)


def test_small_spheres_scatter_like_molecules():
    wavelengths, radius, index = np.array([400.0, 500.0, 800.0]), 0.001, 1.5 - 0.01j
    optics = spectra.mie_optics(wavelengths, radius, index, angles=101)
    k = 2 * np.pi / (wavelengths * 1e-3)
    polarisability = (index**2 - 1) / (index**2 + 2)
    # the first neglected term is of order x^2 = 2.5e-4; measured: 1.7e-5, 1.4e-4 and 1.1e-4
    np.testing.assert_allclose(
        optics.scattering, 8 * np.pi / 3 * k**4 * radius**6 * abs(polarisability) ** 2, rtol=1e-3
    )
    absorbed = optics.extinction - optics.scattering
    np.testing.assert_allclose(absorbed, -4 * np.pi * k * radius**3 * polarisability.imag, rtol=1e-3)
    # the mean of cos^2 over an inner hat is cos^2 + step^2 / 6
    cosine = np.linspace(-1, 1, 101)[1:-1]
    expected = 3 / (16 * np.pi) * (1 + cosine**2 + 0.02**2 / 6)
    np.testing.assert_allclose(optics.tables[:, 1:-1], np.tile(expected, (3, 1)), rtol=1e-3)


def test_large_spheres_take_away_twice_what_they_cover():
    size = 500.0
    optics = spectra.mie_optics(WAVELENGTH, radius_of(size), 1.33 - 0.1j, angles=3)
    # with the edge's term (Nussenzveig and Wiscombe 1980), 0.032; the next one is of order 1 / x; measured: -0.51 / x
    edge = 1.9924 * size ** (-2 / 3)
    assert optics.extinction[0] / (np.pi * radius_of(size) ** 2) == pytest.approx(2 + edge, abs=1 / size)


def test_the_imaginary_part_absorbs_whatever_its_sign():
    minus, plus = (spectra.mie_optics(WAVELENGTH, 0.5, 1.5 + sign * 0.05j) for sign in (-1, 1))
    np.testing.assert_array_equal(minus.extinction, plus.extinction)
    np.testing.assert_array_equal(minus.tables, plus.tables)
    assert minus.extinction[0] > minus.scattering[0]


def test_moments_of_the_intensity_agree_with_the_efficiencies():
    for size, index in ((0.5, 1.5), (30.0, 1.33), (150.0, 1.45 - 0.01j), (1000.0, 1.33 - 0.001j)):
        moments = intensity_moments([miepython.coefficients(index, size)], np.ones((1, 1)))
        _, scattering, _, mean_cosine = miepython.efficiencies_mx(index, size)
        # measured: 1.0e-11 and 3e-13; 5e-8 and 2e-9 by Gauss's nodes
        assert moments[0, 0] == pytest.approx(size**2 * scattering, rel=1e-10)
        assert moments[0, 1] / moments[0, 0] == pytest.approx(mean_cosine, abs=5e-12)


def test_moments_are_exact_to_the_highest_order():
    # coefficients that do not fall off; zeros after them bring nodes to spare
    a, b = np.array([0.5, 0.3 - 0.2j, 0.7j]), np.array([0.1j, 0.6, 0.4 + 0.3j])
    moments = intensity_moments([(a, b)], np.ones((1, 1)))
    spare = intensity_moments([(np.pad(a, (0, 9)), np.pad(b, (0, 9)))], np.ones((1, 1)))
    # measured: 5e-15
    np.testing.assert_allclose(spare[:, :7], moments, atol=1e-13)
    np.testing.assert_allclose(spare[:, 7:], 0, atol=1e-13)
    assert abs(moments[0, 6]) > 0.1


def test_moments_of_a_cloud_are_the_sum_over_its_spheres():
    # orders from 3 to 260, in seven octaves and more than one block of nodes
    sizes, number = [0.1, 1.0, 4.0, 9.0, 30.0, 31.0, 100.0, 230.0], np.array([[9e4, 9e3, 300, 40, 2, 3, 1, 0.5]])
    coefficients = [miepython.coefficients(1.4 - 0.01j, size) for size in sizes]
    together = intensity_moments(coefficients, number)
    alone = np.zeros_like(together)
    for pair, spheres in zip(coefficients, number[0], strict=True):
        found = intensity_moments([pair], np.array([[spheres]]))
        alone[:, : found.shape[1]] += found
    # measured: 9e-16
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-12 * alone[0, 0])


@pytest.mark.parametrize("angles", [2, 3, 200, 1001])
def test_tables_keep_the_integral_and_put_the_peak_last(angles):
    optics = spectra.mie_optics([450, 650], 3.0, 1.33, angles=angles)
    step = 2 / (angles - 1)
    integral = 2 * np.pi * step * (optics.tables.sum(axis=1) - (optics.tables[:, 0] + optics.tables[:, -1]) / 2)
    # measured: 3e-16
    np.testing.assert_allclose(integral, 1, rtol=1e-13)
    assert np.all(optics.tables[:, -1] > 2 * optics.tables[:, 0])
    assert np.all(optics.tables >= 0)
    # the peak is widened to the step: the last hat's middle is a third of it away from forward
    means = [phase("tabulated", values=tuple(values)).mean_cosine for values in optics.tables]
    assert np.all(np.abs(means - optics.mean_cosine) < step / 3)


def test_a_table_of_moments_is_the_function_where_it_is_linear():
    # p = (1 + mu / 2) / 2, whose means over hats are its values, but for the half hats at the ends
    found = table(np.array([[1.0, 1 / 6]]), 21)[0]
    cosine = np.linspace(-1, 1, 21)
    expected = (1 + cosine / 2) / (4 * np.pi)
    np.testing.assert_allclose(found[1:-1], expected[1:-1], rtol=1e-12)
    third = 0.1 / 3 / 2 / (4 * np.pi)
    np.testing.assert_allclose(found[[0, -1]], expected[[0, -1]] + [third, -third], rtol=1e-12)


def test_a_distribution_is_the_integral_over_radii():
    median, spread, index = 0.15, 1.5, 1.45 - 0.005j
    radii, step = np.linspace(1e-4, 2.5, 5000, retstep=True)
    number = np.exp(-((np.log(radii / median) / np.log(spread)) ** 2) / 2) / (
        radii * np.log(spread) * np.sqrt(2 * np.pi)
    )
    q_ext, q_sca, _, g = miepython.efficiencies_mx(index, 2 * np.pi * radii / (WAVELENGTH * 1e-3))
    weight = number * np.pi * radii**2 * step
    optics = spectra.mie_optics(WAVELENGTH, median, index, spread, angles=11)
    # measured: 8e-9
    assert optics.extinction[0] == pytest.approx(weight @ q_ext, rel=5e-8)
    assert optics.scattering[0] == pytest.approx(weight @ q_sca, rel=5e-8)
    assert optics.mean_cosine[0] == pytest.approx(weight @ (q_sca * g) / (weight @ q_sca), rel=5e-8)


@pytest.mark.parametrize(("median", "spread"), [(0.0002, 2.7), (0.0005, 2.0)])
def test_small_spheres_that_absorb_count_by_their_volume(median, spread):
    # they absorb like r^3 and scatter like r^6: what counts for one lies far from what counts for the other
    index, deviation = 1.5 - 0.5j, np.log(spread)
    log_radii, step = np.linspace(np.log(median) - 5, np.log(median) + 10 * deviation, 500, retstep=True)
    radii = np.exp(log_radii)
    weight = np.exp(-(((log_radii - np.log(median)) / deviation) ** 2) / 2) / (deviation * np.sqrt(2 * np.pi))
    q_ext, q_sca, _, _ = miepython.efficiencies_mx(index, 2 * np.pi * radii / (WAVELENGTH * 1e-3))
    expected = weight * np.pi * radii**2 * step @ (q_ext - q_sca)
    optics = spectra.mie_optics(WAVELENGTH, median, index, spread, angles=3)
    # measured: 1.2e-8; 3e-3 and 2e-4 where sizes were chosen by their scattering
    assert optics.extinction[0] - optics.scattering[0] == pytest.approx(expected, rel=1e-5)


def test_a_narrow_distribution_is_one_size():
    one, narrow = (spectra.mie_optics([450, 650], 0.3, 1.5 - 0.01j, spread, 101) for spread in (1.0, 1.001))
    # measured: 3e-6, and 1.5e-4 in the tables
    np.testing.assert_allclose(narrow.extinction, one.extinction, rtol=2e-5)
    np.testing.assert_allclose(narrow.tables, one.tables, rtol=1e-3)


def test_a_distribution_as_narrow_as_can_be_costs_no_more_than_its_sizes():
    # one grid from 450 to 650 nm in a quarter of this deviation would be 1.5e9 sizes
    one, narrow, narrowest = (
        spectra.mie_optics([450, 650], 0.3, 1.5 - 0.01j, spread, 11) for spread in (1.0, 1 + 1e-5, 1 + 1e-9)
    )
    # measured: 1.7e-8
    np.testing.assert_allclose(narrow.extinction, one.extinction, rtol=1e-7)
    np.testing.assert_array_equal(narrowest.extinction, one.extinction)


def test_one_index_for_all_wavelengths_or_one_for_each():
    wavelengths, index = [450, 550, 650], [1.34, 1.33, 1.34]
    together = spectra.mie_optics(wavelengths, 0.5, index, angles=21)
    for number, wavelength in enumerate(wavelengths):
        alone = spectra.mie_optics(wavelength, 0.5, index[number], angles=21)
        np.testing.assert_allclose(together.extinction[number], alone.extinction[0], rtol=1e-12)
        np.testing.assert_allclose(together.tables[number], alone.tables[0], rtol=1e-9)


def test_a_cloud_in_scene_units():
    cloud = spectra.mie_spheres(0.2, 1.5 - 0.02j, number_density=1000.0, metres_per_unit=1000.0, angles=21)
    optics = spectra.mie_optics(WAVELENGTHS, 0.2, 1.5 - 0.02j, angles=21)
    # 1000 / cm^3 of 1 um^2 each are 1e9 / m^3 x 1e-12 m^2 = 1e-3 / m, 1 / km
    np.testing.assert_allclose(cloud.sigma_t, optics.extinction, rtol=1e-12)
    np.testing.assert_allclose(cloud.sigma_s, optics.scattering, rtol=1e-12)
    assert len(cloud.phases) == WAVELENGTHS.size
    np.testing.assert_allclose(cloud.phases[7].values, optics.tables[7], rtol=1e-9)


@pytest.mark.parametrize("size", [1e-20, 1e-8])
def test_spheres_near_the_least_size_have_their_limit(size):
    index, k = 1.5 - 0.01j, 2 * np.pi / (WAVELENGTH * 1e-3)
    optics = spectra.mie_optics(WAVELENGTH, size / k, index, angles=5)
    polarisability = (index**2 - 1) / (index**2 + 2)
    # measured: 7e-16
    expected = 8 * np.pi / 3 * k**-2 * size**6 * abs(polarisability) ** 2
    assert optics.scattering[0] == pytest.approx(expected, rel=1e-13, abs=0)


def test_an_index_close_to_that_of_air_keeps_its_digits():
    optics = spectra.mie_optics(WAVELENGTH, radius_of(3.0), 1 + 1.1e-6)
    expected = Oracle(3.0, 1 + 1.1e-6).efficiency("scattering") * np.pi * radius_of(3.0) ** 2
    # measured: 1.4e-10
    assert optics.scattering[0] == pytest.approx(expected, rel=1e-8, abs=0)


@pytest.mark.parametrize("imaginary", [0.0, -1e-18, -1e-16])
def test_rounding_never_makes_extinction_the_smaller(imaginary):
    optics = spectra.mie_optics(WAVELENGTHS, 0.5, complex(1.33, imaginary), angles=3)
    absorbed = optics.extinction - optics.scattering
    assert np.all(absorbed >= 0)
    # measured: 3e-15
    assert np.all(absorbed <= 1e-13 * optics.extinction)
    assert imaginary or np.all(absorbed == 0)
