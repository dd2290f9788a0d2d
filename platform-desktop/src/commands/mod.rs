//! The command line: one module a subcommand, each turning its arguments into a report.

mod bake;
mod bench;
mod demo;
mod drawing;
mod export;
mod info;
mod play;
mod progress;
mod render;
mod volume;
mod window;

use clap::{Parser, Subcommand};

use crate::error::Error;

/// Sculpts in a block of voxels: bakes meshes, shows and exports sculptures.
#[derive(Debug, Parser)]
#[command(name = "paros", version)]
pub struct Cli {
    /// Without a command: the window, or the demo where there can be none.
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Args),
    Bake(bake::Args),
    Bench(bench::Args),
    Info(info::Args),
    Play(play::Args),
    Export(export::Args),
    Render(render::Args),
    Window(window::Args),
}

impl Cli {
    /// Runs the command; what it has to say comes back as whole lines.
    ///
    /// # Errors
    /// What went wrong and whose fault it is. No file is written then.
    pub fn run(&self) -> Result<String, Error> {
        match &self.command {
            None => window::run_or_demo(),
            Some(Command::Demo(args)) => demo::run(args),
            Some(Command::Bake(args)) => bake::run(args),
            Some(Command::Bench(args)) => bench::run(args),
            Some(Command::Info(args)) => info::run(args),
            Some(Command::Play(args)) => play::run(args),
            Some(Command::Export(args)) => export::run(args),
            Some(Command::Render(args)) => render::run(args),
            Some(Command::Window(args)) => window::run(args),
        }
    }
}
