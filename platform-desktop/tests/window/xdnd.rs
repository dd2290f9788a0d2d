//! A drag source: the source's side of the XDND protocol, version 5.

use std::path::Path;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;
use x11rb::{COPY_DEPTH_FROM_PARENT, COPY_FROM_PARENT, CURRENT_TIME};

type Failed = Box<dyn std::error::Error>;

/// Drags files from a hidden window onto the first window that accepts files, and drops them. Returns `true`
/// if the files were accepted.
pub(crate) fn drop_files(display: &str, files: &[&Path]) -> Result<bool, Failed> {
    let (connection, screen) = x11rb::connect(Some(display))?;
    let root = connection.setup().roots[screen].root;
    let target = find_xdnd_aware(&connection, root)?.ok_or("no window takes files")?;
    let source = hidden_window(&connection, root)?;
    let selection = intern_atom(&connection, "XdndSelection")?;
    connection.set_selection_owner(source, selection, CURRENT_TIME)?;
    let drag = Drag { connection, source, target };
    let list = drag.intern_atom("text/uri-list")?;
    let uris: String = files.iter().map(|file| file_uri(file)).collect();
    drag.send_message("XdndEnter", [5 << 24, list, 0, 0])?;
    drag.send_message(
        "XdndPosition",
        [0, 200 << 16 | 200, CURRENT_TIME, drag.intern_atom("XdndActionCopy")?],
    )?;
    let taken = drag.await_message("XdndStatus", &uris)?[1] & 1 == 1;
    // The target requested the list of files before it answered, and has received it.
    if taken {
        drag.send_message("XdndDrop", [0, CURRENT_TIME, 0, 0])?;
        drag.await_message("XdndFinished", &uris)?;
    } else {
        drag.send_message("XdndLeave", [0; 4])?;
    }
    Ok(taken)
}

/// Creates a window that is never shown.
pub(crate) fn hidden_window(connection: &RustConnection, root: Window) -> Result<Window, Failed> {
    let window = connection.generate_id()?;
    connection.create_window(
        COPY_DEPTH_FROM_PARENT,
        window,
        root,
        0,
        0,
        1,
        1,
        0,
        WindowClass::INPUT_OUTPUT,
        COPY_FROM_PARENT,
        &CreateWindowAux::new(),
    )?;
    Ok(window)
}

/// Returns a file's URI for a `text/uri-list`.
fn file_uri(file: &Path) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/.-_".contains(&byte);
    let bytes = file.as_os_str().as_encoded_bytes().iter();
    let path: String = bytes
        .map(|&byte| match plain(byte) {
            true => char::from(byte).to_string(),
            false => format!("%{byte:02X}"),
        })
        .collect();
    format!("file://{path}\r\n")
}

/// Finds the first window under another that accepts files.
fn find_xdnd_aware(connection: &RustConnection, under: Window) -> Result<Option<Window>, Failed> {
    let property = intern_atom(connection, "XdndAware")?;
    let version = connection.get_property(false, under, property, AtomEnum::ATOM, 0, 1)?.reply()?;
    if version.value32().is_some_and(|mut value| value.next().is_some()) {
        return Ok(Some(under));
    }
    for child in connection.query_tree(under)?.reply()?.children {
        if let Some(found) = find_xdnd_aware(connection, child)? {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

fn intern_atom(connection: &RustConnection, name: &str) -> Result<Atom, Failed> {
    Ok(connection.intern_atom(false, name.as_bytes())?.reply()?.atom)
}

struct Drag {
    connection: RustConnection,
    source: Window,
    target: Window,
}

impl Drag {
    fn intern_atom(&self, name: &str) -> Result<Atom, Failed> {
        intern_atom(&self.connection, name)
    }

    /// Sends the target a message of the protocol.
    fn send_message(&self, message: &str, [a, b, c, d]: [u32; 4]) -> Result<(), Failed> {
        let data = [self.source, a, b, c, d];
        let event = ClientMessageEvent::new(32, self.target, self.intern_atom(message)?, data);
        self.connection.send_event(false, self.target, EventMask::NO_EVENT, event)?;
        Ok(self.connection.flush()?)
    }

    /// Waits for the answer to a message. Meanwhile serves requests for the list of files.
    fn await_message(&self, message: &str, uris: &str) -> Result<[u32; 5], Failed> {
        let (answer, begun) = (self.intern_atom(message)?, Instant::now());
        while begun.elapsed() < Duration::from_secs(20) {
            match self.connection.poll_for_event()? {
                Some(Event::SelectionRequest(request)) => self.serve_selection(&request, uris)?,
                Some(Event::ClientMessage(event)) if event.type_ == answer => {
                    return Ok(event.data.as_data32());
                }
                Some(_) => {}
                None => std::thread::sleep(Duration::from_millis(5)),
            }
        }
        Err(format!("no {message}").into())
    }

    fn serve_selection(&self, request: &SelectionRequestEvent, uris: &str) -> Result<(), Failed> {
        let (to, property) = (request.requestor, request.property);
        let bytes = uris.as_bytes();
        self.connection.change_property8(PropMode::REPLACE, to, property, request.target, bytes)?;
        let event = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: to,
            selection: request.selection,
            target: request.target,
            property,
        };
        self.connection.send_event(false, to, EventMask::NO_EVENT, event)?;
        Ok(self.connection.flush()?)
    }
}
