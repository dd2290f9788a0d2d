//! Compiles WGSL modules to SPIR-V programs, one for each variant.
//!
//! `naga_oil` joins a module with its imports, `naga` sets the variant's overrides and writes SPIR-V 1.3
//! for Vulkan 1.1. Every option of the writer is set here, so that a program's words don't depend on the
//! build's profile.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga_oil::compose::{
    ComposableModuleDescriptor, Composer, NagaModuleDescriptor, ShaderDefValue, ShaderType,
};

use crate::constants::BINDING_COUNT;
use crate::words::{self, LoopUnrolling};
use crate::{counting, layout, shared};

/// Modules that others import, each after its own imports.
const LIBRARY: [&str; 7] = ["constants", "layout", "box", "light", "marble", "beam", "shadow"];

/// A program variant: its name, WGSL module, stage (and so entry point), preprocessor definitions,
/// and values of `override` constants.
#[derive(Clone)]
struct ShaderVariant {
    name: String,
    module: &'static str,
    stage: naga::ShaderStage,
    defs: Vec<&'static str>,
    overrides: Vec<(&'static str, f64)>,
    /// `true` if the program counts its fetches instead of drawing.
    counts: bool,
}

impl ShaderVariant {
    fn with_def(mut self, def: &'static str) -> Self {
        self.defs.push(def);
        self
    }

    /// Returns the variant that counts the fetches of this program.
    fn counting(&self) -> Self {
        ShaderVariant { name: format!("{}_counted", self.name), counts: true, ..self.clone() }
    }

    /// Returns the fast path's variant without its march and with two fetches of shading: a lower bound of
    /// its cost.
    fn without_march(&self) -> Self {
        ShaderVariant { name: format!("{}_floor", self.name), ..self.clone() }.with_def("FLOOR")
    }
}

/// Writes the programs, and a table of them, into the folder `out`.
pub(crate) fn write_programs(out: &Path) {
    println!("cargo::rerun-if-changed=wgsl");
    let mut table = String::new();
    let mut names = Vec::new();
    for program in program_list() {
        let words = compile_program(&program);
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let file = out.join(format!("{}.spv", program.name));
        std::fs::write(&file, bytes).expect("OUT_DIR takes files");
        names.push(program.name.to_uppercase());
        writeln!(
            table,
            "/// `wgsl/{}.wgsl`.\npub const {}: ShaderProgram = ShaderProgram {{ name: {:?}, bytes: \
             include_bytes!(concat!(env!(\"OUT_DIR\"), \"/{}.spv\")) }};",
            program.module,
            program.name.to_uppercase(),
            program.name,
            program.name,
        )
        .expect("strings take text");
    }
    for (module, structures) in
        [("layout", &["ViewUniforms", "FrameUniforms"][..]), ("scatter", &["Patch"])]
    {
        let WgslModule { path, text } = read_module(module);
        let checks = layout::layout_assertions(&path, &text, structures);
        std::fs::write(out.join(format!("{module}.rs")), checks).expect("OUT_DIR takes files");
    }
    writeln!(
        table,
        "/// Every program.\npub const ALL: &[ShaderProgram] = &[{}];",
        names.join(", ")
    )
    .expect("strings take text");
    std::fs::write(out.join("programs.rs"), table).expect("OUT_DIR takes files");
}

fn program_list() -> Vec<ShaderVariant> {
    let program = |name: &str, module, stage, overrides: &[(&'static str, f64)]| ShaderVariant {
        name: name.into(),
        module,
        stage,
        defs: Vec::new(),
        overrides: overrides.to_vec(),
        counts: false,
    };
    use naga::ShaderStage::{Compute, Fragment, Vertex};
    let mut all = vec![
        program("box_vertex", "box", Vertex, &[]),
        program("tiles_vertex", "tiles", Vertex, &[]),
        program("tiles", "tiles", Fragment, &[]),
        program("tile_vertex", "tile", Vertex, &[]),
        program("beams_vertex", "tile", Vertex, &[]).with_def("BEAMS"),
        program("beams", "beams", Fragment, &[]),
        program("scene_vertex", "scene", Vertex, &[]),
        program("scene", "scene", Fragment, &[]),
        program("particles", "scene", Fragment, &[]).with_def("PARTICLES"),
        program("cast_vertex", "cast", Vertex, &[]),
        program("cast_sculpture_vertex", "cast", Vertex, &[]).with_def("SCULPTURE"),
        program("cast_sculpture", "cast", Fragment, &[]).with_def("SCULPTURE"),
        program("overlay_vertex", "overlay", Vertex, &[]),
        program("overlay", "overlay", Fragment, &[]),
        program("panel_vertex", "panel", Vertex, &[]),
        program("panel", "panel", Fragment, &[]),
        program("scatter", "scatter", Compute, &[]),
    ];
    for (name, half, coverage) in [
        ("fast", false, 0.0),
        ("fast_half", true, 0.0),
        ("fast_coverage", false, 1.0),
        ("fast_half_coverage", true, 1.0),
    ] {
        let overrides = [("COVERAGE", coverage)];
        let single = program(name, "fast", Fragment, &overrides);
        let fast = if half { single.with_def("HALF") } else { single };
        all.extend([fast.counting(), fast.without_march(), fast]);
    }
    for (part, overrides) in [
        ("", &[][..]),
        ("_full_march", &[("FULL_MARCH", 1.0)]),
        ("_no_sdf", &[("SDF", 0.0)]),
        ("_no_shading", &[("SHADING", 0.0)]),
    ] {
        let one = program(&format!("paper{part}"), "paper", Fragment, overrides);
        if part.is_empty() {
            all.push(one.counting());
        }
        all.push(one);
        let two = program(&format!("paper_two{part}"), "paper", Fragment, overrides);
        all.push(two.with_def("TWO_INTERVALS"));
    }
    all
}

fn compile_program(program: &ShaderVariant) -> Vec<u32> {
    let capabilities =
        Capabilities::MULTIVIEW | Capabilities::EARLY_DEPTH_TEST | Capabilities::SHADER_FLOAT16;
    let mut composer = Composer::default().with_capabilities(capabilities);
    let defs: HashMap<_, _> =
        program.defs.iter().map(|def| ((*def).to_owned(), ShaderDefValue::Bool(true))).collect();
    for name in LIBRARY {
        let WgslModule { path, text } = read_module(name);
        let module = ComposableModuleDescriptor {
            source: &text,
            file_path: &path,
            shader_defs: defs.clone(),
            ..ComposableModuleDescriptor::default()
        };
        if let Err(error) = composer.add_composable_module(module) {
            panic!("{}", error.emit_to_string(&composer));
        }
    }
    let WgslModule { path, mut text } = read_module(program.module);
    if program.defs.contains(&"HALF") {
        // Directives come before everything else, even before preprocessor conditions.
        text.insert_str(0, "enable f16;\n");
    }
    let module = composer.make_naga_module(NagaModuleDescriptor {
        source: &text,
        file_path: &path,
        shader_type: ShaderType::Wgsl,
        shader_defs: defs,
        ..NagaModuleDescriptor::default()
    });
    let mut module = module.unwrap_or_else(|error| panic!("{}", error.emit_to_string(&composer)));
    if program.counts {
        counting::count_fetches_and_turns(&mut module);
    }
    // The fast path in single precision is for desktops, whose drivers know better when to unroll.
    let unrolling = match program.module == "fast" && !program.defs.contains(&"HALF") {
        true => LoopUnrolling::Allowed,
        false => LoopUnrolling::Forbidden,
    };
    words::postprocess_spirv(&write_spirv(&module, program, capabilities), unrolling)
}

fn write_spirv(
    module: &naga::Module,
    program: &ShaderVariant,
    capabilities: Capabilities,
) -> Vec<u32> {
    let name = &program.name;
    let mut validator = Validator::new(ValidationFlags::all(), capabilities);
    let info = validator.validate(module).unwrap_or_else(|error| panic!("{name}: {error:?}"));
    let overrides = program.overrides.iter().map(|(key, value)| ((*key).to_owned(), *value));
    let entry = match program.stage {
        naga::ShaderStage::Vertex => "vertex",
        naga::ShaderStage::Compute => "compute",
        _ => "fragment",
    };
    let (module, info) = naga::back::pipeline_constants::process_overrides(
        module,
        &info,
        Some((program.stage, entry)),
        &overrides.collect(),
    )
    .unwrap_or_else(|error| panic!("{name}: {error}"));
    let unchecked = naga::proc::BoundsCheckPolicy::Unchecked;
    let options = spv::Options {
        lang_version: (1, 3),
        flags: spv::WriterFlags::empty(),
        fake_missing_bindings: false,
        binding_map: (0..BINDING_COUNT).map(same_binding).collect(),
        capabilities: None,
        // The programs keep their indices in range themselves.
        bounds_check_policies: naga::proc::BoundsCheckPolicies {
            index: unchecked,
            buffer: unchecked,
            image_load: unchecked,
            binding_array: unchecked,
        },
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
        force_loop_bounding: false,
        use_storage_input_output_16: false,
        emit_int_div_checks: false,
        debug_info: None,
        ..spv::Options::default()
    };
    let pipeline =
        spv::PipelineOptions { shader_stage: program.stage, entry_point: entry.to_owned() };
    spv::write_vec(&module, &info, &options, Some(&pipeline))
        .unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Maps a binding of WGSL's group 0 to the same binding of descriptor set 0.
fn same_binding(binding: u32) -> (naga::ResourceBinding, spv::BindingInfo) {
    let info = spv::BindingInfo { descriptor_set: 0, binding, binding_array_size: None };
    (naga::ResourceBinding { group: 0, binding }, info)
}

/// A module of WGSL.
struct WgslModule {
    path: String,
    text: String,
}

/// Reads a module; the text of `constants` is generated.
fn read_module(name: &str) -> WgslModule {
    if name == "constants" {
        return WgslModule { path: "constants.wgsl".into(), text: shared::constants_module() };
    }
    let path = format!("wgsl/{name}.wgsl");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    WgslModule { path, text }
}
