//! The resources of the package: its icon, and the settings that a management console may set.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use paros_shell::settings::{RestrictionFiles, write_restrictions};

use crate::error::PackageError;
use crate::icon;
use crate::tools::{self, Scratch};

/// The resources before they are compiled.
#[derive(Debug)]
pub(crate) struct Resources {
    restrictions: RestrictionFiles,
    icon: Vec<u8>,
}

impl Resources {
    /// Creates the resources of a package with these figures of the operator's own.
    ///
    /// # Errors
    /// The icon can't be written as PNG.
    pub(crate) fn of_package(own_figures: &[String]) -> Result<Self, PackageError> {
        Ok(Resources { restrictions: write_restrictions(own_figures), icon: icon::draw_png()? })
    }

    /// Compiles the resources into a file for `aapt2 link`.
    ///
    /// # Errors
    /// A file can't be written, or `aapt2` fails.
    pub(crate) fn compile(&self, scratch: &Scratch) -> Result<PathBuf, PackageError> {
        let (folder, compiled) = (scratch.at("res"), scratch.at("res.zip"));
        let write = |name: &str, bytes: &[u8]| {
            let path = folder.join(name);
            let parent = path.parent().unwrap_or(Path::new("."));
            fs::create_dir_all(parent).and_then(|()| fs::write(&path, bytes))
        };
        let RestrictionFiles { restrictions, values } = &self.restrictions;
        write("xml/app_restrictions.xml", restrictions.as_bytes())
            .and_then(|()| write("values/settings.xml", values.as_bytes()))
            .and_then(|()| write("mipmap-xxxhdpi/icon.png", &self.icon))
            .map_err(PackageError::failure)?;
        let mut compile = Command::new("aapt2");
        compile.args(["compile", "--dir"]).arg(&folder).arg("-o").arg(&compiled);
        tools::run_tool("resources", &mut compile)?;
        Ok(compiled)
    }
}
