//! The address of the database, and connections to it: over TLS, unless it is on this machine.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use postgres::config::{Host, SslMode};
use postgres::{Client, Config, NoTls};
use tokio_postgres_rustls::MakeRustlsConnect;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::CertificateDer;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::{ClientConfig, RootCertStore};

use crate::error::Error;

/// The timeout of a connection attempt, unless the address sets one.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);

/// The timeout of data that was sent and isn't acknowledged, and the idle time before keepalives.
const SILENCE_TIMEOUT: Duration = Duration::from_secs(20);

/// The settings of each session. Transactions take milliseconds, so the timeouts end those that hang and
/// would block others. Commits are synced to disk.
const SETTINGS: &str = "SET lock_timeout = '5s';
    SET statement_timeout = '30s';
    SET idle_in_transaction_session_timeout = '30s';
    SELECT set_config('synchronous_commit', 'on', false) WHERE current_setting('synchronous_commit') = 'off'";

/// The address of the database, with the login and the TLS configuration.
pub struct PostgresAddress {
    config: Config,
    tls: Option<MakeRustlsConnect>,
}

impl PostgresAddress {
    /// Parses an address `postgres://USER@HOST/NAME`. The password is in the address, or in the first line of
    /// `password_file`. The authorities in `ca_file` (PEM), or the system's, verify the server's certificate.
    ///
    /// # Errors
    /// A description of what is wrong with the address or the files. It never contains the address, which may
    /// contain a password.
    pub fn new(
        address: &str,
        password_file: Option<&Path>,
        ca_file: Option<&Path>,
    ) -> Result<Self, Error> {
        let bad = |expected: &str| Error::Input(format!("--database: expected {expected}"));
        let is_url = ["postgres://", "postgresql://"].iter().any(|head| address.starts_with(head));
        let config = address.parse::<Config>().ok().filter(|_| is_url);
        let mut config = config.ok_or_else(|| bad("postgres://USER@HOST/NAME"))?;
        if config.get_hosts().is_empty() {
            return Err(bad(
                "a host, or the folder of a socket: postgres://USER@/NAME?host=/FOLDER",
            ));
        }
        if let Some(path) = password_file {
            let file = fs::read_to_string(path);
            let file =
                file.map_err(|error| Error::Input(format!("{}: {error}", path.display())))?;
            config.password(file.lines().next().unwrap_or_default());
        }
        if config.get_application_name().is_none() {
            config.application_name("paros-booth");
        }
        if config.get_connect_timeout().is_none() {
            config.connect_timeout(CONNECT_TIMEOUT);
        }
        config.tcp_user_timeout(SILENCE_TIMEOUT).keepalives_idle(SILENCE_TIMEOUT);
        if config.get_ssl_mode() == SslMode::Prefer {
            // `prefer` is not used: an attacker in between could make the connection fall back to plain text.
            let is_near = config.get_hosts().iter().all(is_this_machine);
            config.ssl_mode(if is_near { SslMode::Disable } else { SslMode::Require });
        }
        let tls = match config.get_ssl_mode() {
            SslMode::Disable => None,
            _ => Some(MakeRustlsConnect::new(tls_config(ca_file)?)),
        };
        Ok(PostgresAddress { config, tls })
    }

    /// Opens a connection.
    ///
    /// # Errors
    /// The error of PostgreSQL or the network.
    pub(crate) fn connect(&self) -> Result<Client, postgres::Error> {
        let mut client = match &self.tls {
            Some(tls) => self.config.connect(tls.clone())?,
            None => self.config.connect(NoTls)?,
        };
        client.batch_execute(SETTINGS)?;
        Ok(client)
    }
}

/// Returns `true` if `host` is a Unix socket or a loopback address.
fn is_this_machine(host: &Host) -> bool {
    match host {
        Host::Unix(_) => true,
        Host::Tcp(name) => {
            name == "localhost"
                || name.parse().is_ok_and(|address: std::net::IpAddr| address.is_loopback())
        }
    }
}

fn tls_config(ca_file: Option<&Path>) -> Result<ClientConfig, Error> {
    let mut roots = RootCertStore::empty();
    if let Some(path) = ca_file {
        let bad = |why: &dyn std::fmt::Display| Error::Input(format!("{}: {why}", path.display()));
        let authorities = CertificateDer::pem_file_iter(path).map_err(|error| bad(&error))?;
        for authority in authorities {
            let authority = authority.map_err(|error| bad(&error))?;
            roots.add(authority).map_err(|error| bad(&error))?;
        }
    } else {
        // System certificates that can't be read are ignored.
        roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
    }
    if roots.is_empty() {
        return Err(Error::Input("--database-ca: expected certificates in PEM".into()));
    }
    let config = ClientConfig::builder_with_provider(Arc::new(default_provider()))
        .with_safe_default_protocol_versions()
        .map_err(|error| Error::failure("TLS", error))?;
    Ok(config.with_root_certificates(roots).with_no_client_auth())
}

#[cfg(test)]
mod tests {
    use postgres::config::SslMode;

    use super::PostgresAddress;

    fn ssl_mode(address: &str) -> SslMode {
        PostgresAddress::new(address, None, None).expect("an address").config.get_ssl_mode()
    }

    #[test]
    fn what_leaves_the_machine_is_encrypted() {
        for near in ["u@localhost/b", "u@127.0.0.1/b", "u@[::1]/b", "u@/b?host=/run/postgresql"] {
            assert_eq!(ssl_mode(&format!("postgres://{near}")), SslMode::Disable, "{near}");
        }
        for far in ["u@db.example/b", "u@10.0.0.1/b?sslmode=prefer", "u@localhost,10.0.0.1/b"] {
            assert_eq!(ssl_mode(&format!("postgres://{far}")), SslMode::Require, "{far}");
        }
        assert_eq!(ssl_mode("postgres://u@10.0.0.1/b?sslmode=disable"), SslMode::Disable);
        assert_eq!(ssl_mode("postgres://u@127.0.0.1/b?sslmode=require"), SslMode::Require);
    }

    #[test]
    fn what_is_no_address_is_told_without_it() {
        for bad in ["", "u:hunter2@h/b", "mysql://u:hunter2@h/b", "postgres://u:hunter2@h:x/b"] {
            let error = PostgresAddress::new(bad, None, None).err().expect("no address");
            let error = error.to_string();
            assert!(error.starts_with("--database: expected postgres://USER"), "{error}");
            assert!(!error.contains("hunter2"), "{error}");
        }
        let error = PostgresAddress::new("postgres:///b", None, None).err().expect("no host");
        assert!(error.to_string().contains("a host"), "{error}");
    }
}
