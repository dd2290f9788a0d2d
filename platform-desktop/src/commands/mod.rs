//! The command line: one module a subcommand, each turning its arguments into a report.

mod bake;
mod demo;
mod export;
mod info;
mod progress;
mod render;
mod volume;

use clap::{Parser, Subcommand};

use crate::error::Error;

/// Sculpts in a block of voxels: bakes meshes, shows and exports sculptures.
#[derive(Debug, Parser)]
#[command(name = "paros", version, arg_required_else_help = true)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Args),
    Bake(bake::Args),
    Info(info::Args),
    Export(export::Args),
    Render(render::Args),
}

impl Cli {
    /// Runs the command; what it has to say comes back as whole lines.
    ///
    /// # Errors
    /// What went wrong and whose fault it is. No file is written then.
    pub fn run(&self) -> Result<String, Error> {
        match &self.command {
            Command::Demo(args) => demo::run(args),
            Command::Bake(args) => bake::run(args),
            Command::Info(args) => info::run(args),
            Command::Export(args) => export::run(args),
            Command::Render(args) => render::run(args),
        }
    }
}
