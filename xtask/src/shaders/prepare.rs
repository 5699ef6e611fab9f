//! A shaderc library to link with: Debian's where it can be had, which takes seconds, else from source, which takes
//! minutes and needs cmake, python and a C++ compiler.
//!
//! Debian's `libshaderc_combined.a` lacks the parts of glslang and SPIRV-Tools that it calls; merged with them into one
//! archive it links.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const PARTS: [&str; 10] = [
    "shaderc_combined",
    "glslang",
    "MachineIndependent",
    "GenericCodeGen",
    "OGLCompiler",
    "OSDependent",
    "HLSL",
    "SPIRV",
    "SPIRV-Tools-opt",
    "SPIRV-Tools",
];
const PACKAGES: [&str; 3] = ["libshaderc-dev", "glslang-dev", "spirv-tools"];
/// How the run with the compiler learns which one it was built with.
const VERSION: &str = "POLDER_SHADERC_VERSION";

/// How to build this package with shaderc.
pub(super) struct Found {
    pub(super) feature: &'static str,
    pub(super) environment: Vec<(&'static str, OsString)>,
}

#[cfg(feature = "shaders")]
pub(super) fn version_in_use() -> String {
    std::env::var(VERSION).unwrap_or_else(|_| "shaderc of unknown version".to_owned())
}

fn folder(root: &Path) -> PathBuf {
    root.join("target").join("shaderc")
}

/// Whether a compiler can be had without asking anybody for it.
pub(super) fn at_hand(root: &Path) -> bool {
    let mut linker = Command::new("c++");
    linker.arg("--version").stdout(Stdio::null()).stderr(Stdio::null());
    let links = linker.status().is_ok_and(|status| status.success());
    let known = std::env::var_os("SHADERC_LIB_DIR").is_some();
    links && (known || prepared(root).is_some() || debian_parts(Path::new("/")).is_some())
}

fn prepared(root: &Path) -> Option<Found> {
    let folder = folder(root).join("lib");
    let version = std::fs::read_to_string(folder.join("version")).ok()?;
    folder.join("libshaderc_combined.a").is_file().then(|| Found {
        feature: "shaders",
        environment: vec![("SHADERC_LIB_DIR", folder.into()), (VERSION, version.trim().into())],
    })
}

/// Takes what is there; fetches Debian's packages otherwise; falls back on the sources of the crate.
pub(super) fn prepare(root: &Path) -> Result<Found, String> {
    if let Some(folder) = std::env::var_os("SHADERC_LIB_DIR") {
        let version = std::env::var(VERSION).unwrap_or_else(|_| "shaderc of SHADERC_LIB_DIR".to_owned());
        return Ok(Found {
            feature: "shaders",
            environment: vec![("SHADERC_LIB_DIR", folder), (VERSION, version.into())],
        });
    }
    if let Some(found) = prepared(root) {
        return Ok(found);
    }
    if let Some(parts) = debian_parts(Path::new("/")) {
        return merge(root, &parts);
    }
    let unpacked = folder(root).join("packages");
    match fetch(&unpacked) {
        Ok(()) => match debian_parts(&unpacked) {
            Some(parts) => return merge(root, &parts),
            None => eprintln!("shaders: Debian's packages do not hold the libraries that they should"),
        },
        Err(why) => eprintln!("shaders: no package of shaderc: {why}"),
    }
    eprintln!("shaders: building shaderc from source, which takes minutes and needs cmake, python3 and a C++ compiler");
    Ok(Found { feature: "shaders-from-source", environment: vec![(VERSION, "shaderc from source, crate 0.10".into())] })
}

/// The libraries of Debian's packages under a root, if all are there.
fn debian_parts(root: &Path) -> Option<Vec<PathBuf>> {
    let libraries = root.join("usr/lib");
    let mut folders = vec![libraries.clone()];
    folders.extend(std::fs::read_dir(&libraries).ok()?.flatten().map(|entry| entry.path()));
    folders.into_iter().find_map(|folder| {
        let parts: Vec<PathBuf> = PARTS.iter().map(|part| folder.join(format!("lib{part}.a"))).collect();
        parts.iter().all(|part| part.is_file()).then_some(parts)
    })
}

/// Downloads the packages and unpacks them, which needs no privilege.
fn fetch(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut download = Command::new("apt-get");
    download.current_dir(folder).arg("download").args(PACKAGES);
    quiet(download)?;
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.extension().is_some_and(|found| found == "deb") {
            let mut unpack = Command::new("dpkg-deb");
            unpack.arg("-x").arg(&path).arg(folder);
            quiet(unpack)?;
        }
    }
    Ok(())
}

fn quiet(mut command: Command) -> Result<(), String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let done = command.output().map_err(|error| format!("{name}: {error}"))?;
    if done.status.success() {
        Ok(())
    } else {
        Err(format!("{name}: {}", String::from_utf8_lossy(&done.stderr).trim()))
    }
}

/// One archive of all parts, in a folder that holds nothing else to link with.
fn merge(root: &Path, parts: &[PathBuf]) -> Result<Found, String> {
    let folder = folder(root).join("lib");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut script = String::from("CREATE libshaderc_combined.a\n");
    for part in parts {
        script.push_str(&format!("ADDLIB {}\n", part.display()));
    }
    script.push_str("SAVE\nEND\n");
    let mut command = Command::new("ar");
    let mut child = command
        .current_dir(&folder)
        .arg("-M")
        .stdin(Stdio::piped())
        .spawn()
        .map_err(|error| format!("ar (package binutils) could not be started: {error}"))?;
    if let Some(mut input) = child.stdin.take() {
        input.write_all(script.as_bytes()).map_err(|error| format!("ar: {error}"))?;
    }
    if !child.wait().map_err(|error| format!("ar: {error}"))?.success() {
        return Err("ar could not merge the libraries of shaderc".to_owned());
    }
    let version = debian_version().unwrap_or_else(|| "of unknown version".to_owned());
    std::fs::write(folder.join("version"), format!("libshaderc {version}\n")).map_err(|error| error.to_string())?;
    prepared(root).ok_or("shaderc could not be prepared".to_owned())
}

fn debian_version() -> Option<String> {
    let installed = Command::new("dpkg-query").args(["-W", "-f", "${Version}", "libshaderc-dev"]).output().ok()?;
    let text = String::from_utf8(installed.stdout).ok()?;
    if installed.status.success() && !text.trim().is_empty() {
        return Some(text.trim().to_owned());
    }
    let known = Command::new("apt-cache").args(["policy", "libshaderc-dev"]).output().ok()?;
    let text = String::from_utf8(known.stdout).ok()?;
    text.lines().find_map(|line| line.trim().strip_prefix("Candidate:").map(|version| version.trim().to_owned()))
}
