//! Stubs of Android's Java classes: sources generated from the table, compiled by `javac` and inspected
//! by `javap`.

pub(crate) mod vm;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::{fs, iter};

use paros_quest::device::table::{ALL_MEMBERS, JavaMember, MemberKind};

/// The superclasses of stubs whose members are called on a subclass's objects.
const SUPERCLASSES: [(&str, &str); 1] = [("android/os/Bundle", "android/os/BaseBundle")];

/// Arguments that make a tool of the JDK use only the quick compiler, as it doesn't run for long.
const QUICK_JDK: [&str; 2] = ["-J-XX:TieredStopAtLevel=1", "-J-XX:+UseSerialGC"];

/// Returns the table's members, grouped by class.
pub(crate) fn members_by_class() -> BTreeMap<&'static str, Vec<JavaMember>> {
    let mut classes: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for member in ALL_MEMBERS {
        classes.entry(member.class).or_default().push(*member);
    }
    classes
}

/// Returns `true` if a class is Android's and so needs a stub; Java's own classes need none.
pub(crate) fn is_android(class: &str) -> bool {
    class.starts_with("android/")
}

/// Generates the stubs' sources and compiles them into `folder/classes`.
///
/// # Errors
/// `javac`'s messages, or the error that there is no `javac`.
pub(crate) fn compile_stubs(folder: &Path) -> Result<(), String> {
    let _ = fs::remove_dir_all(folder);
    let mut files = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/android/Fake.java")];
    for (outer, source) in stub_sources() {
        let path = folder.join("sources").join(format!("{outer}.java"));
        fs::create_dir_all(path.parent().expect("a folder")).map_err(|e| e.to_string())?;
        fs::write(&path, source).map_err(|e| e.to_string())?;
        files.push(path);
    }
    let mut javac = Command::new("javac");
    let output = javac.args(QUICK_JDK).arg("-d").arg(folder.join("classes")).args(files).output();
    let output = output.map_err(|e| format!("javac: {e}"))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if output.status.success() { Ok(()) } else { Err(said) }
}

/// Returns the public members that `javap` finds in each of these compiled classes, in the format of
/// [`describe_member`].
pub(crate) fn run_javap(folder: &Path, classes: &[&str]) -> Vec<BTreeSet<String>> {
    let mut javap = Command::new("javap");
    javap.args(QUICK_JDK).args(["-s", "-public", "-cp"]).arg(folder.join("classes"));
    javap.args(classes.iter().map(|class| class.replace('/', ".")));
    let output = javap.output().expect("a JDK has it");
    let text = String::from_utf8_lossy(&output.stdout);
    // Only the first line of a class ends with `{`.
    text.split("{\n").skip(1).map(parse_members).collect()
}

/// Parses the members in the lines of one class.
fn parse_members(text: &str) -> BTreeSet<String> {
    let lines: Vec<_> = text.lines().map(str::trim).collect();
    let members = lines.windows(2).filter_map(|pair| {
        let signature = pair[1].strip_prefix("descriptor: ")?;
        let name = pair[0].split(['(', ';']).next()?.split(' ').next_back()?;
        let how = if pair[0].contains(" static ") { "static " } else { "" };
        Some(format!("{how}{name} {signature}"))
    });
    members.collect()
}

/// Describes a member: `static` or nothing, name and signature. A constructor has its class's name.
pub(crate) fn describe_member(member: &JavaMember) -> String {
    let JavaMember { class, name, signature, .. } = member;
    match member.kind {
        MemberKind::Method => format!("{name} {signature}"),
        MemberKind::StaticMethod | MemberKind::StaticField => format!("static {name} {signature}"),
        MemberKind::Constructor => format!("{} {signature}", class.replace('/', ".")),
    }
}

/// Generates the stubs' sources by outermost class. A class that occurs only in signatures has an empty body.
fn stub_sources() -> BTreeMap<String, String> {
    let mut classes = members_by_class();
    for member in ALL_MEMBERS {
        let types = member.signature.split(['(', ')', ';', '[']);
        for class in
            types.filter_map(|name| name.trim_start_matches(['I', 'Z', 'F', 'V']).strip_prefix('L'))
        {
            classes.entry(class).or_default();
        }
    }
    let mut sources: BTreeMap<String, String> = BTreeMap::new();
    // Build before Build$VERSION; an outer class that isn't in the table is empty.
    for (class, members) in classes.iter().filter(|(class, _)| is_android(class)) {
        let (outer, inner) = class.split_once('$').map_or((*class, None), |(o, i)| (o, Some(i)));
        let body: String = members.iter().map(stub_member).collect();
        let (package, name) = outer.rsplit_once('/').expect("a package");
        match inner {
            None => {
                let package = package.replace('/', ".");
                let superclass = SUPERCLASSES.iter().find(|(class, _)| *class == outer);
                let extends = superclass
                    .map(|(_, of)| format!("extends {}", of.replace('/', ".")))
                    .unwrap_or_default();
                let source =
                    format!("package {package};\npublic class {name} {extends} {{\n{body}}}\n");
                sources.insert(outer.to_owned(), source);
            }
            Some(inner) => {
                let package = package.replace('/', ".");
                let empty = || format!("package {package};\npublic class {name} {{\n}}\n");
                let source = sources.entry(outer.to_owned()).or_insert_with(empty);
                let end = source.rfind('}').expect("it ends");
                source.insert_str(end, &format!("public static class {inner} {{\n{body}}}\n"));
            }
        }
    }
    sources
}

/// Generates the Java source of a member: a method's body calls `paros.Fake.answer`.
fn stub_member(member: &JavaMember) -> String {
    let mut types = java_types(member.signature);
    let result = types.pop().expect("every member has a type");
    let JavaMember { name, kind, .. } = member;
    let mut text = String::from("  public ");
    text += if *kind == MemberKind::Method { "" } else { "static " };
    if *kind == MemberKind::StaticField {
        let _ = writeln!(text, "{result} {name};");
        return text;
    }
    let parameters: Vec<_> = types.iter().enumerate().map(|(i, t)| format!("{t} a{i}")).collect();
    let arguments: String = (0..types.len()).map(|i| format!(", (Object) a{i}")).collect();
    let class = member.class.rsplit('/').next().expect("a name");
    let answer = format!("paros.Fake.answer(\"{class}.{name}\"{arguments})");
    let boxed = match &*result {
        "int" => "Integer",
        "boolean" => "Boolean",
        "float" => "Float",
        other => other,
    };
    let body = if result == "void" { answer } else { format!("return ({boxed}) {answer}") };
    let _ = writeln!(text, "{result} {name}({}) {{ {body}; }}", parameters.join(", "));
    text
}

/// Returns the Java types of a JNI signature: the parameters', then the returned one.
fn java_types(signature: &str) -> Vec<String> {
    let mut rest = signature.trim_start_matches('(');
    let next = iter::from_fn(|| {
        rest = rest.trim_start_matches(')');
        let arrays = rest.len() - rest.trim_start_matches('[').len();
        rest = &rest[arrays..];
        let (name, after) = match rest.chars().next()? {
            'L' => {
                rest[1..].split_once(';').map(|(name, after)| (name.replace('/', "."), after))?
            }
            letter => {
                let name = match letter {
                    'I' => "int",
                    'Z' => "boolean",
                    'F' => "float",
                    'V' => "void",
                    other => panic!("no stub has the type {other}"),
                };
                (name.to_owned(), &rest[1..])
            }
        };
        rest = after;
        Some(name.replace('$', ".") + &"[]".repeat(arrays))
    });
    next.collect()
}
