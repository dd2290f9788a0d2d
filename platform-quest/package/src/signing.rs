//! Signs the package with the user's own key or with a debug key.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::error::PackageError;
use crate::manifest::MIN_API_LEVEL;
use crate::tools;

/// A key, and the data to open its store.
#[derive(Debug)]
pub(crate) struct SigningKey {
    store: PathBuf,
    alias: Option<String>,
    /// `env:NAME` or `file:PATH`, in the format of `apksigner`. `None` for the debug key, whose password is
    /// public.
    password: Option<String>,
}

/// The password and the alias of every debug key, Android Studio's too.
const DEBUG_PASSWORD: &str = "android";
const DEBUG_ALIAS: &str = "androiddebugkey";

/// The environment variable in which `apksigner` finds a debug key's password.
const DEBUG_VARIABLE: &str = "PAROS_DEBUG_KEY_PASSWORD";

impl SigningKey {
    /// Loads a key of the user's own. The password is named, not given, as everybody can see the arguments of
    /// a process.
    ///
    /// # Errors
    /// The store is not a file, or the password is not given by `env:` or `file:`.
    pub(crate) fn load_release(
        store: &Path,
        alias: Option<&str>,
        password: &str,
    ) -> Result<Self, PackageError> {
        if !store.is_file() {
            return Err(PackageError::Input(format!("{}: no key store", store.display())));
        }
        match password.split_once(':') {
            Some(("env", name)) if env::var_os(name).is_none() => {
                return Err(PackageError::Input(format!("--key-password: {name} is not set")));
            }
            Some(("file", path)) if !Path::new(path).is_file() => {
                return Err(PackageError::Input(format!("--key-password: {path}: no such file")));
            }
            Some(("env" | "file", _)) => {}
            _ => return Err(PackageError::input("--key-password: expected env:NAME or file:PATH")),
        }
        let (alias, password) = (alias.map(str::to_owned), Some(password.to_owned()));
        Ok(SigningKey { store: store.to_owned(), alias, password })
    }

    /// Loads the debug key that Android's own tools keep in `~/.android`, and creates it if it is missing. A
    /// headset installs a new package over an older one only if both have the same key.
    ///
    /// # Errors
    /// There is no home folder, or `keytool` fails.
    pub(crate) fn load_or_create_debug() -> Result<Self, PackageError> {
        let home = env::home_dir()
            .ok_or_else(|| PackageError::failure("no home folder for a debug key"))?;
        let folder = env::var_os("ANDROID_USER_HOME").map_or(home.join(".android"), PathBuf::from);
        let store = folder.join("debug.keystore");
        if !store.is_file() {
            fs::create_dir_all(&folder)
                .map_err(|e| PackageError::Failure(format!("{}: {e}", folder.display())))?;
            create_debug_key(&store)?;
        }
        Ok(SigningKey { store, alias: Some(DEBUG_ALIAS.into()), password: None })
    }

    /// Signs a package by the signature schemes of Android 7 and later.
    ///
    /// # Errors
    /// The output of `apksigner`, for instance for a wrong password.
    pub(crate) fn sign(&self, package: &Path, output: &Path) -> Result<(), PackageError> {
        let mut sign = Command::new("apksigner");
        sign.args(["sign", "--min-sdk-version", &MIN_API_LEVEL.to_string()]);
        sign.args(["--v1-signing-enabled", "false", "--v4-signing-enabled", "false", "--ks"]);
        sign.arg(&self.store);
        if let Some(alias) = &self.alias {
            sign.args(["--ks-key-alias", alias]);
        }
        let debug = format!("env:{DEBUG_VARIABLE}");
        sign.env(DEBUG_VARIABLE, DEBUG_PASSWORD);
        sign.args(["--ks-pass", self.password.as_ref().unwrap_or(&debug)]);
        sign.arg("--out").arg(output).arg(package);
        tools::run_tool("signature", &mut sign).map(drop)
    }
}

/// Verifies a signed package. Returns the line of `apksigner` that names the signer.
///
/// # Errors
/// The signature is invalid.
pub(crate) fn verify_and_describe_signer(package: &Path) -> Result<String, PackageError> {
    let mut verify = Command::new("apksigner");
    verify.args(["verify", "--min-sdk-version", &MIN_API_LEVEL.to_string(), "--print-certs", "-v"]);
    let said = tools::run_tool("signature's check", verify.arg(package))?;
    let signer = said.lines().find(|line| line.contains("certificate DN"));
    Ok(signer.unwrap_or_default().to_owned())
}

/// Creates a debug key: RSA, whose signatures of one package are always the same bytes.
fn create_debug_key(store: &Path) -> Result<(), PackageError> {
    let mut make = Command::new("keytool");
    make.args([
        "-genkeypair",
        "-noprompt",
        "-keyalg",
        "RSA",
        "-keysize",
        "2048",
        "-validity",
        "10950",
    ]);
    make.args(["-alias", DEBUG_ALIAS, "-dname", "CN=Android Debug,O=Android,C=US", "-keystore"]);
    make.arg(store).args(["-storetype", "PKCS12", "-storepass:env", DEBUG_VARIABLE]);
    tools::run_tool("debug key", make.env(DEBUG_VARIABLE, DEBUG_PASSWORD)).map(drop)
}

#[cfg(test)]
mod tests {
    use std::env;

    use super::SigningKey;

    #[test]
    fn a_password_is_never_an_argument() {
        let here = env::current_exe().expect("this test");
        let why = |password| match SigningKey::load_release(&here, None, password) {
            Ok(_) => String::new(),
            Err(error) => error.to_string(),
        };
        assert_eq!(why("pass:secret"), "--key-password: expected env:NAME or file:PATH");
        assert_eq!(why("secret"), "--key-password: expected env:NAME or file:PATH");
        assert_eq!(why("env:PAROS_NO_SUCH_NAME"), "--key-password: PAROS_NO_SUCH_NAME is not set");
        assert_eq!(why("file:/no/such"), "--key-password: /no/such: no such file");
        assert_eq!(why("env:PATH"), "");
        let nowhere =
            SigningKey::load_release("/no/store".as_ref(), None, "env:PATH").expect_err("no store");
        assert_eq!(nowhere.to_string(), "/no/store: no key store");
    }
}
