//! Layout checks: Rust structures that mirror WGSL ones must agree in size and field offsets.

use std::fmt::Write as _;

use crate::shared::constants_module;

/// Returns Rust source of compile-time assertions that the named structures have the size and the field
/// offsets of the structures of the same names in a WGSL module.
pub(crate) fn layout_assertions(wgsl_path: &str, wgsl: &str, structures: &[&str]) -> String {
    // All constants are declared in front, so its imports can go.
    let source = (constants_module() + wgsl).replace("#define", "//").replace("#import", "//");
    let module = naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|error| panic!("{wgsl_path}: {}", error.emit_to_string(&source)));
    let mut text = String::from("const _: () = {\n");
    for name in structures {
        let named = |ty: &&naga::Type| ty.name.as_deref() == Some(name);
        let found = module.types.iter().map(|(_, ty)| ty).find(named);
        let Some(naga::TypeInner::Struct { members, span }) = found.map(|ty| &ty.inner) else {
            panic!("{wgsl_path} has no structure {name}");
        };
        push_check(&mut text, &format!("size_of::<{name}>()"), *span, name);
        for member in members {
            let field = member.name.as_deref().expect("WGSL names its fields");
            let offset = format!("offset_of!({name}, {field})");
            push_check(&mut text, &offset, member.offset, &format!("{name}::{field}"));
        }
    }
    text + "};\n"
}

/// Appends the assertion that `value`, a Rust expression, is `expected`.
fn push_check(text: &mut String, value: &str, expected: u32, what: &str) {
    writeln!(text, "    assert!({value} == {expected}, \"{what} differs from the shader's\");")
        .expect("strings take text");
}
