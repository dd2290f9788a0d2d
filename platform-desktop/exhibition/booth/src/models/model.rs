//! The formats in which a sculpture goes out.

use axum::http::{HeaderName, header};
use paros_booth_rules::records::Sculpture;
use paros_booth_rules::{Booth, Refusal};

use crate::models::exporter::make_stl;
use crate::models::glb::write_glb;
use crate::models::threemf::write_3mf;

/// A format of models.
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
    /// All of them.
    pub(crate) const ALL: [ModelFormat; 3] = [ModelFormat::Stl, ModelFormat::Mf, ModelFormat::Glb];

    /// For people.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            ModelFormat::Stl => "STL",
            ModelFormat::Mf => "3MF",
            ModelFormat::Glb => "GLB",
        }
    }

    /// How a file's name ends.
    pub(crate) const fn ending(self) -> &'static str {
        match self {
            ModelFormat::Stl => "stl",
            ModelFormat::Mf => "3mf",
            ModelFormat::Glb => "glb",
        }
    }

    /// The heads of an answer that has it, as a file of this name.
    pub(crate) fn headers(self, name: &str) -> [(HeaderName, String); 2] {
        let kind = match self {
            ModelFormat::Stl => "model/stl",
            ModelFormat::Mf => "model/3mf",
            ModelFormat::Glb => "model/gltf-binary",
        };
        let file = format!("attachment; filename=\"{name}.{}\"", self.ending());
        [(header::CONTENT_TYPE, kind.to_owned()), (header::CONTENT_DISPOSITION, file)]
    }

    /// The model of a kept sculpture.
    ///
    /// # Errors
    /// What the disk says, or why it has none.
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
