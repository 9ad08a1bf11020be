//! Charts without overlap in the unit square.

use crate::error::Result;
#[cfg(doc)]
use crate::error::Status;
use crate::foliation::Foliation;
use crate::owned::{arrays, make, Owned};
use crate::ranges::Refusal;
use crate::records::options;
use foliations_sys as sys;

/// Charts without overlap in the unit square, for painting and baking.
///
/// Every triangle belongs to one chart. Charts are conformal as (u, v) of
/// [`Foliation::parameterizer`] is, with areas in proportion to those in space.
#[derive(Debug)]
pub struct Atlas {
    block: Owned<sys::hmf_chart_set>,
}

arrays! {
    Atlas {
        /// Place of each corner of each triangle.
        corner_uv: [[[f64; 2]; 3]; triangle_count],
        /// The chart of each triangle.
        triangle_chart: [u32; triangle_count],
    }
}

impl Atlas {
    /// Number of charts.
    pub fn chart_count(&self) -> u64 {
        self.block.chart_count
    }

    /// Part of the square that the triangles cover.
    pub fn used_area(&self) -> f64 {
        self.block.used_area
    }

    /// In the unit of the positions, each side between two triangles once.
    pub fn seam_length(&self) -> f64 {
        self.block.seam_length
    }

    /// Edges whose two triangles do not meet in the square.
    pub fn seam_edge_count(&self) -> u64 {
        self.block.seam_edge_count
    }

    /// Triangles whose image has no positive area, where the foliation is nearly 0.
    pub fn collapsed_count(&self) -> u64 {
        self.block.collapsed_count
    }

    /// Standard deviation over the surface of the logarithm of the scale.
    pub fn unevenness(&self) -> f64 {
        self.block.unevenness
    }

    /// Triangles that the check of overlaps leaves out: those without area in the square, and
    /// those less than a millionth of it across.
    pub fn speck_count(&self) -> u64 {
        self.block.speck_count
    }

    /// Edges of charts that the check compared.
    pub fn compared_count(&self) -> u64 {
        self.block.compared_count
    }
}

impl Foliation {
    /// Charts without overlap in the unit square; few and even ones come from
    /// [`even_design`](crate::Builder::even_design).
    ///
    /// `margin` is the least distance of two charts, as a part of the side of the square;
    /// with `None` 1/512.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_UNSUPPORTED`] with boundary, or if the margin is too large for so many
    /// charts; [`Status::ERROR_OPTIONS`] for a margin outside of 0 to 1/16;
    /// [`Status::ERROR_VALUE_NOT_HARMONIC`]; [`Status::CANCELLED`]; classes 100, 200, 500.
    pub fn atlas(&self, margin: Option<f64>) -> Result<Atlas> {
        let mut refusal = Refusal::default();
        margin.iter().for_each(|&margin| refusal.check("margin", margin, "(0, 0.0625]"));
        refusal.result()?;
        let options = options!(hmf_atlas_options margin: margin.unwrap_or(0.0));
        // SAFETY: the handle is valid.
        let block =
            make(|out, control, error| unsafe { sys::hmf_atlas(self.as_ptr(), &options, control, out, error) })?;
        Ok(Atlas { block })
    }
}
