//! T-splines in files of the first schema, which hold the form by half-edge and the whole mesh.

use msplines_t_spline::SurfaceParts;
use serde::Deserialize;

use super::{StoredForm, StoredLayout, StoredTSpline};
use crate::spline_file::{FaceRun, StoredDomain, StoredMesh, StoredSpline};

/// A file of the first schema.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::spline_file) struct FirstTSpline {
    #[serde(rename = "schema")]
    _schema: String,
    #[serde(rename = "method")]
    _method: String,
    domain: StoredDomain,
    options: serde_json::Value,
    data: Data,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    /// The mesh on the cylinders, where it is another one than the domain.
    mesh: Option<StoredMesh>,
    surface: SurfaceParts,
}

impl FirstTSpline {
    /// Returns the domain, the options and the spline.
    pub(in crate::spline_file) fn upgraded(
        self,
    ) -> (StoredDomain, serde_json::Value, StoredSpline) {
        let (mesh, mut parts) = (self.data.mesh, self.data.surface);
        let layout = match mesh {
            Some(mesh) => StoredLayout::whole(mesh, &parts.origins),
            None => StoredLayout {
                faces: vec![FaceRun::Input(0, (parts.form.len() / 3) as u32)],
                ..StoredLayout::whole(StoredMesh::default(), &parts.origins)
            },
        };
        let form = StoredForm::HalfEdges(std::mem::take(&mut parts.form));
        let spline = StoredTSpline::with_layout(layout, form, parts);
        let spline = StoredSpline::TSpline(Box::new(spline));
        (self.domain, self.options, spline)
    }
}
