//! What can be said on the command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use polder_io::{InputFormat, MeshFormat};
use std::path::PathBuf;

const MAX_GRID: i64 = polder::voronoi::MAX_SIDE as i64;

const AFTER: &str = "\
Exit codes: 0 all went well; 1 the input is at fault, or the mesh is wrong; 2 the command line is at fault; 3 files, \
device or resources are at fault, or polder itself; 4 cancelled.

Examples:
  polder triangulate coast.poly -o coast.svg      look at it
  polder triangulate coast.poly -o coast.ele      for programs that read Triangle's files
  polder triangulate coast.poly -o land.svg --domain    the land alone, without sea and lakes
  polder verify coast.poly coast.ele              check it, or any other tool's mesh
  polder generate segments 1000000 -o big.pslg    make a hard one";

/// Constrained Delaunay triangulations: exact, canonical, fast.
///
/// Points and segments in, triangles out. The same input gives the same triangles, byte for byte, on every machine and
/// with any number of threads.
#[derive(Parser)]
#[command(name = "polder", version, after_help = AFTER, max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,

    /// How errors are told on standard error: in a sentence, or with one JSON object as the last line
    #[arg(long, global = true, value_name = "FORMAT", default_value = "human")]
    pub(crate) error_format: ErrorFormat,

    /// Say nothing but errors
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Triangulate points and segments
    Triangulate(TriangulateArgs),
    /// Check a mesh, whoever made it, against its input
    Verify(VerifyArgs),
    /// Print the digest of a triangulation: equal if and only if the triangles are
    Digest(DigestArgs),
    /// Make an input from a seed
    Generate(GenerateArgs),
    /// Draw a stage on the way from pixels to triangles
    Draw(DrawArgs),
    /// List the Vulkan devices of this machine, and what polder can use of them
    Devices(DevicesArgs),
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ErrorFormat {
    Human,
    Json,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReportFormat {
    /// One JSON object
    Json,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum BackendChoice {
    /// A GPU where that pays, else the CPU
    Auto,
    /// The CPU, by the fastest way there
    Cpu,
    /// A Vulkan device
    Vulkan,
    /// Every stage in order on one thread: slow, for comparison
    Reference,
}

impl BackendChoice {
    pub(crate) fn backend(self) -> polder::Backend {
        match self {
            Self::Auto => polder::Backend::Auto,
            Self::Cpu => polder::Backend::Cpu,
            Self::Vulkan => polder::Backend::Vulkan,
            Self::Reference => polder::Backend::Reference,
        }
    }
}

/// The input of a command.
#[derive(Args)]
pub(crate) struct InputArgs {
    /// Points and segments: a .node, .poly or .pslg file, or - for standard input
    pub(crate) input: PathBuf,

    /// The format of the input, where its extension does not say: node, poly or pslg
    #[arg(long, value_name = "FORMAT")]
    pub(crate) from: Option<InputFormat>,
}

/// How to triangulate; the result does not depend on it.
#[derive(Args)]
pub(crate) struct WayArgs {
    /// Where to compute
    #[arg(long, default_value = "auto")]
    pub(crate) backend: BackendChoice,

    /// The Vulkan device, where one is used: its number or a part of its name in `polder devices` [default: what the
    /// environment variable POLDER_DEVICE says, else the best GPU]
    #[arg(long, value_name = "DEVICE")]
    pub(crate) device: Option<String>,

    /// Threads of the CPU to use, at most 1024; 0 for as many as there are
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=1024))]
    pub(crate) threads: u16,

    /// The longer side of the pixel grid, where the backend has one: 1 to 32768; the number of points decides if not
    /// given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_GRID))]
    pub(crate) grid: Option<u32>,

    /// How many pairs of crossing segments to name at most
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    pub(crate) max_crossings: usize,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum CrossingChoice {
    /// An error, which names all pairs
    Error,
    /// Cut there, at new points
    Split,
}

#[derive(Args)]
pub(crate) struct TriangulateArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,

    /// Where the triangles go: an .ele, .tri, .obj, .ply, .vtk or .svg file, or - for standard output. Written whole or
    /// not at all
    #[arg(long, short, value_name = "OUTPUT")]
    pub(crate) output: PathBuf,

    /// The format of the output, where its extension does not say: ele, tri, obj, ply, vtk or svg
    #[arg(long, value_name = "FORMAT")]
    pub(crate) to: Option<MeshFormat>,

    /// What becomes of segments that cross where no point is; whatever the backend, the CPU names or cuts them. New points
    /// follow the input's, in the order of rounds, x, y; with .ele, --node writes where they are
    #[arg(long, value_name = "POLICY", default_value = "error")]
    pub(crate) crossings: CrossingChoice,

    /// With --crossings split: how many points to add at most
    #[arg(long, value_name = "N", default_value_t = 10_000_000)]
    pub(crate) max_added: usize,

    /// Leave out what lies outside all outlines, and the holes that a .poly names: what segments do not hold back is
    /// eaten from the hull and from each hole
    #[arg(long)]
    pub(crate) domain: bool,

    #[command(flatten)]
    pub(crate) way: WayArgs,

    /// Print what became of points and segments, and what each stage did, on standard output (on standard error if the
    /// triangles go to standard output)
    #[arg(long, value_name = "FORMAT")]
    pub(crate) report: Option<ReportFormat>,

    /// With .ele: write the neighbors of each triangle too, to a .neigh beside it
    #[arg(long)]
    pub(crate) neigh: bool,

    /// With .ele: write the edges too, to an .edge beside it
    #[arg(long)]
    pub(crate) edge: bool,

    /// With .ele: write the points too, to a .node beside it, for programs that do not know the input
    #[arg(long)]
    pub(crate) node: bool,
}

#[derive(Args)]
pub(crate) struct VerifyArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,

    /// The mesh: an .ele, .tri, .obj, .ply or .vtk file, or - for standard input. Where it has vertices of its own,
    /// they are found among the points by their coordinates
    pub(crate) mesh: PathBuf,

    /// The format of the mesh, where its extension does not say: ele, tri, obj, ply or vtk
    #[arg(long, value_name = "FORMAT")]
    pub(crate) mesh_from: Option<MeshFormat>,

    /// Demand the canonical triangulation: ties settled as polder does, triangles in its order
    #[arg(long)]
    pub(crate) canonical: bool,

    /// Print the verdict as JSON
    #[arg(long, value_name = "FORMAT")]
    pub(crate) report: Option<ReportFormat>,
}

#[derive(Args)]
pub(crate) struct DigestArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,

    /// A mesh of that input, put into canonical order first; without one, the input is triangulated
    pub(crate) mesh: Option<PathBuf>,

    /// The format of the mesh, where its extension does not say
    #[arg(long, value_name = "FORMAT")]
    pub(crate) mesh_from: Option<MeshFormat>,

    #[command(flatten)]
    pub(crate) way: WayArgs,
}

#[derive(Args)]
pub(crate) struct DevicesArgs {
    /// Print the list as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Family {
    /// Uniform in the unit square
    Uniform,
    /// About the origin, standard deviation 1
    Gaussian,
    /// In --clusters gaussian clusters of deviation --sigma
    Clusters,
    /// Crowding toward one point, down to 2^-45
    Exponential,
    /// On the unit circle, up to rounding
    Circle,
    /// Integer points exactly on one circle (beyond 2916, on its multiples)
    Cocircular,
    /// On --circles circles about one center
    Concentric,
    /// Integer points of a square, or of a rectangle --width wide
    Lattice,
    /// Exactly on one line
    Collinear,
    /// At most --ulps units in the last place off a line
    NearCollinear,
    /// Coordinates up to 1e300
    Huge,
    /// Coordinates below 1e-300
    Tiny,
    /// Coordinates of any magnitude
    Mixed,
    /// --segments segments of widely varying length that do not cross, then points on none of them
    Segments,
    /// --segments segments that cross as they please: a bad input
    Crossing,
    /// One line wound up, with its segments
    Spiral,
    /// Teeth 1000 times as high as wide, with their segments
    Comb,
    /// Segments from one point to all others
    Fan,
}

#[derive(Args)]
pub(crate) struct GenerateArgs {
    /// What to make
    pub(crate) family: Family,

    /// How many points
    pub(crate) points: usize,

    /// Where it goes: a .node, .poly or .pslg file, or - for standard output
    #[arg(long, short, value_name = "OUTPUT")]
    pub(crate) output: PathBuf,

    /// The format of the output, where its extension does not say: node, poly or pslg
    #[arg(long, value_name = "FORMAT")]
    pub(crate) to: Option<InputFormat>,

    /// Another seed, another input; the same seed, the same input, on every machine and for ever
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,

    /// How many segments [default: a tenth of the points]
    #[arg(long, value_name = "N")]
    pub(crate) segments: Option<usize>,

    /// How many clusters
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub(crate) clusters: usize,

    /// Standard deviation of a cluster
    #[arg(long, value_name = "X", default_value_t = 1e-4)]
    pub(crate) sigma: f64,

    /// How many circles
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub(crate) circles: usize,

    /// How wide the lattice is [default: square]
    #[arg(long, value_name = "N")]
    pub(crate) width: Option<usize>,

    /// How far off the line, in units in the last place
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) ulps: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Stage {
    /// The pixel grid, colored by nearest site; pixels cut off from theirs are marked
    Voronoi,
    /// The triangulation of the pixels' sites
    Dualized,
    /// The sites moved to their true positions, as far as triangles allow
    Shifted,
    /// All points in
    Inserted,
    /// All segments in
    Constrained,
    /// The constrained Delaunay triangulation
    Final,
}

#[derive(Args)]
pub(crate) struct DrawArgs {
    /// What to draw
    pub(crate) stage: Stage,

    #[command(flatten)]
    pub(crate) input: InputArgs,

    /// With final: leave out what lies outside all outlines, and the holes
    #[arg(long)]
    pub(crate) domain: bool,

    /// Where the picture goes: an .svg or .png file
    #[arg(long, short, value_name = "PICTURE")]
    pub(crate) output: PathBuf,

    /// The longer side of the pixel grid, 1 to 32768; the number of points decides if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_GRID))]
    pub(crate) grid: Option<u32>,

    /// The longer side of a .png, in pixels
    #[arg(long, value_name = "N", default_value_t = 1600)]
    pub(crate) size: u32,
}
