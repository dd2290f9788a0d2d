//! The address of visitors' pages, and links to them.

use std::fmt::Write as _;
use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;

use maud::{Markup, PreEscaped, html};
use paros_booth_rules::LinkToken;
use paros_protocol::SculptureId;
use qrcode::{Color, EcLevel, QrCode};
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::ServerConfig;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::sign::SingleCertAndKey;

use super::PublicOptions;
use crate::error::Error;
use crate::server::staff_certificate::load_certificate;

/// The quiet zone around a QR code, in modules, as the standard requires.
const QUIET: usize = 4;

/// The address of visitors' pages.
#[derive(Clone)]
pub(crate) struct PublicAddress {
    /// The address at which the booth listens.
    pub(crate) listen: SocketAddr,
    /// The TLS configuration; `None` behind a proxy that terminates TLS.
    pub(crate) tls: Option<TlsAcceptor>,
    url: Arc<str>,
}

impl PublicAddress {
    /// Makes the address from the options. Returns `None` if visitors have no pages.
    ///
    /// # Errors
    /// The address, the certificate or the key is invalid.
    pub(crate) fn new(options: &PublicOptions) -> Result<Option<Self>, Error> {
        let (Some(listen), Some(url)) = (options.public_listen, &options.public_url) else {
            return Ok(None);
        };
        let url = url.trim_end_matches('/');
        let host = url.strip_prefix("https://").or_else(|| url.strip_prefix("http://"));
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b".-_:/[]~".contains(&byte);
        if host.is_none_or(|host| host.is_empty() || !host.bytes().all(is_plain)) {
            return Err(Error::Input(format!("--public-url {url}: expected https:// and a host")));
        }
        let tls = match (&options.public_cert, &options.public_key) {
            (Some(cert), Some(key)) => Some(load_tls(cert, key)?),
            _ => None,
        };
        Ok(Some(PublicAddress { listen, tls, url: url.into() }))
    }

    /// Returns the link to a visitor's page. It is shown only to the visitor and to staff, and never logged.
    pub(crate) fn link(&self, id: &SculptureId, token: &LinkToken) -> String {
        format!("{}{}", self.url, path_of(id, token))
    }
}

/// Returns the path of a visitor's page.
pub(crate) fn path_of(id: &SculptureId, token: &LinkToken) -> String {
    // A token has the same format as an id.
    format!("/s/{id}/{}", SculptureId(token.0))
}

/// Draws a text as a QR code with error correction, so that it is readable on creased paper.
pub(crate) fn draw_qr(text: &str, label: &str) -> Markup {
    let Ok(code) = QrCode::with_error_correction_level(text, EcLevel::M) else {
        // The text is too long for a QR code, which needs a host name of thousands of letters.
        return html! { p { (text) } };
    };
    let (side, colours) = (code.width(), code.to_colors());
    let mut path = String::new();
    for (k, _) in colours.iter().enumerate().filter(|(_, colour)| **colour == Color::Dark) {
        // Writing to a String doesn't fail.
        let _ = write!(path, "M{} {}h1v1h-1z", k % side + QUIET, k / side + QUIET);
    }
    let whole = side + 2 * QUIET;
    html! {
        svg class="qr" viewBox={ "0 0 " (whole) " " (whole) } role="img" aria-label=(label) shape-rendering="crispEdges" {
            (PreEscaped(format!("<rect width=\"{whole}\" height=\"{whole}\" fill=\"#ffffff\"/><path d=\"{path}\"/>")))
        }
    }
}

fn load_tls(cert: &Path, key: &Path) -> Result<TlsAcceptor, Error> {
    let certified = load_certificate(cert, key)?;
    let config = ServerConfig::builder_with_provider(default_provider().into())
        .with_safe_default_protocol_versions()
        .map_err(|error| Error::failure("TLS", error))?
        .with_no_client_auth()
        .with_cert_resolver(Arc::new(SingleCertAndKey::from(certified)));
    Ok(TlsAcceptor::from(Arc::new(config)))
}

#[cfg(test)]
mod tests {
    use super::{PublicAddress, PublicOptions, draw_qr};
    use paros_booth_rules::LinkToken;
    use paros_protocol::SculptureId;

    fn at(url: &str) -> Result<Option<PublicAddress>, crate::Error> {
        let listen = Some("127.0.0.1:0".parse().unwrap());
        PublicAddress::new(&PublicOptions {
            public_listen: listen,
            public_url: Some(url.into()),
            ..PublicOptions::default()
        })
    }

    #[test]
    fn a_link_is_the_url_the_id_and_the_token() {
        let address = at("https://paros.example/art/").unwrap().expect("one was named");
        let link = address.link(&SculptureId([1; 16]), &LinkToken([0xab; 16]));
        let (id, token) = ("01".repeat(16), "ab".repeat(16));
        assert_eq!(link, format!("https://paros.example/art/s/{id}/{token}"));
        for url in
            ["paros.example", "ftp://paros.example", "https://", "https://a\"b", "https://a b"]
        {
            assert!(at(url).is_err(), "{url}");
        }
        assert!(PublicAddress::new(&PublicOptions::default()).unwrap().is_none());
    }

    #[test]
    fn a_code_has_its_three_corners() {
        let svg = draw_qr("https://paros.example/s/0/1", "Scan").into_string();
        assert!(svg.contains("aria-label=\"Scan\""));
        let side: usize =
            svg.split("viewBox=\"0 0 ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        for (x, y) in [(4, 4), (side - 5, 4), (4, side - 5)] {
            assert!(svg.contains(&format!("M{x} {y}h1")), "{x} {y}");
        }
    }
}
