//! The command line: one module a subcommand, each turning its arguments into a report.

mod bake;
mod bench;
mod booth;
mod demo;
mod drawing;
#[cfg(feature = "booth")]
mod enrol;
#[cfg(feature = "booth")]
mod exhibit;
mod export;
mod info;
#[cfg(not(feature = "booth"))]
mod needs_https;
mod play;
mod render;
mod settings;
mod sound;
mod volume;
mod window;

use std::path::PathBuf;

#[cfg(not(feature = "booth"))]
pub(crate) use booth::BUILD_COMMAND;

use clap::{Parser, Subcommand};
#[cfg(not(feature = "booth"))]
use needs_https::{self as enrol, self as exhibit};
use paros_headless::Error;

/// Sculpt in a block of voxels: convert meshes, and render and export sculptures.
#[derive(Debug, Parser)]
#[command(name = "paros", version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// Command to run. Without a command, the window opens, or the demo runs if no window can be opened.
    #[command(subcommand)]
    command: Option<CliCommand>,
    /// Mesh or volume to open in the window, as with `window FILE`.
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum CliCommand {
    Demo(demo::Args),
    Bake(bake::Args),
    Bench(bench::Args),
    Booth(booth::Args),
    /// Enrol this machine at a booth, which then receives finished sculptures.
    Enrol(enrol::Args),
    /// Start an exhibition on this machine: a booth, and a window with visits that sends sculptures to the
    /// booth.
    Exhibit(exhibit::Args),
    Info(info::Args),
    Play(play::Args),
    Export(export::Args),
    Render(render::Args),
    Sound(sound::Args),
    #[command(subcommand)]
    Settings(settings::Action),
    Window(window::Args),
}

impl Cli {
    /// Runs the command. Returns its output as whole lines.
    ///
    /// # Errors
    /// Returns the reason, and if input or program is at fault. No file is written then.
    pub fn run(&self) -> Result<String, Error> {
        match &self.command {
            None => match &self.file {
                None => window::run_window_or_demo(),
                Some(file) => window::run(&window::Args::for_file(file)?),
            },
            Some(CliCommand::Demo(args)) => demo::run(args),
            Some(CliCommand::Bake(args)) => bake::run(args),
            Some(CliCommand::Bench(args)) => bench::run(args),
            Some(CliCommand::Booth(args)) => booth::run(args),
            Some(CliCommand::Enrol(args)) => enrol::run(args),
            Some(CliCommand::Exhibit(args)) => exhibit::run(args),
            Some(CliCommand::Info(args)) => info::run(args),
            Some(CliCommand::Play(args)) => play::run(args),
            Some(CliCommand::Export(args)) => export::run(args),
            Some(CliCommand::Render(args)) => render::run(args),
            Some(CliCommand::Sound(args)) => sound::run(args),
            Some(CliCommand::Settings(action)) => settings::run(action),
            Some(CliCommand::Window(args)) => window::run(args),
        }
    }
}
