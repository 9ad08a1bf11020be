"""Harmonic 1-forms: shapes, and what holds whatever the mesh."""

from __future__ import annotations

import foliations
import numpy as np
import pytest


def test_basis_conjugation_and_periods(hierarchy: foliations.Hierarchy) -> None:
    forms = hierarchy.harmonic_forms()
    genus, level = hierarchy.genus, hierarchy.levels[0]
    assert forms.genus == genus and len(forms) == 2 * genus
    assert forms.values.shape == (2 * genus, level.edge_count)
    canonical = np.kron([[0, 1], [-1, 0]], np.eye(genus))
    assert np.array_equal(forms.intersections, canonical)
    # The integral of form i ^ *form j is an inner product.
    assert np.allclose(canonical @ forms.conjugation, forms.inner_products)
    error = np.abs(forms.conjugation @ forms.conjugation + np.eye(2 * genus)).max()
    assert error == pytest.approx(forms.conjugation_error) and error < 0.3
    assert np.allclose(forms.period_matrix, forms.period_matrix.T)
    assert np.linalg.eigvalsh(forms.period_matrix.imag).min() > 0
    assert forms.residual < 1e-8
    assert repr(forms) == f"<{2 * genus} harmonic forms on {level.edge_count} edges>"


def test_closed_in_every_triangle(hierarchy: foliations.Hierarchy) -> None:
    level = hierarchy.levels[1]
    forms = hierarchy.harmonic_forms(1)
    triangles, edges = level.triangles, level.triangle_edges
    along = np.where(level.edges[edges, 0] == triangles, 1, -1)
    assert np.array_equal((forms.values[:, edges] * along).sum(axis=2), np.zeros((len(forms), len(triangles))))


def test_errors(hierarchy: foliations.Hierarchy) -> None:
    with pytest.raises(foliations.LevelError):
        hierarchy.harmonic_forms(99)
    positions, triangles = hierarchy.levels[0].positions, hierarchy.levels[0].triangles
    with pytest.warns(foliations.MeshWarning):
        opened = foliations.Hierarchy(positions, triangles[1:])
    with pytest.raises(foliations.MeshError, match="boundary"):
        opened.harmonic_forms()
