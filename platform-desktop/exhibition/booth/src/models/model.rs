//! The file formats in which a sculpture can be downloaded.

use axum::http::{HeaderName, header};
use paros_booth_rules::records::Sculpture;
use paros_booth_rules::{Booth, Refusal};

use crate::models::exporter::make_stl;
use crate::models::glb::write_glb;
use crate::models::threemf::write_3mf;

/// A file format of models.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ModelFormat {
    /// Binary STL, as the headset makes it.
    Stl,
    /// 3MF.
    Mf,
    /// GLB.
    Glb,
}

impl ModelFormat {
    /// All formats.
    pub(crate) const ALL: [ModelFormat; 3] = [ModelFormat::Stl, ModelFormat::Mf, ModelFormat::Glb];

    /// Returns the format's name as people know it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            ModelFormat::Stl => "STL",
            ModelFormat::Mf => "3MF",
            ModelFormat::Glb => "GLB",
        }
    }

    /// Returns the file name extension.
    pub(crate) const fn ending(self) -> &'static str {
        match self {
            ModelFormat::Stl => "stl",
            ModelFormat::Mf => "3mf",
            ModelFormat::Glb => "glb",
        }
    }

    /// Returns the headers of a response with a model, as a download with this file name.
    pub(crate) fn headers(self, name: &str) -> [(HeaderName, String); 2] {
        let kind = match self {
            ModelFormat::Stl => "model/stl",
            ModelFormat::Mf => "model/3mf",
            ModelFormat::Glb => "model/gltf-binary",
        };
        let file = format!("attachment; filename=\"{name}.{}\"", self.ending());
        [(header::CONTENT_TYPE, kind.to_owned()), (header::CONTENT_DISPOSITION, file)]
    }

    /// Makes the model of a kept sculpture in this format.
    ///
    /// # Errors
    /// The error of the disk, or why no model can be made.
    pub(crate) fn make(self, booth: &Booth, sculpture: &Sculpture) -> Result<Vec<u8>, Refusal> {
        let stl = make_stl(&booth.read_kept(sculpture)?);
        let model = stl.and_then(|stl| match self {
            ModelFormat::Stl => Ok(stl),
            ModelFormat::Mf => write_3mf(&stl),
            ModelFormat::Glb => write_glb(&stl),
        });
        model.map_err(Refusal::Undecodable)
    }
}
