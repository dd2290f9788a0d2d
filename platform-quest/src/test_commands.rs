//! Commands from standard input, one a line, for tests: `say` prints the status; `shot PREFIX` writes the
//! next frame's pictures to `PREFIX-left.png` and `PREFIX-right.png`, or the notice to `PREFIX-notice.png`;
//! `quit` requests the end of the session.

use std::io::{self, BufRead};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::thread;

use paros_shaders::Image;
use paros_shell::durable;

use crate::error::Error;

/// A command of a test.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum TestCommand {
    /// Print the status.
    PrintStatus,
    /// Write pictures of the next frame to files with this path prefix.
    CaptureFrame(PathBuf),
    /// End the session.
    Quit,
}

/// The queue of commands that a thread reads from standard input.
pub(crate) struct CommandQueue(Receiver<TestCommand>);

impl CommandQueue {
    /// Starts the thread. Lines that aren't commands are ignored.
    pub(crate) fn spawn_reader() -> Self {
        let (sender, commands) = channel();
        thread::spawn(move || {
            for line in io::stdin().lock().lines().map_while(Result::ok) {
                if let Some(command) = parse_command(&line)
                    && sender.send(command).is_err()
                {
                    break;
                }
            }
        });
        CommandQueue(commands)
    }

    /// Returns the next command, if one has arrived.
    pub(crate) fn poll_next(&self) -> Option<TestCommand> {
        self.0.try_recv().ok()
    }
}

/// Writes a picture to `PREFIX-NAME.png`. `pixels` has red, green and blue of each pixel.
///
/// # Errors
/// [`Error::Input`] if the number of pixels doesn't match the extent, or a file that can't be written.
pub(crate) fn write_picture(
    prefix: &Path,
    name: &str,
    extent: [u32; 2],
    pixels: &[u8],
) -> Result<(), Error> {
    let [width, height] = extent.map(|pixels| pixels as usize);
    let image = Image { width, height, pixels: pixels.to_vec() };
    let mut png = Vec::new();
    image.write_png(&mut png).map_err(|error| Error::Input(error.to_string()))?;
    let mut path = prefix.as_os_str().to_owned();
    path.push(format!("-{name}.png"));
    Ok(durable::write_file(Path::new(&path), &png)?)
}

fn parse_command(line: &str) -> Option<TestCommand> {
    match line.split_once(' ').unwrap_or((line, "")) {
        ("say", "") => Some(TestCommand::PrintStatus),
        ("shot", prefix) if !prefix.is_empty() => Some(TestCommand::CaptureFrame(prefix.into())),
        ("quit", "") => Some(TestCommand::Quit),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{TestCommand, parse_command};

    #[test]
    fn lines_are_commands() {
        assert_eq!(parse_command("say"), Some(TestCommand::PrintStatus));
        let capture = TestCommand::CaptureFrame("/tmp/a b".into());
        assert_eq!(parse_command("shot /tmp/a b"), Some(capture));
        assert_eq!(parse_command("quit"), Some(TestCommand::Quit));
        assert_eq!(parse_command("shot"), None);
        assert_eq!(parse_command("dance"), None);
    }
}
