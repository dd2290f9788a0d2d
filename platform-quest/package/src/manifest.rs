//! The manifest: compiled by `aapt2`, read back from the package, and checked against the requirements of a
//! Quest.

use std::path::Path;
use std::process::Command;

use crate::error::PackageError;
use crate::resources::Resources;
use crate::tools::{self, FRAMEWORK, Scratch};

/// The manifest's source.
pub(crate) const MANIFEST: &str = include_str!("AndroidManifest.xml");

/// The lowest API level that the package runs on: a Quest's of 2021.
pub(crate) const MIN_API_LEVEL: u32 = 29;

/// The API level whose behaviour the app is made for.
const TARGET_API_LEVEL: u32 = 32;

/// The wildcard in a demand for any reference to a resource.
const ANY_REFERENCE: &str = "@";

/// An attribute that a manifest must not have: the element's path, and the attribute with its value.
type Refusal = (&'static str, (&'static str, &'static str));

/// The attributes that Meta's pages refuse, as of 2026-11: a debuggable build, and an activity without
/// history.
const REFUSALS: [Refusal; 2] =
    [("manifest/application", ("debuggable", "true")), (ACTIVITY, ("noHistory", "true"))];

/// The requested permissions. Any other permission, for instance from a merged manifest, is reported, as Meta
/// refuses many.
const PERMISSIONS: [&str; 5] = [
    "org.khronos.openxr.permission.OPENXR",
    "org.khronos.openxr.permission.OPENXR_SYSTEM",
    "com.oculus.permission.HAND_TRACKING",
    "android.permission.ACCESS_NETWORK_STATE",
    "android.permission.INTERNET",
];

/// An element that the manifest must have: its path, and the values of its attributes.
type Demand = (&'static str, &'static [(&'static str, &'static str)]);

const ACTIVITY: &str = "manifest/application/activity";
const CATEGORY: &str = "manifest/application/activity/intent-filter/category";
const PERMISSION: &str = "manifest/uses-permission";

/// The requirements of Meta, of Khronos' loader, and of Android for a managed app. Checked against Meta's
/// pages "Android Manifest Settings" and "Application Manifests for Release Builds" (of 2026-03-05) as they
/// were in 2026-11.
const DEMANDS: [Demand; 20] = [
    ("manifest", &[("installLocation", "0")]),
    ("manifest/uses-sdk", &[("minSdkVersion", "29"), ("targetSdkVersion", "32")]),
    (
        "manifest/uses-feature",
        &[("name", "android.hardware.vr.headtracking"), ("required", "true"), ("version", "1")],
    ),
    ("manifest/uses-feature", &[("name", "oculus.software.handtracking"), ("required", "false")]),
    (PERMISSION, &[("name", "org.khronos.openxr.permission.OPENXR")]),
    (PERMISSION, &[("name", "org.khronos.openxr.permission.OPENXR_SYSTEM")]),
    (PERMISSION, &[("name", "com.oculus.permission.HAND_TRACKING")]),
    (PERMISSION, &[("name", "android.permission.ACCESS_NETWORK_STATE")]),
    // For the connection to the booth, which needn't reach the internet.
    (PERMISSION, &[("name", "android.permission.INTERNET")]),
    (
        "manifest/queries/provider",
        &[(
            "authorities",
            "org.khronos.openxr.runtime_broker;org.khronos.openxr.system_runtime_broker",
        )],
    ),
    ("manifest/queries/intent/action", &[("name", "org.khronos.openxr.OpenXRRuntimeService")]),
    // The library is mapped directly from the package; there is no Java code; nothing is backed up.
    (
        "manifest/application",
        &[("extractNativeLibs", "false"), ("hasCode", "false"), ("allowBackup", "false")],
    ),
    // 3 is images, the nearest of Android's categories.
    ("manifest/application", &[("label", "Paros"), ("icon", ANY_REFERENCE), ("appCategory", "3")]),
    (
        "manifest/application/meta-data",
        &[("name", "android.content.APP_RESTRICTIONS"), ("resource", ANY_REFERENCE)],
    ),
    (
        "manifest/application/meta-data",
        &[("name", "com.oculus.supportedDevices"), ("value", "quest2|questpro|quest3|quest3s")],
    ),
    // singleTask, landscape, and no restart on any of the fourteen configuration changes.
    (
        ACTIVITY,
        &[
            ("name", "android.app.NativeActivity"),
            ("exported", "true"),
            ("launchMode", "2"),
            ("screenOrientation", "0"),
            ("configChanges", "0x00003fff"),
        ],
    ),
    (
        "manifest/application/activity/meta-data",
        &[("name", "android.app.lib_name"), ("value", "paros_quest")],
    ),
    (CATEGORY, &[("name", "com.oculus.intent.category.VR")]),
    (CATEGORY, &[("name", "org.khronos.openxr.intent.category.IMMERSIVE_HMD")]),
    (CATEGORY, &[("name", "android.intent.category.LAUNCHER")]),
];

/// Makes a package from a manifest and the resources that it refers to.
///
/// # Errors
/// `aapt2` rejects the manifest.
pub(crate) fn compile_manifest(
    manifest_xml: &str,
    resources: &Resources,
    scratch: &Scratch,
    output: &Path,
) -> Result<(), PackageError> {
    let compiled = resources.compile(scratch)?;
    let xml = scratch.at("AndroidManifest.xml");
    std::fs::write(&xml, manifest_xml).map_err(PackageError::failure)?;
    let (least, target) = (MIN_API_LEVEL.to_string(), TARGET_API_LEVEL.to_string());
    let mut link = Command::new("aapt2");
    // `aapt2` doesn't know `<queries>`, but writes it nevertheless.
    link.args(["link", "--warn-manifest-validation", "-I", FRAMEWORK, "--manifest"]).arg(&xml);
    link.args(["--min-sdk-version", &least, "--target-sdk-version", &target]);
    link.args(["--version-name", env!("CARGO_PKG_VERSION")]);
    link.args(["--version-code", &version_code(env!("CARGO_PKG_VERSION"))]).arg("-o").arg(output);
    link.arg(compiled);
    tools::run_tool("manifest", &mut link).map(drop)
}

/// Finds the demands that a package's manifest does not meet.
///
/// # Errors
/// `aapt2` can't read the package.
pub(crate) fn find_unmet_demands(package: &Path) -> Result<Vec<String>, PackageError> {
    let mut dump = Command::new("aapt2");
    dump.args(["dump", "xmltree", "--file", "AndroidManifest.xml"]).arg(package);
    let elements = parse_elements(&tools::run_tool("manifest's check", &mut dump)?);
    let met = |(path, values): &&Demand| {
        let holds = |element: &Element| {
            let has = |(name, value): &(&str, &str)| {
                let fits = |found: &str| match *value {
                    ANY_REFERENCE => found.starts_with(ANY_REFERENCE),
                    value => found == value,
                };
                element.attributes.iter().any(|(n, v)| n == name && fits(v))
            };
            element.path == *path && values.iter().all(has)
        };
        elements.iter().any(holds)
    };
    let missed = DEMANDS.iter().filter(|demand| !met(demand));
    let missed = missed.map(|(path, values)| format!("the manifest lacks {path} with {values:?}"));
    Ok(missed.chain(find_refused(&elements)).collect())
}

/// Finds the refused attributes and permissions of a manifest's elements.
fn find_refused(elements: &[Element]) -> Vec<String> {
    let mut refused = Vec::new();
    for Element { path, attributes } in elements {
        for (name, value) in attributes {
            if REFUSALS.iter().any(|(p, (n, v))| p == path && n == name && v == value) {
                refused.push(format!("the manifest has {path} with {name} = {value}"));
            }
            if path == PERMISSION && name == "name" && !PERMISSIONS.contains(&&**value) {
                refused.push(format!("the manifest asks for {value}"));
            }
        }
    }
    refused
}

/// Returns the version code, a number that grows with the version: two digits for each part after the first.
fn version_code(version: &str) -> String {
    let parts = version.split('.').map(|part| part.parse().unwrap_or(0));
    parts.fold(0u32, |code, part| code * 100 + part).to_string()
}

/// An element of a compiled manifest.
#[derive(Debug, PartialEq, Eq)]
struct Element {
    /// The element names from the root on, separated by slashes.
    path: String,
    attributes: Vec<(String, String)>,
}

/// Parses the elements in the output of `aapt2 dump xmltree`.
fn parse_elements(dump: &str) -> Vec<Element> {
    let mut elements: Vec<Element> = Vec::new();
    // The indentation and name of each open element.
    let mut open: Vec<(usize, String)> = Vec::new();
    for line in dump.lines() {
        let text = line.trim_start();
        let indent = line.len() - text.len();
        if let Some(element) = text.strip_prefix("E: ") {
            let name = element.split(' ').next().unwrap_or_default();
            open.retain(|(outer, _)| *outer < indent);
            open.push((indent, name.to_owned()));
            let path = open.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>().join("/");
            elements.push(Element { path, attributes: Vec::new() });
        } else if let Some((name, value)) = text.strip_prefix("A: ").and_then(|a| a.split_once('='))
            && let Some(element) = elements.last_mut()
        {
            let name = name.rsplit(':').next().unwrap_or(name).split('(').next().unwrap_or(name);
            let value = value.split(" (Raw:").next().unwrap_or(value).trim_matches('"');
            element.attributes.push((name.to_owned(), value.to_owned()));
        }
    }
    elements
}

#[cfg(test)]
mod tests {
    use super::{
        DEMANDS, MANIFEST, compile_manifest, find_unmet_demands, parse_elements, version_code,
    };
    use crate::resources::Resources;
    use crate::test_support::scratch_folder;
    use crate::tools;

    #[test]
    fn each_demand_that_is_not_met_is_told() {
        let folder = scratch_folder("manifest");
        if paros_shell::require::require_or_skip(tools::check_tools(false))
            .expect("Debian has them")
            .is_none()
        {
            return;
        }
        let resources = Resources::of_package(&[]).expect("an icon");
        let faults_of = |manifest: &str| {
            let package = folder.at("bare.apk");
            compile_manifest(manifest, &resources, &folder, &package).expect("it is a manifest");
            find_unmet_demands(&package).expect("it can be read")
        };
        assert_eq!(faults_of(MANIFEST), [""; 0]);
        let values =
            DEMANDS.iter().flat_map(|(path, values)| values.iter().map(move |v| (path, v)));
        let mut tried = 0;
        for (path, (name, value)) in values {
            let spoilt = match MANIFEST.matches(&format!("{name}=\"{value}\"")).count() {
                1 => {
                    MANIFEST.replace(&format!("{name}=\"{value}\""), &format!("{name}=\"false0\""))
                }
                _ => continue,
            };
            let Ok(()) = compile_manifest(&spoilt, &resources, &folder, &folder.at("bare.apk"))
            else {
                continue;
            };
            let told = find_unmet_demands(&folder.at("bare.apk")).expect("it can be read");
            assert!(told.iter().any(|fault| fault.contains(path)), "{name}={value}: {told:?}");
            tried += 1;
        }
        assert!(tried > 10, "{tried} demands were spoilt");
        let without = MANIFEST.replace("singleTask", "singleTop").replace("|uiMode", "");
        assert_eq!(faults_of(&without).len(), 1);
        let told = |text: &str, with: &str| faults_of(&MANIFEST.replace(text, with)).concat();
        let debuggable = told("android:hasCode", "android:debuggable=\"true\" android:hasCode");
        assert_eq!(debuggable, "the manifest has manifest/application with debuggable = true");
        let forgotten = told("android:launchMode", "android:noHistory=\"true\" android:launchMode");
        assert!(forgotten.ends_with("activity with noHistory = true"), "{forgotten}");
        let more = "<uses-permission android:name=\"android.permission.CAMERA\" />\n<queries>";
        assert_eq!(told("<queries>", more), "the manifest asks for android.permission.CAMERA");
        let without_icon = told("android:icon=\"@mipmap/icon\"", "");
        assert!(without_icon.contains("(\"icon\", \"@\")"), "{without_icon}");
        let unmanaged = told("android.content.APP_RESTRICTIONS", "a.b");
        assert!(unmanaged.contains("APP_RESTRICTIONS"), "{unmanaged}");
    }

    #[test]
    fn a_dump_is_read() {
        let dump = "N: android=http://schemas.android.com/apk/res/android (line=4)\n  \
            E: manifest (line=4)\n    \
            A: package=\"a.b\" (Raw: \"a.b\")\n      \
            E: queries (line=0)\n          \
            E: provider (line=1)\n            \
            A: http://schemas.android.com/apk/res/android:authorities(0x01010018)=\"x;y\" (Raw: \"x;y\")\n      \
            E: application (line=2)\n        \
            A: http://schemas.android.com/apk/res/android:hasCode(0x0101000c)=false\n";
        let read: Vec<_> = parse_elements(dump)
            .into_iter()
            .map(|e| format!("{} {:?}", e.path, e.attributes))
            .collect();
        assert_eq!(
            read,
            [
                r#"manifest [("package", "a.b")]"#,
                "manifest/queries []",
                r#"manifest/queries/provider [("authorities", "x;y")]"#,
                r#"manifest/application [("hasCode", "false")]"#,
            ]
        );
    }

    #[test]
    fn a_later_version_has_a_greater_code() {
        assert_eq!(version_code("0.1.0"), "100");
        assert_eq!(version_code("1.2.3"), "10203");
    }
}
