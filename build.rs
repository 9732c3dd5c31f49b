//! Validates every shader with naga and writes what Rust needs to know of it to `shaders.rs`:
//! its text, its workgroup size, its bindings and the layout of its parameters. Shaders and
//! parameter structs therefore cannot drift apart: a mismatch does not compile.

use naga::proc::Layouter;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::fmt::Write;
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=shaders");
    println!("cargo::rerun-if-changed=build.rs");
    let root = Path::new("shaders");
    let mut files = Vec::new();
    collect(root, &mut files);
    files.sort();
    let (shared, view) = (root.join("shared"), root.join("view"));
    let mut generated = String::new();
    for file in files.iter().filter(|file| !file.starts_with(&shared)) {
        let code = match file.starts_with(&view) {
            true => drawing(root, file),
            false => reflect(root, file),
        };
        match code {
            Ok(code) => generated += &code,
            Err(message) => {
                for line in message.lines() {
                    println!("cargo::error={line}");
                }
            }
        }
    }
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    std::fs::write(out.join("shaders.rs"), generated).expect("OUT_DIR is writable");
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the folder shaders/ is there") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path
            .extension()
            .is_some_and(|extension| extension == "wgsl")
        {
            files.push(path);
        }
    }
}

/// Where each line of an expanded shader came from.
type Origins = Vec<(PathBuf, usize)>;

/// Replaces every line `#import NAME` by the text of `shaders/shared/NAME.wgsl`, once each.
fn expand(
    root: &Path,
    file: &Path,
    done: &mut Vec<PathBuf>,
    text: &mut String,
    from: &mut Origins,
) {
    if done.iter().any(|seen| seen == file) {
        return;
    }
    done.push(file.to_path_buf());
    let source = std::fs::read_to_string(file)
        .unwrap_or_else(|error| panic!("cannot read {}: {error}", file.display()));
    for (number, line) in source.lines().enumerate() {
        match line.strip_prefix("#import ") {
            Some(name) => {
                let imported = root.join("shared").join(format!("{}.wgsl", name.trim()));
                expand(root, &imported, done, text, from);
            }
            None => {
                text.push_str(line);
                text.push('\n');
                from.push((file.to_path_buf(), number + 1));
            }
        }
    }
}

fn name(file: &Path) -> &str {
    let stem = file.file_stem().and_then(|stem| stem.to_str());
    stem.expect("shader names are ASCII")
}

/// A shader that draws: `static DRAW_NAME: &str`, with the entry points `place` and `paint`.
fn drawing(root: &Path, file: &Path) -> Result<String, String> {
    let (source, module) = validated(root, file)?;
    let entries = module.entry_points.iter().map(|entry| &entry.name[..]);
    let mut entries: Vec<&str> = entries.collect();
    entries.sort_unstable();
    if entries != ["paint", "place"] {
        let file = file.display();
        return Err(format!(
            "{file}: its entry points must be `place` and `paint`"
        ));
    }
    let upper = name(file).to_uppercase();
    let glsl = match IN_BROWSERS.contains(&name(file)) {
        true => format!(
            "pub static GLSL_{upper}: [&str; 2] = {:?};\n",
            glsl(&source)?
        ),
        false => String::new(),
    };
    Ok(format!(
        "pub static DRAW_{upper}: &str = {source:?};\n{glsl}"
    ))
}

/// The shaders that browsers without WebGPU draw with.
const IN_BROWSERS: [&str; 3] = ["capsule", "cuboid", "ground"];
/// What is other there: processors may have to do it, and what is written is not encoded.
const FOR_WEBGL: [[&str; 2]; 2] = [
    ["const TAPS = 16u;", "const TAPS = 4u;"],
    ["const ENCODES = false;", "const ENCODES = true;"],
];

/// A shader that draws, in WebGL's language: `place`, then `paint`.
fn glsl(source: &str) -> Result<[String; 2], String> {
    use naga::back::glsl;
    let mut source = source.to_string();
    for [from, to] in FOR_WEBGL {
        if !source.contains(from) {
            return Err(format!("it has no `{from}` to be changed for WebGL"));
        }
        source = source.replace(from, to);
    }
    let module = naga::front::wgsl::parse_str(&source).map_err(|error| error.to_string())?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator
        .validate(&module)
        .map_err(|error| error.to_string())?;
    let options = glsl::Options {
        version: glsl::Version::new_gles(300),
        writer_flags: glsl::WriterFlags::empty(),
        ..Default::default()
    };
    let stage = |shader_stage, entry_point: &str| {
        let pipeline = glsl::PipelineOptions {
            shader_stage,
            entry_point: entry_point.to_string(),
            multiview: None,
        };
        let mut text = String::new();
        let bounds = naga::proc::BoundsCheckPolicies::default();
        let writer = glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, bounds);
        let written = writer.and_then(|mut writer| writer.write());
        written.map_err(|error| error.to_string())?;
        Ok::<_, String>(text)
    };
    Ok([
        stage(naga::ShaderStage::Vertex, "place")?,
        stage(naga::ShaderStage::Fragment, "paint")?,
    ])
}

/// The expanded text, parsed and found right.
fn validated(root: &Path, file: &Path) -> Result<(String, naga::Module), String> {
    let (mut source, mut from) = (String::new(), Origins::new());
    expand(root, file, &mut Vec::new(), &mut source, &mut from);
    let place = |line: u32| {
        let (path, line) = &from[(line as usize).saturating_sub(1).min(from.len() - 1)];
        format!("{}:{line}", path.display())
    };
    let module = naga::front::wgsl::parse_str(&source).map_err(|error| {
        let line = error.location(&source).map_or(1, |at| at.line_number);
        format!("{}: {}", place(line), error.emit_to_string(&source))
    })?;
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| {
            let line = error.location(&source).map_or(1, |at| at.line_number);
            format!("{}: {}", place(line), error.emit_to_string(&source))
        })?;
    Ok((source, module))
}

/// A compute shader: what `describe` says of its only entry point.
fn reflect(root: &Path, file: &Path) -> Result<String, String> {
    let (source, module) = validated(root, file)?;
    let name = name(file);
    let [entry] = &module.entry_points[..] else {
        return Err(format!("{}: one entry point a file", file.display()));
    };
    if entry.name != name {
        return Err(format!(
            "{}: its entry point must be called `{name}`",
            file.display()
        ));
    }
    describe(name, &source, &module, entry.workgroup_size)
        .map_err(|why| format!("{}: {why}", file.display()))
}

/// Rust code: `static NAME: Shader` and `mod name { workgroup, parameter layout, constants }`.
fn describe(
    name: &str,
    source: &str,
    module: &naga::Module,
    workgroup: [u32; 3],
) -> Result<String, String> {
    let mut buffers = Vec::new();
    let mut uniform = None;
    for (_, variable) in module.global_variables.iter() {
        let Some(binding) = &variable.binding else {
            continue;
        };
        match variable.space {
            naga::AddressSpace::Storage { .. } => buffers.push(binding.binding),
            naga::AddressSpace::Uniform => uniform = Some((binding.binding, variable.ty)),
            _ => {}
        }
    }
    buffers.sort_unstable();
    let count = buffers.len() as u32;
    if buffers != (0..count).collect::<Vec<_>>() {
        return Err(format!(
            "storage bindings must be 0..{count} without a gap, found {buffers:?}"
        ));
    }
    if count > 8 {
        return Err(format!(
            "{count} storage buffers; WebGPU's default limit is 8"
        ));
    }
    if workgroup.iter().product::<u32>() > 256 {
        return Err(format!(
            "workgroup {workgroup:?} exceeds WebGPU's 256 invocations"
        ));
    }
    let mut layout = String::new();
    let mut size = 0;
    if let Some((binding, handle)) = uniform {
        if binding != count {
            return Err(format!(
                "the uniform must be the last binding, {count}, not {binding}"
            ));
        }
        let mut layouter = Layouter::default();
        layouter
            .update(module.to_ctx())
            .map_err(|error| error.to_string())?;
        let naga::TypeInner::Struct { members, span } = &module.types[handle].inner else {
            return Err("the uniform must be a struct".into());
        };
        size = *span;
        for member in members {
            let kind = match module.types[member.ty].inner {
                naga::TypeInner::Scalar(naga::Scalar::U32) => "u32",
                naga::TypeInner::Scalar(naga::Scalar::I32) => "i32",
                naga::TypeInner::Scalar(naga::Scalar::F32) => "f32",
                _ => return Err("parameters are u32, i32 or f32 scalars".into()),
            };
            let field = member.name.as_deref().ok_or("unnamed parameter")?;
            let _ = writeln!(
                layout,
                "pub const fn {field}() -> super::super::Field {{ super::super::Field {{ offset: {}, kind: super::super::ParamKind::{} }} }}",
                member.offset,
                kind.to_uppercase()
            );
        }
        let _ = writeln!(layout, "pub const FIELDS: usize = {};", members.len());
    }
    let mut constants = String::new();
    for (_, constant) in module.constants.iter() {
        let Some(label) = &constant.name else {
            continue;
        };
        if let naga::Expression::Literal(naga::Literal::U32(value)) =
            module.global_expressions[constant.init]
        {
            let _ = writeln!(constants, "pub const {label}: u32 = {value};");
        }
    }
    let upper = name.to_uppercase();
    let [x, y, z] = workgroup;
    Ok(format!(
        "pub static {upper}: Shader = Shader {{ name: {name:?}, source: {source:?}, workgroup: [{x}, {y}, {z}], buffers: {count}, params: {size} }};\n\
         pub mod {name} {{ pub mod params {{ {layout} pub const SIZE: usize = {size}; }} pub mod constants {{ {constants} }} }}\n"
    ))
}
