//! Looks at who answers, before a booth knows the device.

use std::io;
use std::net::{TcpStream, ToSocketAddrs as _};
use std::sync::Arc;

use paros_shell::outbox::LinkFault;
use paros_shell::outbox::enrolment::ENROL_TIMEOUT;
use rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use rustls::crypto::{CryptoProvider, ring, verify_tls12_signature, verify_tls13_signature};
use rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use rustls::{ClientConfig, ClientConnection, DigitallySignedStruct, Error, SignatureScheme};

/// The port where an address has none.
const DEFAULT_PORT: u16 = 443;

/// The certificate (DER) of the authority that a booth shows beside its own. Nothing says yet that it is the site's:
/// that is what the pictograms of an enrolment by hand are for.
///
/// # Errors
/// Where nobody is reached, or who is shows no authority.
pub fn fetch_shown_authority(url: &str) -> Result<Vec<u8>, LinkFault> {
    let host = url.strip_prefix("https://").unwrap_or(url);
    let (name, port) = match host.rsplit_once(':') {
        Some((name, port)) if !name.ends_with(':') => (name, port.parse().ok()),
        _ => (host, Some(DEFAULT_PORT)),
    };
    let name = name.trim_start_matches('[').trim_end_matches(']').to_owned();
    let port = port.ok_or(LinkFault::Unreachable)?;
    let unreachable = |_| LinkFault::Unreachable;
    let mut addresses = (&name[..], port).to_socket_addrs().map_err(unreachable)?;
    let name = ServerName::try_from(name.clone()).map_err(|_| LinkFault::Unreachable)?;
    let connect = |address| TcpStream::connect_timeout(&address, ENROL_TIMEOUT).ok();
    let mut stream = addresses.find_map(connect).ok_or(LinkFault::Unreachable)?;
    stream.set_read_timeout(Some(ENROL_TIMEOUT)).map_err(unreachable)?;
    let mut connection =
        ClientConnection::new(Arc::new(config()?), name).map_err(|_| LinkFault::Untrusted)?;
    while connection.is_handshaking() {
        connection.complete_io(&mut stream).map_err(|error| match error.kind() {
            io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => LinkFault::TimedOut,
            _ => LinkFault::Untrusted,
        })?;
    }
    match connection.peer_certificates() {
        Some([_, .., authority]) => Ok(authority.to_vec()),
        _ => Err(LinkFault::Untrusted),
    }
}

fn config() -> Result<ClientConfig, LinkFault> {
    let provider = Arc::new(ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider.clone())
        .with_safe_default_protocol_versions()
        .map_err(|_| LinkFault::Untrusted)?
        .dangerous()
        .with_custom_certificate_verifier(Arc::new(AnyCertificate(provider)))
        .with_no_client_auth();
    Ok(config)
}

/// Takes any certificate, to look at it. Who shows it must have its key.
#[derive(Debug)]
struct AnyCertificate(Arc<CryptoProvider>);

impl ServerCertVerifier for AnyCertificate {
    fn verify_server_cert(
        &self,
        _end_entity: &CertificateDer<'_>,
        _intermediates: &[CertificateDer<'_>],
        _server_name: &ServerName<'_>,
        _ocsp_response: &[u8],
        _now: UnixTime,
    ) -> Result<ServerCertVerified, Error> {
        Ok(ServerCertVerified::assertion())
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        cert: &CertificateDer<'_>,
        dss: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        verify_tls12_signature(message, cert, dss, &self.0.signature_verification_algorithms)
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        cert: &CertificateDer<'_>,
        dss: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        verify_tls13_signature(message, cert, dss, &self.0.signature_verification_algorithms)
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        self.0.signature_verification_algorithms.supported_schemes()
    }
}
