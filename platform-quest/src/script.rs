//! Commands from standard input, one a line, for tests: `say` prints what there is to know, `shot
//! PREFIX` writes both eyes' pictures to `PREFIX-left.png` and `PREFIX-right.png`, `quit` asks the
//! runtime to end the session.

use std::io::{self, BufRead};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::thread;

/// What a test asks for.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Command {
    /// Print what there is to know.
    Say,
    /// Write pictures of the next frame.
    Shot(PathBuf),
    /// Have the session end.
    Quit,
}

/// Lines that are waited for beside the frames.
pub(crate) struct Script(Receiver<Command>);

impl Script {
    /// Begins to read. What is no command is passed over.
    pub(crate) fn new() -> Self {
        let (tell, commands) = channel();
        thread::spawn(move || {
            for line in io::stdin().lock().lines().map_while(Result::ok) {
                if let Some(command) = command(&line)
                    && tell.send(command).is_err()
                {
                    break;
                }
            }
        });
        Script(commands)
    }

    /// The next command, if there is one.
    pub(crate) fn next(&self) -> Option<Command> {
        self.0.try_recv().ok()
    }
}

fn command(line: &str) -> Option<Command> {
    match line.split_once(' ').unwrap_or((line, "")) {
        ("say", "") => Some(Command::Say),
        ("shot", prefix) if !prefix.is_empty() => Some(Command::Shot(prefix.into())),
        ("quit", "") => Some(Command::Quit),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{Command, command};

    #[test]
    fn lines_are_commands() {
        assert_eq!(command("say"), Some(Command::Say));
        assert_eq!(command("shot /tmp/a b"), Some(Command::Shot("/tmp/a b".into())));
        assert_eq!(command("quit"), Some(Command::Quit));
        assert_eq!(command("shot"), None);
        assert_eq!(command("dance"), None);
    }
}
