"""The Denavit-Hartenberg matrices."""

from __future__ import annotations

import numpy as np
from kinematics.reference import rot, trans

from robokin.spatial.dh import modified_dh, standard_dh


def test_the_standard_step_is_its_four_motions(rng):
    for theta, d, a, alpha in rng.uniform(-3, 3, (20, 4)):
        expected = rot([0, 0, 1], theta) @ trans(0, 0, d) @ trans(a, 0, 0) @ rot([1, 0, 0], alpha)
        assert np.allclose(standard_dh(theta, d, a, alpha), expected, atol=1e-15)


def test_the_modified_step_is_its_four_motions(rng):
    for theta, d, a, alpha in rng.uniform(-3, 3, (20, 4)):
        expected = rot([1, 0, 0], alpha) @ trans(a, 0, 0) @ rot([0, 0, 1], theta) @ trans(0, 0, d)
        assert np.allclose(modified_dh(alpha, a, theta, d), expected, atol=1e-15)


def test_the_standard_matrix_is_the_printed_one(rng):
    # M. Yim, Robotics: Fundamentals, week 5; B. Siciliano et al. eq. (2.52). C. Laschi's slide prints elements
    # (2, 4) and (3, 4) with a minus, which the product of its own four motions does not give.
    theta, d, a, alpha = rng.uniform(-3, 3, 4)
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    printed = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    assert np.allclose(standard_dh(theta, d, a, alpha), printed, atol=1e-15)


def test_steps_come_in_batches(rng):
    theta, d, a, alpha = rng.uniform(-3, 3, (4, 2, 3))
    batch = standard_dh(theta, d, a, alpha)
    assert batch.shape == (2, 3, 4, 4)
    assert np.array_equal(batch[1, 2], standard_dh(theta[1, 2], d[1, 2], a[1, 2], alpha[1, 2]))
