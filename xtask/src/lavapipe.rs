//! A Vulkan device for every machine: lavapipe, Mesa's Vulkan on the CPU, and the validation layer.
//!
//! Taken if installed; installed with apt if that is allowed; else its packages are unpacked under `target/lavapipe`,
//! which asks for no privilege, and the loader is pointed there.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

const PACKAGES: [&str; 3] = ["mesa-vulkan-drivers", "libvulkan1", "vulkan-validationlayers"];
const LAYER: &str = "VkLayer_khronos_validation.json";

/// What a program needs in its environment to find a device.
pub(crate) type Environment = Vec<(&'static str, OsString)>;

/// The device that `POLDER_DEVICE` names, as it is; else lavapipe, prepared.
pub(crate) fn prepare(root: &Path) -> Result<Environment, String> {
    if std::env::var_os("POLDER_DEVICE").is_some_and(|name| !name.is_empty()) {
        return Ok(Vec::new());
    }
    if let Some(environment) = installed() {
        return Ok(environment);
    }
    if is_root() {
        eprintln!("lavapipe: installing {}", PACKAGES.join(", "));
        match install() {
            Ok(()) => match installed() {
                Some(environment) => return Ok(environment),
                None => eprintln!("lavapipe: installed, and yet not found"),
            },
            Err(why) => eprintln!("lavapipe: not installed: {why}"),
        }
    }
    unpacked(root).map_err(|why| {
        format!("no lavapipe: {why}. Install {}, or name a Vulkan device in POLDER_DEVICE", PACKAGES.join(", "))
    })
}

/// `export` lines for a shell.
pub(crate) fn print(root: &Path) -> Result<(), String> {
    for (name, value) in prepare(root)? {
        println!("export {name}='{}'", value.to_string_lossy());
    }
    Ok(())
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|id| String::from_utf8_lossy(&id.stdout).trim() == "0")
}

/// lavapipe's driver and the layer where a system keeps them.
fn installed() -> Option<Environment> {
    let folders = ["/usr/share/vulkan", "/usr/local/share/vulkan", "/etc/vulkan"].map(PathBuf::from);
    let driver = folders.iter().find_map(|folder| driver_in(&folder.join("icd.d")))?;
    let loader =
        ["/usr/lib", "/usr/lib64", "/lib", "/usr/local/lib"].iter().any(|folder| holds_loader(Path::new(folder)));
    let layer = folders.iter().any(|folder| folder.join("explicit_layer.d").join(LAYER).is_file());
    (loader && layer).then(|| with_driver(&driver))
}

fn with_driver(driver: &Path) -> Environment {
    // Loaders before 1.3.207 know the second name only.
    let driver = OsString::from(driver);
    vec![("VK_DRIVER_FILES", driver.clone()), ("VK_ICD_FILENAMES", driver), ("POLDER_DEVICE", "lavapipe".into())]
}

fn driver_in(folder: &Path) -> Option<PathBuf> {
    let mut found: Vec<PathBuf> = std::fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path()).collect();
    found.sort();
    let named = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("lvp_icd"));
    found.into_iter().find(named)
}

/// The loader in a folder of libraries, or in one of a kind of machine inside.
fn holds_loader(folder: &Path) -> bool {
    library_folders(folder).iter().any(|folder| folder.join("libvulkan.so.1").exists())
}

fn library_folders(folder: &Path) -> Vec<PathBuf> {
    let inside = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let inside = inside.filter(|path| path.is_dir() && path.to_string_lossy().contains("-linux-"));
    std::iter::once(folder.to_path_buf()).chain(inside).collect()
}

fn install() -> Result<(), String> {
    let apt = || {
        let mut command = Command::new("apt-get");
        command.args(["install", "--yes", "--no-install-recommends"]).args(PACKAGES);
        command.env("DEBIAN_FRONTEND", "noninteractive");
        output(command)
    };
    // A fresh machine knows no packages yet.
    apt().or_else(|_| {
        let mut update = Command::new("apt-get");
        update.arg("update");
        output(update).and_then(|_| apt())
    })?;
    Ok(())
}

fn output(mut command: Command) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let done = command.output().map_err(|error| format!("{name}: {error}"))?;
    if done.status.success() {
        return Ok(String::from_utf8_lossy(&done.stdout).into_owned());
    }
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    Err(format!("{name}: {}", said.lines().last().unwrap_or("failed without a word")))
}

/// The packages, and those that they need and the machine has not, unpacked.
fn unpacked(root: &Path) -> Result<Environment, String> {
    let home = root.join("target").join("lavapipe");
    let tree = home.join("tree");
    let driver = home.join("lvp_icd.json");
    if !driver.is_file() {
        fetch(&home.join("packages"), &tree)?;
        rewrite_driver(&tree, &driver)?;
    }
    let mut environment = with_driver(&driver);
    environment.push(("VK_LAYER_PATH", tree.join("usr/share/vulkan/explicit_layer.d").into()));
    let mut libraries: Vec<PathBuf> = library_folders(&tree.join("usr/lib"));
    libraries.extend(library_folders(&tree.join("lib")));
    let known = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    libraries.extend(std::env::split_paths(&known).filter(|path| !path.as_os_str().is_empty()));
    environment.push(("LD_LIBRARY_PATH", std::env::join_paths(libraries).map_err(|error| error.to_string())?));
    Ok(environment)
}

fn fetch(packages: &Path, tree: &Path) -> Result<(), String> {
    for folder in [packages, tree] {
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let mut list = Command::new("apt-get");
    list.args(["install", "--print-uris", "--quiet", "--yes", "--no-install-recommends"]).args(PACKAGES);
    let missing = missing_packages(&output(list)?);
    // Of installed ones nothing is listed, though they may lie where the loader does not look.
    let mut names: Vec<String> = PACKAGES.map(str::to_owned).to_vec();
    names.extend(missing.into_iter().filter(|name| !PACKAGES.contains(&name.as_str())));
    eprintln!("lavapipe: unpacking {} packages under {}", names.len(), tree.display());
    let mut download = Command::new("apt-get");
    download.current_dir(packages).args(["download", "--quiet"]).args(&names);
    output(download)?;
    let entries = std::fs::read_dir(packages).map_err(|error| format!("{}: {error}", packages.display()))?;
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.extension().is_some_and(|found| found == "deb") {
            let mut unpack = Command::new("dpkg-deb");
            unpack.arg("-x").arg(&path).arg(tree);
            output(unpack)?;
        }
    }
    Ok(())
}

/// The names in apt's list of what it would fetch: `'http://...' name_version_machine.deb size hash`.
fn missing_packages(list: &str) -> Vec<String> {
    let file = |line: &str| line.strip_prefix('\'')?.split_whitespace().nth(1).map(str::to_owned);
    list.lines().filter_map(file).filter_map(|file| file.split_once('_').map(|(name, _)| name.to_owned())).collect()
}

/// The driver's description, with the place where its library lies now.
fn rewrite_driver(tree: &Path, to: &Path) -> Result<(), String> {
    let folder = tree.join("usr/share/vulkan/icd.d");
    let from = driver_in(&folder).ok_or(format!("no driver in {}", folder.display()))?;
    let text = std::fs::read_to_string(&from).map_err(|error| format!("{}: {error}", from.display()))?;
    let place = quoted_after(&text, "\"library_path\"").ok_or(format!("{} names no library", from.display()))?;
    let name = Path::new(place).file_name().unwrap_or_default();
    let library = library_folders(&tree.join("usr/lib")).into_iter().map(|folder| folder.join(name));
    let library = library.into_iter().find(|path| path.is_file());
    let library = library.ok_or(format!("no {} in {}", place, tree.display()))?;
    let text = text.replace(&format!("\"{place}\""), &format!("\"{}\"", library.display()));
    std::fs::write(to, text).map_err(|error| format!("{}: {error}", to.display()))
}

fn quoted_after<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    text.split_once(key)?.1.split('"').nth(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_a_list_of_apt() {
        let list = "Reading package lists...\n\
                    'http://deb.debian.org/debian/pool/main/m/mesa/a.deb' mesa-vulkan-drivers_22.3.6-1_amd64.deb 1 SHA256:0\n\
                    'http://deb.debian.org/x.deb' libllvm15_1%3a15.0.6-4+b1_amd64.deb 2 SHA256:1\n";
        assert_eq!(missing_packages(list), ["mesa-vulkan-drivers", "libllvm15"]);
    }

    #[test]
    fn the_library_of_a_driver() {
        let text = "{ \"ICD\": { \"api_version\": \"1.3.230\", \"library_path\": \"/usr/lib/libvulkan_lvp.so\" } }";
        assert_eq!(quoted_after(text, "\"library_path\""), Some("/usr/lib/libvulkan_lvp.so"));
    }
}
