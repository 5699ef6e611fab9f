//! GLSL to SPIR-V by shaderc.

use super::sources::{NO_FLOAT64, Source, resolve};
use std::path::{Path, PathBuf};

/// shaderc, and what it is called in `kernels.rs`.
pub(super) struct Compiler {
    pub(super) name: String,
}

impl Compiler {
    pub(super) fn new(version: &str) -> Self {
        let (spirv, revision) = shaderc::get_spirv_version();
        Compiler { name: format!("{version}, SPIR-V {}.{} revision {revision}", spirv >> 16, (spirv >> 8) & 0xff) }
    }

    /// Compiles for Vulkan 1.3, optimized, names kept and source lines not. SPIR-V 1.5: what 1.6 brought serves no kernel
    /// here, and its way to give the size of a workgroup is not known to rspirv. `second` is for devices without f64.
    pub(super) fn compile(&self, root: &Path, source: &Source, second: bool) -> Result<Vec<u32>, String> {
        let name = source.path.strip_prefix(root).unwrap_or(&source.path).to_string_lossy().replace('\\', "/");
        let failed = |error: shaderc::Error| format!("{name}: {error}");
        let text = std::fs::read_to_string(&source.path).map_err(|error| format!("{name}: {error}"))?;
        let compiler = shaderc::Compiler::new().map_err(failed)?;
        let mut options = shaderc::CompileOptions::new().map_err(failed)?;
        options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_3 as u32);
        options.set_target_spirv(shaderc::SpirvVersion::V1_5);
        options.set_optimization_level(shaderc::OptimizationLevel::Performance);
        // shaderc drops every name without this; lines and sources are cut out below.
        options.set_generate_debug_info();
        options.set_warnings_as_errors();
        if second {
            options.add_macro_definition(NO_FLOAT64, None);
        }
        options.set_include_callback(|wanted, _, from, _| {
            let from = root.join(PathBuf::from(from));
            let found = resolve(root, &from, wanted).ok_or(format!("there is no \"{wanted}\" to include"))?;
            let content = std::fs::read_to_string(&found).map_err(|error| format!("{}: {error}", found.display()))?;
            let resolved_name = found.strip_prefix(root).unwrap_or(&found).to_string_lossy().replace('\\', "/");
            Ok(shaderc::ResolvedInclude { resolved_name, content })
        });
        let kind = shaderc::ShaderKind::Compute;
        let done = compiler.compile_into_spirv(&text, kind, &name, "main", Some(&options)).map_err(failed)?;
        Ok(without_lines(done.as_binary()))
    }
}

/// The module without its sources, strings and lines: they say where it was compiled, and are most of its size.
fn without_lines(words: &[u32]) -> Vec<u32> {
    const DROPPED: [u32; 7] = [2, 3, 4, 7, 8, 317, 330];
    let (header, mut rest) = words.split_at(5);
    let mut kept = header.to_vec();
    while let Some(first) = rest.first() {
        let (instruction, after) = rest.split_at((first >> 16) as usize);
        if !DROPPED.contains(&(first & 0xffff)) {
            kept.extend_from_slice(instruction);
        }
        rest = after;
    }
    kept
}
