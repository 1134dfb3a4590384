//! Files that tasks write: whole or not at all, never over an input, never two to one place.

use std::fs::{self, OpenOptions, Permissions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use same_file::Handle;
use tempfile::NamedTempFile;

use crate::failure::Failure;
use crate::format::Format;
use crate::load;
use crate::text;
use umbra_selftest::Stream;

/// Checks the destinations of a task before any work is done. It holds files open: drop it before they are replaced.
pub struct Destinations<'a> {
    inputs: Vec<&'a Path>,
    taken: Vec<Identity>,
}

/// A file, whichever path leads to it.
#[derive(PartialEq)]
enum Identity {
    Existing(Handle),
    /// A pipe or a device, or a file that is not there yet: its path without links.
    Path(PathBuf),
}

impl<'a> Destinations<'a> {
    /// Takes the inputs, and the standard output: where that goes to a file, it is a destination like others. The standard input can be
    /// read once.
    pub fn beside(inputs: impl IntoIterator<Item = &'a PathBuf>) -> Result<Self, Failure> {
        let inputs: Vec<&Path> = inputs.into_iter().map(PathBuf::as_path).collect();
        if inputs.iter().filter(|input| load::is_dash(input)).count() > 1 {
            return Err(Failure::Usage { what: "- is given twice: the standard input can be read once".to_owned() });
        }
        let stdout =
            Handle::stdout().ok().filter(|stream| stream.as_file().metadata().is_ok_and(|metadata| metadata.is_file()));
        let mut all = Self { inputs, taken: Vec::new() };
        if let Some(stdout) = stdout {
            all.take(Path::new(text::STDOUT), Identity::Existing(stdout))?;
        }
        Ok(all)
    }

    /// Adds a destination. It can be written to, is neither an input nor one of those before, and no file whose name is of another
    /// format.
    pub fn add(&mut self, file: &Path, format: Format) -> Result<Destination, Failure> {
        let opened = Target::find(file);
        let file = if load::is_dash(file) { Path::new(text::STDOUT) } else { file };
        let failed = Failure::file(file, "write");
        let (target, identity) = opened.map_err(&failed)?;
        self.take(file, identity)?;
        if let Target::File { path, .. } = &target {
            if let Some(objection) = format.objection(file) {
                return Err(Failure::Format { file: file.into(), objection });
            }
            // Whether the folder takes a file shows when one is made. This one goes at once.
            part(path).map_err(failed)?;
        }
        Ok(Destination { file: file.into(), target })
    }

    pub fn add_any(&mut self, file: Option<&PathBuf>, format: Format) -> Result<Option<Destination>, Failure> {
        file.map(|file| self.add(file, format)).transpose()
    }

    fn take(&mut self, file: &Path, identity: Identity) -> Result<(), Failure> {
        let clash = |with| Err(Failure::Clash { file: file.into(), with });
        if let Identity::Existing(handle) = &identity {
            // A pipe is not opened: closing it again would break it for whoever writes to it.
            let is_file = |input: &Path| fs::metadata(input).is_ok_and(|metadata| metadata.is_file());
            let opened = |input: &Path| match input {
                stdin if load::is_dash(stdin) => Handle::stdin().ok(),
                path => is_file(path).then(|| Handle::from_path(path).ok())?,
            };
            let is_same = |input: &&Path| opened(input).is_some_and(|opened| opened == *handle);
            if self.inputs.iter().any(is_same) {
                return clash("an input");
            }
        }
        if self.taken.contains(&identity) {
            return clash("where another output goes");
        }
        // It takes any number of outputs.
        if identity != Identity::Path("/dev/null".into()) {
            self.taken.push(identity);
        }
        Ok(())
    }
}

/// The destination of an output.
pub struct Destination {
    file: PathBuf,
    target: Target,
}

enum Target {
    /// A regular file, or none yet: what is written replaces it when it is whole.
    File {
        path: PathBuf,
        permissions: Option<Permissions>,
    },
    Stdout,
    /// A pipe or a device, which has no contents to keep.
    Stream,
}

impl Target {
    fn find(file: &Path) -> io::Result<(Self, Identity)> {
        // By these names. A file that the shell opened as the standard output is where that goes, and no second output.
        if load::is_dash(file)
            || ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| file == Path::new(name))
        {
            return Ok((Self::Stdout, Identity::Path("/dev/stdout".into())));
        }
        match fs::metadata(file) {
            Ok(metadata) if metadata.is_dir() => Err(ErrorKind::IsADirectory.into()),
            Ok(metadata) if metadata.is_file() => {
                // Opened for writing, though it will be replaced: a write-protected file is to stay.
                let handle = Handle::from_file(OpenOptions::new().write(true).open(file)?)?;
                let target = Self::File { path: resolved(file)?, permissions: Some(metadata.permissions()) };
                Ok((target, Identity::Existing(handle)))
            }
            Ok(_) => Ok((Self::Stream, Identity::Path(resolved(file)?))),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let path = resolved(file)?;
                let identity = Identity::Path(same_case(&path));
                Ok((Self::File { path, permissions: None }, identity))
            }
            Err(error) => Err(error),
        }
    }
}

/// The path at the end of symbolic links, whether there is a file or not. Its folder has to exist.
fn resolved(file: &Path) -> io::Result<PathBuf> {
    /// The number of links that Linux follows.
    const LINKS: usize = 40;
    let folder =
        |path: &Path| path.parent().filter(|parent| *parent != Path::new("")).unwrap_or(Path::new(".")).to_owned();
    let mut path = file.to_owned();
    for _ in 0..LINKS {
        let Ok(next) = fs::read_link(&path) else { break };
        path = folder(&path).join(next);
    }
    let name = path.file_name().filter(|name| {
        // With a slash or a dot behind the name it is a folder.
        path.as_os_str().as_encoded_bytes().ends_with(name.as_encoded_bytes())
    });
    Ok(folder(&path).canonicalize()?.join(name.ok_or(ErrorKind::IsADirectory)?))
}

/// The path in lower case on systems whose file names usually ignore case.
fn same_case(path: &Path) -> PathBuf {
    if cfg!(any(windows, target_vendor = "apple")) { path.to_string_lossy().to_lowercase().into() } else { path.into() }
}

/// A temporary file in the folder of a path. It is removed when it is dropped.
fn part(path: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix("umbra-").suffix(".part");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // Less what the umask takes away.
    builder.tempfile_in(path.parent().unwrap_or(Path::new(".")))
}

impl Destination {
    /// The path as it was given.
    pub(crate) fn file(&self) -> &Path {
        &self.file
    }

    /// Says whether it is the standard output, where nothing else is to be then.
    pub(crate) const fn is_stdout(&self) -> bool {
        matches!(self.target, Target::Stdout)
    }

    /// Says whether it is a file, which is there once it is written.
    pub(crate) const fn is_file(&self) -> bool {
        matches!(self.target, Target::File { .. })
    }

    /// Begins an output.
    pub(crate) fn create(&self) -> Result<Output, Failure> {
        let begin = || {
            Ok(match &self.target {
                Target::File { path, permissions } => {
                    let part = part(path)?;
                    permissions.clone().map_or(Ok(()), |permissions| part.as_file().set_permissions(permissions))?;
                    Sink::Part { part, path: path.clone() }
                }
                Target::Stdout => Sink::Stream(Box::new(Stream(io::stdout()))),
                Target::Stream => Sink::Stream(Box::new(Stream(OpenOptions::new().write(true).open(&self.file)?))),
            })
        };
        let sink = begin().map_err(Failure::file(&self.file, "write"))?;
        Ok(Output { file: self.file.clone(), sink: BufWriter::new(sink) })
    }

    /// Writes an output at once.
    pub fn write(&self, text: &str) -> Result<(), Failure> {
        let mut output = self.create()?;
        output.put(|out| out.write_all(text.as_bytes()))?;
        output.finish()
    }
}

/// An output in progress. Its destination is unchanged until it is finished.
pub(crate) struct Output {
    file: PathBuf,
    sink: BufWriter<Sink>,
}

enum Sink {
    Part { part: NamedTempFile, path: PathBuf },
    Stream(Box<dyn Write>),
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Part { part, .. } => part.write(bytes),
            Self::Stream(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Part { part, .. } => part.flush(),
            Self::Stream(stream) => stream.flush(),
        }
    }
}

impl Output {
    pub(crate) fn put(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
        write(&mut self.sink).map_err(Failure::file(&self.file, "write"))
    }

    /// Writes what is still in memory.
    pub(crate) fn sync(&mut self) -> Result<(), Failure> {
        let mut sync = || -> io::Result<()> {
            self.sink.flush()?;
            match self.sink.get_ref() {
                // Some file systems report only here that there is no room.
                Sink::Part { part, .. } => part.as_file().sync_all(),
                Sink::Stream(_) => Ok(()),
            }
        };
        sync().map_err(Failure::file(&self.file, "write"))
    }

    /// Moves the output to its destination.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.sync()?;
        let Sink::Part { part, path } = self.sink.into_parts().0 else { return Ok(()) };
        let placed = part.persist(path).map(drop).or_else(|failed| {
            let (_, left) = failed.file.keep()?;
            Err(io::Error::new(failed.error.kind(), format!("{}; it is left in {}", failed.error, text::path(&left))))
        });
        placed.map_err(Failure::file(&self.file, "write"))
    }

    /// Keeps the temporary file, and says where it is.
    pub(crate) fn leave(self) {
        let Self { file, mut sink } = self;
        // After a failed write the rest may find no room either: what was written stays.
        _ = sink.flush();
        let Sink::Part { part, .. } = sink.into_parts().0 else { return };
        if let Ok((_, left)) = part.keep() {
            let (file, left) = (text::path(&file), text::path(&left));
            text::warn(format_args!("{file}: not written; what there is of it is left in {left}"));
        }
    }
}
