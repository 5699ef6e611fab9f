//! One run of the command: its cancel flag, its progress bar, its files.

use crate::args::InputArgs;
use crate::failure::Failure;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use polder_io::{Input, InputFormat, MeshFile, MeshFormat, Source};
use std::fs::File;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Standard input or output.
pub(crate) const DASH: &str = "-";

/// What all commands share.
pub(crate) struct Job {
    pub(crate) cancel: Arc<AtomicBool>,
    pub(crate) quiet: bool,
    bar: ProgressBar,
}

impl Job {
    /// Begins: Ctrl-C sets the cancel flag from now on, and a second one ends at once. The bar shows after a second,
    /// on a terminal only.
    pub(crate) fn begin(quiet: bool) -> Self {
        let cancel = Arc::new(AtomicBool::new(false));
        let flag = cancel.clone();
        // Without a handler Ctrl-C ends the process as it always did.
        let _ = ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::Relaxed) {
                std::process::exit(4);
            }
        });
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        if !quiet && io::stderr().is_terminal() {
            let later = bar.clone();
            std::thread::spawn(move || {
                std::thread::sleep(Duration::from_secs(1));
                if !later.is_finished() {
                    later.set_draw_target(ProgressDrawTarget::stderr());
                    later.enable_steady_tick(Duration::from_millis(100));
                }
            });
        }
        Self { cancel, quiet, bar }
    }

    /// Work of unknown length.
    pub(crate) fn stage(&self, name: &str) {
        self.bar.set_style(style("{spinner} {msg} {elapsed}"));
        self.bar.set_message(name.to_owned());
    }

    /// A callback that shows how far the library is.
    pub(crate) fn progress(&self) -> polder::ProgressFn {
        let bar = self.bar.clone();
        let measured = style("{spinner} {msg:<16} {bar:40} {percent:>3}% {elapsed}");
        Arc::new(move |progress| {
            if bar.length() != Some(progress.total) {
                bar.set_style(measured.clone());
                bar.set_length(progress.total);
            }
            if bar.message() != progress.stage {
                bar.set_message(progress.stage);
            }
            bar.set_position(progress.done.min(progress.total));
        })
    }

    /// Takes the bar away, so that something else can be said.
    pub(crate) fn done(&self) {
        self.bar.finish_and_clear();
    }

    /// A line for people, on standard error.
    pub(crate) fn say(&self, line: &str) {
        if !self.quiet {
            self.bar.suspend(|| eprintln!("{line}"));
        }
    }

    fn source(&self, path: &Path) -> Result<Source, Failure> {
        let source =
            if path == Path::new(DASH) { Source::new(io::stdin(), "standard input") } else { Source::open(path)? };
        Ok(source.with_cancel(Some(self.cancel.clone())))
    }

    /// Reads an input.
    pub(crate) fn read(&self, args: &InputArgs) -> Result<Input, Failure> {
        self.stage("reading");
        let format = format_of(&args.input, args.from, InputFormat::of, "--from", "node, poly or pslg");
        Ok(Input::read_from(self.source(&args.input)?, format)?)
    }

    /// Reads a mesh.
    pub(crate) fn read_mesh(&self, path: &Path, from: Option<MeshFormat>) -> Result<MeshFile, Failure> {
        self.stage("reading");
        let format = format_of(path, from, MeshFormat::of, "--mesh-from", "ele, tri, obj, ply or vtk");
        Ok(MeshFile::read_from(self.source(path)?, format)?)
    }

    /// Writes some files: all of them whole, or none.
    pub(crate) fn write(&self, files: &[(PathBuf, &WriteTo<'_>)]) -> Result<(), Failure> {
        self.stage("writing");
        let mut ready = Vec::new();
        for (path, write) in files {
            let mut target = Target::create(path).map_err(|e| Failure::io(path, &e))?;
            let mut out = Cancellable { out: target.writer(), cancel: &self.cancel };
            let written = write(&mut out).and_then(|()| out.flush());
            if let Err(error) = written {
                return Err(match self.cancel.load(Ordering::Relaxed) {
                    true => Failure::new("cancelled", format!("cancelled while writing {}", path.display())),
                    false => Failure::io(path, &error),
                });
            }
            ready.push((path, target));
        }
        ready.into_iter().try_for_each(|(path, target)| target.commit().map_err(|e| Failure::io(path, &e)))
    }
}

/// What writes a file's content.
pub(crate) type WriteTo<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// The format that was asked for, or that the extension says; a usage error if neither does.
pub(crate) fn format_of<T>(
    path: &Path,
    asked: Option<T>,
    by_extension: impl Fn(&Path) -> Option<T>,
    flag: &str,
    formats: &str,
) -> T {
    asked.or_else(|| by_extension(path)).unwrap_or_else(|| {
        let message = if path == Path::new(DASH) {
            format!("{flag} must say the format of -: {formats}")
        } else {
            format!("the extension of {} says no format; {flag} can: {formats}", path.display())
        };
        usage(&message)
    })
}

/// Ends with a usage error.
pub(crate) fn usage(message: &str) -> ! {
    use clap::CommandFactory;
    let mut command = crate::args::Cli::command();
    command.build();
    // With the usage of the subcommand that was asked for.
    let named = std::env::args().find(|arg| command.find_subcommand(arg).is_some());
    if let Some(subcommand) = named.and_then(|name| command.find_subcommand(name).cloned()) {
        command = subcommand;
    }
    command.error(clap::error::ErrorKind::ValueValidation, message).exit()
}

/// Where an output goes before it is whole.
enum Target {
    Stdout(io::Stdout),
    /// A device or pipe, which cannot be replaced.
    Device(File),
    File {
        temporary: tempfile::NamedTempFile,
        path: PathBuf,
    },
}

impl Target {
    fn create(path: &Path) -> io::Result<Self> {
        if path == Path::new(DASH) {
            return Ok(Self::Stdout(io::stdout()));
        }
        let meta = std::fs::metadata(path);
        if meta.as_ref().is_ok_and(|meta| meta.is_dir()) {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        if meta.is_ok_and(|meta| !meta.is_file()) {
            return Ok(Self::Device(File::options().write(true).open(path)?));
        }
        // What a link points to is replaced, not the link.
        let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        builder.prefix(".polder-");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // Errors without the name of the temporary file, which says nothing to anybody.
        std::fs::metadata(folder)?;
        let plain = |e: io::Error| io::Error::from(e.kind());
        Ok(Self::File { temporary: builder.tempfile_in(folder).map_err(plain)?, path })
    }

    fn writer(&mut self) -> &mut dyn Write {
        match self {
            Self::Stdout(out) => out,
            Self::Device(file) => file,
            Self::File { temporary, .. } => temporary,
        }
    }

    fn commit(self) -> io::Result<()> {
        match self {
            Self::File { temporary, path } => temporary.persist(path).map(|_| ()).map_err(|e| e.error),
            Self::Stdout(_) | Self::Device(_) => Ok(()),
        }
    }
}

/// Fails once the cancel flag is set.
struct Cancellable<'a> {
    out: &'a mut dyn Write,
    cancel: &'a AtomicBool,
}

impl Write for Cancellable<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.cancel.load(Ordering::Relaxed) {
            return Err(io::Error::other("cancelled"));
        }
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
