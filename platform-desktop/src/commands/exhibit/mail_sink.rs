//! A mail server that forwards nothing: each mail becomes a file. Implements enough of SMTP (RFC 5321) for
//! this machine's booth.

use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use paros_headless::Error;
use paros_shell::durable;

/// Maximum size of a mail in bytes, with its attachments encoded as text.
const MAX_MAIL_BYTES: u64 = 64 << 20;

/// Timeout for data from a client.
const PATIENCE: Duration = Duration::from_secs(60);

/// A mail server. It stops when the program ends.
pub(super) struct MailSink {
    address: SocketAddr,
}

impl MailSink {
    /// Listens on a free port of the loopback address. Mails are written to `folder` as 001.eml and so on.
    ///
    /// # Errors
    /// No port is free, or the folder can't be created.
    pub(super) fn start(folder: &Path) -> Result<Self, Error> {
        durable::make_folder(folder)?;
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).map_err(Error::failure)?;
        let address = listener.local_addr().map_err(Error::failure)?;
        let folder = folder.to_owned();
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                // A client that hangs up early has sent no mail.
                let _ = take_mails(&stream, &folder);
            }
        });
        Ok(MailSink { address })
    }

    pub(super) const fn address(&self) -> SocketAddr {
        self.address
    }
}

fn take_mails(stream: &TcpStream, folder: &Path) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut reader = BufReader::new(stream).take(MAX_MAIL_BYTES);
    let say = |line: &str| write!(&mut &*stream, "{line}\r\n");
    say("220 exhibition.example")?;
    loop {
        reader.set_limit(MAX_MAIL_BYTES);
        let mut line = String::new();
        if reader.read_line(&mut line)? == 0 {
            return Ok(());
        }
        let verb = line.get(..4).unwrap_or_default().to_ascii_uppercase();
        match &verb[..] {
            "EHLO" | "HELO" | "MAIL" | "RCPT" | "RSET" | "NOOP" => say("250 OK")?,
            "DATA" => {
                say("354 go on")?;
                let mail = read_mail(&mut reader)?;
                match keep_mail(folder, &mail) {
                    Ok(()) => say("250 kept")?,
                    Err(_) => say("451 the disk takes no more")?,
                }
            }
            "QUIT" => return say("221 bye"),
            _ => say("502 not here")?,
        }
    }
}

/// Reads a mail up to the line with a single dot, and removes SMTP's dot stuffing.
fn read_mail(reader: &mut impl io::BufRead) -> io::Result<Vec<u8>> {
    let mut mail = Vec::new();
    loop {
        let mut line = Vec::new();
        if reader.read_until(b'\n', &mut line)? == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        if line == b".\r\n" {
            return Ok(mail);
        }
        mail.extend_from_slice(line.strip_prefix(b".").unwrap_or(&line));
    }
}

fn keep_mail(folder: &Path, mail: &[u8]) -> Result<(), durable::WriteError> {
    let path = |number: u32| -> PathBuf { folder.join(format!("{number:03}.eml")) };
    let free = (1..).map(path).find(|path| path.symlink_metadata().is_err()).unwrap_or_default();
    durable::write_file(&free, mail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mail_becomes_a_file() {
        let folder = std::env::temp_dir().join(format!("paros-mails-{}", std::process::id()));
        let sink = MailSink::start(&folder).expect("a port");
        let stream = TcpStream::connect(sink.address()).expect("it listens");
        let mut answers = BufReader::new(&stream).lines();
        let mut ask = |said: &str, code: &str| {
            (&stream).write_all(said.as_bytes()).expect("it is there");
            let answer = answers.next().expect("an answer").expect("text");
            assert!(answer.starts_with(code), "{said}: {answer}");
        };
        ask("", "220");
        ask("EHLO b\r\n", "250");
        ask("STARTTLS\r\n", "502");
        ask("MAIL FROM:<a@b>\r\n", "250");
        ask("RCPT TO:<c@d>\r\n", "250");
        ask("DATA\r\n", "354");
        ask("Subject: x\r\n\r\n..dotted\r\n.\r\n", "250");
        ask("QUIT\r\n", "221");
        let mail = std::fs::read(folder.join("001.eml")).expect("a file");
        assert_eq!(mail, b"Subject: x\r\n\r\n.dotted\r\n");
        std::fs::remove_dir_all(&folder).expect("it is there");
    }
}
