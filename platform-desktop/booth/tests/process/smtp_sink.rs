//! A mail server that keeps what it is sent: enough of SMTP (RFC 5321) for one mail after the other.

use std::io::{self, BufRead as _, BufReader, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// A mail as it came.
#[derive(Clone, Debug)]
pub(crate) struct Mail {
    pub(crate) from: String,
    pub(crate) to: Vec<String>,
    /// Head and body, with `\n` between lines.
    pub(crate) text: String,
}

/// A server on a port of its own. An address that begins with `later` gets 451, one with `nobody` 550.
pub(crate) struct SmtpSink {
    pub(crate) address: SocketAddr,
    mails: Arc<Mutex<Vec<Mail>>>,
    refused: Arc<Mutex<Vec<String>>>,
}

impl SmtpSink {
    pub(crate) fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let sink = SmtpSink {
            address: listener.local_addr().expect("a port"),
            mails: Arc::default(),
            refused: Arc::default(),
        };
        let (mails, refused) = (sink.mails.clone(), sink.refused.clone());
        // It ends with the tests.
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (mails, refused) = (mails.clone(), refused.clone());
                // Who hangs up has nothing more to say.
                thread::spawn(move || serve(&stream, &mails, &refused));
            }
        });
        sink
    }

    /// All mails that came, once there are so many.
    pub(crate) fn wait_for(&self, count: usize) -> Vec<Mail> {
        wait_until(|| Some(self.mails()).filter(|mails| mails.len() >= count))
    }

    pub(crate) fn mails(&self) -> Vec<Mail> {
        self.mails.lock().unwrap().clone()
    }

    /// Addresses that were refused.
    pub(crate) fn refused(&self) -> Vec<String> {
        self.refused.lock().unwrap().clone()
    }
}

/// Looks until there is something.
pub(crate) fn wait_until<T>(mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < Duration::from_secs(120), "it doesn't come");
        thread::sleep(Duration::from_millis(50));
    }
}

fn serve(
    stream: &TcpStream,
    mails: &Mutex<Vec<Mail>>,
    refused: &Mutex<Vec<String>>,
) -> io::Result<()> {
    let mut lines = BufReader::new(stream).lines();
    let say = |line: &str| write!(&mut &*stream, "{line}\r\n");
    let mut mail = Mail { from: String::new(), to: Vec::new(), text: String::new() };
    say("220 sink")?;
    while let Some(line) = lines.next().transpose()? {
        let (word, rest) = line.split_at(line.len().min(4));
        match word.to_ascii_uppercase().as_str() {
            "EHLO" => say("250-sink\r\n250 8BITMIME")?,
            "MAIL" => {
                mail.from = rest.to_owned();
                say("250 yes")?;
            }
            "RCPT" if rest.contains("<later") || rest.contains("<nobody") => {
                refused.lock().unwrap().push(rest.to_owned());
                let code = if rest.contains("<later") { 451 } else { 550 };
                // As servers do, it says whom it means.
                say(&format!("{code} no{rest}"))?;
            }
            "RCPT" => {
                mail.to.push(rest.to_owned());
                say("250 yes")?;
            }
            "DATA" => {
                say("354 go on")?;
                for line in lines.by_ref() {
                    let line = line?;
                    if line == "." {
                        break;
                    }
                    mail.text.push_str(line.strip_prefix('.').unwrap_or(&line));
                    mail.text.push('\n');
                }
                mails.lock().unwrap().push(mail.clone());
                mail = Mail { from: String::new(), to: Vec::new(), text: String::new() };
                say("250 taken")?;
            }
            "QUIT" => return say("221 bye"),
            _ => say("250 yes")?,
        }
    }
    Ok(())
}
