//! Harmonic 1-forms of a closed surface.

use crate::error::Result;
#[cfg(doc)]
use crate::error::Status;
use crate::hierarchy::Hierarchy;
use crate::owned::{make, slice, Owned};
use foliations_sys as sys;

/// A basis of the harmonic 1-forms of a closed surface: 2 genus forms a\[0\], a\[1\], ...,
/// then b\[0\], b\[1\], ...
///
/// Matrices are stored by rows: entry (i, j) of an n x n matrix is at n * i + j.
#[derive(Debug)]
pub struct HarmonicForms {
    block: Owned<sys::hmf_form_set>,
}

impl HarmonicForms {
    /// Number of forms, 2 genus.
    pub fn form_count(&self) -> u64 {
        self.block.form_count
    }

    /// The integral of form `i` along each edge, from its first vertex to its second; empty if
    /// there is no such form.
    pub fn form(&self, i: u64) -> &[f64] {
        if i >= self.block.form_count {
            return &[];
        }
        // SAFETY: the header gives so many entries, in the block that `self` owns.
        let all = unsafe { slice(self.block.values, self.block.form_count * self.block.edge_count) };
        let edges = self.block.edge_count as usize;
        &all[i as usize * edges..(i as usize + 1) * edges]
    }

    /// form_count x form_count: the integral of form i ^ form j over the surface, 1 for a\[k\],
    /// b\[k\], -1 for b\[k\], a\[k\], else 0.
    pub fn intersections(&self) -> &[i32] {
        // SAFETY: the header gives so many entries, in the block that `self` owns.
        unsafe { slice(self.block.intersections, self.block.form_count * self.block.form_count) }
    }

    /// form_count x form_count: inner products, symmetric and positive definite.
    pub fn inner_products(&self) -> &[f64] {
        // SAFETY: as above.
        unsafe { slice(self.block.inner_products, self.block.form_count * self.block.form_count) }
    }

    /// form_count x form_count: the conjugate of form j is the sum over i of entry (i, j) times
    /// form i, up to discretization.
    pub fn conjugation(&self) -> &[f64] {
        // SAFETY: as above.
        unsafe { slice(self.block.conjugation, self.block.form_count * self.block.form_count) }
    }

    /// genus x genus: real part of the period matrix, symmetric.
    pub fn period_real(&self) -> &[f64] {
        // SAFETY: as above.
        unsafe { slice(self.block.period_real, self.block.genus * self.block.genus) }
    }

    /// genus x genus: imaginary part of the period matrix, symmetric and positive definite.
    pub fn period_imaginary(&self) -> &[f64] {
        // SAFETY: as above.
        unsafe { slice(self.block.period_imaginary, self.block.genus * self.block.genus) }
    }

    /// Largest divergence at the vertices, relative to the fluxes; at most 1e-8.
    pub fn residual(&self) -> f64 {
        self.block.residual
    }

    /// Largest absolute entry of the square of the conjugation plus the identity.
    pub fn conjugation_error(&self) -> f64 {
        self.block.conjugation_error
    }
}

impl Hierarchy {
    /// A basis of the harmonic 1-forms of a closed surface, on a level.
    ///
    /// In each triangle the three numbers of a form add up to exactly 0, along a closed path of
    /// edges they add up to an integer, and among all such forms with the same integers each has
    /// the least energy.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_MESH_BOUNDARY`]; [`Status::ERROR_UNSUPPORTED`] if the linear systems could not
    /// be solved accurately enough; [`Status::ERROR_LEVEL`]; [`Status::CANCELLED`]; classes 100, 200.
    pub fn harmonic_forms(&self, level: usize) -> Result<HarmonicForms> {
        // SAFETY: the handle is valid.
        let block =
            make(|out, control, error| unsafe { sys::hmf_harmonic_forms(self.as_ptr(), level, control, out, error) })?;
        Ok(HarmonicForms { block })
    }
}
