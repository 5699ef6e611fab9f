//! The command as a user runs it: the built binary, files in a folder, exit codes.
#![allow(clippy::unwrap_used, reason = "tests")]

use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

struct Run {
    code: i32,
    out: Vec<u8>,
    err: String,
}

impl Run {
    fn text(&self) -> String {
        String::from_utf8(self.out.clone()).unwrap()
    }

    /// The JSON object in the last line on standard error.
    fn error(&self) -> Value {
        serde_json::from_str(self.err.lines().last().unwrap()).unwrap()
    }
}

/// `polder` where no Vulkan driver is found, whatever is installed; `tests/devices_gpu.rs` looks at what is said where one is.
fn without_vulkan() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_polder"));
    command.envs(["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES"].map(|variable| (variable, "/nowhere")));
    command
}

/// Runs `polder` in a folder; the arguments are separated by blanks.
fn polder(folder: &Path, args: &str) -> Run {
    fed(folder, args, b"")
}

fn fed(folder: &Path, args: &str, input: &[u8]) -> Run {
    let mut command = without_vulkan();
    command.args(args.split_whitespace()).current_dir(folder);
    let pipes = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = pipes.spawn().unwrap();
    // The command may end without reading everything.
    let _ = child.stdin.take().unwrap().write_all(input);
    let output = child.wait_with_output().unwrap();
    Run { code: output.status.code().unwrap(), out: output.stdout, err: String::from_utf8(output.stderr).unwrap() }
}

fn ok(folder: &Path, args: &str) -> Run {
    let run = polder(folder, args);
    assert_eq!(run.code, 0, "{args}: {}", run.err);
    run
}

const BOX: &str = "# a box and its diagonal\n4 2 0 0\n1 0 0\n2 4 0\n3 4 3\n4 0 3\n1 0\n1 1 3\n0\n";
const CROSS: &str = "4 2 0 0\n1 0 0\n2 4 0\n3 4 3\n4 0 3\n3 0\n1 1 3\n2 1 2\n3 2 4\n0\n";

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).unwrap());
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn every_output_format_verifies_and_has_the_same_digest() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    ok(dir, "generate segments 500 --segments 60 --seed 3 -o in.poly");
    let digest = ok(dir, "digest in.poly").text();
    assert_eq!(digest.trim().len(), 64);
    for format in ["ele", "tri", "obj", "ply", "vtk"] {
        ok(dir, &format!("triangulate in.poly -o out.{format}"));
        let verdict = ok(dir, &format!("verify in.poly out.{format} --canonical")).text();
        assert_eq!(verdict, format!("out.{format}: valid and canonical\n"));
        assert_eq!(ok(dir, &format!("digest in.poly out.{format}")).text(), digest);
    }
    for backend in ["cpu", "reference"] {
        assert_eq!(ok(dir, &format!("digest in.poly --backend {backend} --threads 1")).text(), digest, "{backend}");
    }
    ok(dir, "triangulate in.poly -o out.svg");
    assert!(fs::read_to_string(dir.join("out.svg")).unwrap().starts_with("<svg"));
}

#[test]
fn triangles_files_are_numbered_as_the_input_and_stand_side_by_side() {
    let zero = "4 2 0 0\n0 0 0\n1 4 0\n2 4 3\n3 0 3\n1 1\n1 0 2 7\n0\n";
    let folder = folder(&[("one.poly", BOX), ("zero.poly", zero)]);
    let dir = folder.path();
    let read = |name: &str| fs::read_to_string(dir.join(name)).unwrap();
    ok(dir, "triangulate one.poly -o one.ele --neigh");
    assert_eq!(read("one.ele"), "2 3 0\n1 1 2 3\n2 1 3 4\n");
    assert_eq!(read("one.neigh"), "2 3\n1 -1 2 -1\n2 -1 -1 1\n");
    ok(dir, "triangulate zero.poly -o mesh.ele --edge --node");
    assert_eq!(read("mesh.ele"), "2 3 0\n0 0 1 2\n1 0 2 3\n");
    assert_eq!(read("mesh.node"), "4 2 0 0\n0 0 0\n1 4 0\n2 4 3\n3 0 3\n");
    assert!(read("mesh.edge").contains(" 2 0 7\n"), "{}", read("mesh.edge"));
    assert_eq!(names(dir), ["mesh.edge", "mesh.ele", "mesh.node", "one.ele", "one.neigh", "one.poly", "zero.poly"]);
}

#[test]
fn points_come_from_the_node_file_beside_a_poly() {
    let folder = folder(&[("x.node", "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n"), ("x.poly", "0 2 0 0\n1 0\n0 1 2\n0\n")]);
    ok(folder.path(), "triangulate x.poly -o y.ele");
    assert_eq!(fs::read_to_string(folder.path().join("y.ele")).unwrap(), "1 3 0\n0 0 1 2\n");
    // The .node beside the output would be the input itself.
    let run = polder(folder.path(), "triangulate x.poly -o x.ele --node");
    assert_eq!(run.code, 2);
    assert!(run.err.contains("would replace the input"), "{}", run.err);
}

#[test]
fn dashes_are_standard_input_and_output() {
    let folder = folder(&[("x.poly", BOX)]);
    let dir = folder.path();
    let run = fed(dir, "triangulate - --from poly -o - --to tri", BOX.as_bytes());
    assert_eq!((run.code, run.out.len()), (0, 8 + 2 * 12));
    let verdict = fed(dir, "verify x.poly - --mesh-from tri", &run.out);
    assert_eq!((verdict.code, verdict.text().as_str()), (0, "-: valid and canonical\n"));
    let raw = ok(dir, "generate uniform 10 -o - --to pslg").out;
    assert_eq!(raw.len(), 16 + 160);
    assert_eq!(fed(dir, "digest - --from pslg", &raw).code, 0);
    assert_eq!(names(dir), ["x.poly"]);
}

#[test]
fn wrong_meshes_are_told_where_they_are_wrong() {
    let lattice = "9 2 0 0\n1 0 0\n2 1 0\n3 2 0\n4 0 1\n5 1.1 1.2\n6 2 1\n7 0 2\n8 1 2\n9 2 2\n1 0\n1 4 6\n0\n";
    let folder = folder(&[("in.poly", lattice)]);
    let dir = folder.path();
    ok(dir, "triangulate in.poly -o right.ele");
    let right = fs::read_to_string(dir.join("right.ele")).unwrap();
    let lines: Vec<&str> = right.lines().skip(1).collect();
    let write = |triangles: &[String]| {
        let body: String = triangles.iter().enumerate().map(|(i, t)| format!("{} {t}\n", i + 1)).collect();
        fs::write(dir.join("wrong.ele"), format!("{} 3 0\n{body}", triangles.len())).unwrap();
    };
    let triangles: Vec<String> = lines.iter().map(|line| line.split_once(' ').unwrap().1.to_string()).collect();

    write(&triangles[1..]);
    let run = polder(dir, "verify in.poly wrong.ele");
    assert_eq!(run.code, 1);
    assert!(run.text().starts_with("wrong.ele: not valid\n"), "{}", run.text());

    let mut turned = triangles.clone();
    let corners: Vec<&str> = triangles[2].split(' ').collect();
    turned[2] = [corners[0], corners[2], corners[1]].join(" ");
    write(&turned);
    let run = polder(dir, "verify in.poly wrong.ele");
    assert!(run.code == 1 && run.text().contains("triangle 3: it is clockwise"), "{}", run.text());

    write(&[&triangles[..], &triangles[..1]].concat());
    let run = polder(dir, "verify in.poly wrong.ele --report json");
    let verdict: Value = serde_json::from_str(&run.text()).unwrap();
    assert_eq!((run.code, &verdict["valid"]), (1, &Value::Bool(false)));
    assert!(run.text().contains("repeated_triangle"), "{}", run.text());

    // Valid, but in another order: fine, unless asked for.
    let mut swapped = triangles.clone();
    swapped.swap(0, 1);
    write(&swapped);
    let run = ok(dir, "verify in.poly wrong.ele");
    assert_eq!(run.text(), "wrong.ele: valid, but not canonical\n  1 x: it should come before the one before it\n");
    let run = polder(dir, "verify in.poly wrong.ele --canonical");
    assert!(run.code == 1 && run.text().contains("triangle 2: it should come before"), "{}", run.text());

    fs::write(dir.join("other.obj"), "v 0 0\nv 1 0\nv 5 5\nf 1 2 3\n").unwrap();
    let run = polder(dir, "verify in.poly other.obj");
    assert_eq!(run.code, 1);
    assert!(run.text().contains("vertex 3 of the 3 in other.obj equals no point"), "{}", run.text());
    assert_eq!(polder(dir, "digest in.poly other.obj").code, 1);
}

#[test]
fn errors_have_their_kind_and_exit_code() {
    let folder = folder(&[
        ("box.poly", BOX),
        ("cross.poly", CROSS),
        ("empty.node", ""),
        ("lying.node", "4000000000 2 0 0\n1 0 0\n2 1 0\n3 0 1\n"),
        ("short.node", "3 2 0 0\n1 0 0\n2 1 0\n"),
        ("range.poly", "2 2 0 0\n1 0 0\n2 1 0\n1 0\n1 1 5\n0\n"),
        ("nan.node", "2 2 0 0\n1 0 0\n2 nan 0\n"),
        ("lying.pslg", "\u{1}\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"),
        ("binary.vtk", "# vtk DataFile Version 3.0\nx\nBINARY\n"),
        ("twice.ele", "2 3 0\n1 1 2 3\n2 1 2 4\n"),
        ("lonely.poly", "0 2 0 0\n1 0\n1 1 2\n0\n"),
        ("free.node", "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n"),
    ]);
    let dir = folder.path();
    fs::create_dir(dir.join("dir.ele")).unwrap();
    let before = names(dir);
    let cases = [
        ("triangulate empty.node -o x.ele", 1, "malformed_file", Some(("line", 1))),
        ("triangulate lying.node -o x.ele", 1, "malformed_file", Some(("line", 1))),
        ("triangulate short.node -o x.ele", 1, "malformed_file", Some(("line", 3))),
        ("triangulate lying.pslg -o x.ele", 1, "malformed_file", Some(("byte", 0))),
        ("digest box.poly twice.ele", 1, "malformed_file", None),
        ("triangulate range.poly -o x.ele", 1, "index_out_of_range", Some(("line", 5))),
        ("triangulate nan.node -o x.ele", 1, "non_finite_coordinate", Some(("line", 3))),
        ("triangulate cross.poly -o x.ele", 1, "crossing_constraints", None),
        ("digest cross.poly --backend reference", 1, "crossing_constraints", None),
        ("draw final cross.poly -o x.svg", 1, "crossing_constraints", None),
        ("triangulate missing.poly -o x.ele", 3, "io", None),
        ("triangulate lonely.poly -o x.ele", 3, "io", None),
        ("triangulate box.poly -o missing/x.ele", 3, "io", None),
        ("triangulate box.poly -o dir.ele", 3, "io", None),
        ("triangulate dir.ele --from poly -o x.ele", 3, "io", None),
        ("triangulate box.poly -o x.ele --backend vulkan", 3, "unsupported", None),
        ("triangulate free.node -o x.ele --backend vulkan --device nothing", 3, "unsupported", None),
        ("verify box.poly binary.vtk", 3, "unsupported", None),
        ("generate uniform 9 -o missing/x.node", 3, "io", None),
    ];
    for (args, code, kind, place) in cases {
        let run = polder(dir, &format!("{args} --error-format json"));
        assert_eq!((run.code, run.error()["kind"].as_str().unwrap()), (code, kind), "{args}: {}", run.err);
        assert!(!run.error()["message"].as_str().unwrap().is_empty());
        if let Some((key, value)) = place {
            assert_eq!(run.error()[key], value, "{args}");
        }
        let human = polder(dir, args);
        assert_eq!(human.code, code);
        assert!(human.err.starts_with("polder: ") && human.out.is_empty(), "{args}: {}", human.err);
    }
    assert_eq!(names(dir), before, "nothing is written where something is wrong");
}

#[test]
fn crossing_segments_are_named_by_their_numbers_in_the_file() {
    let folder = folder(&[("cross.poly", CROSS)]);
    let run = polder(folder.path(), "triangulate cross.poly -o x.ele --error-format json");
    assert_eq!(run.error()["pairs"], serde_json::json!([[1, 3]]));
    assert_eq!(run.error()["truncated"], false);
    let run = polder(folder.path(), "triangulate cross.poly -o x.ele");
    assert_eq!(run.err, "polder: 1 pair of segments crosses: 1 and 3\n");
}

#[test]
fn wrong_command_lines_exit_with_2() {
    let folder = folder(&[("box.poly", BOX)]);
    for args in [
        "",
        "triangulate",
        "triangulate box.poly",
        "triangulate box.poly -o x.doc",
        "triangulate box.poly -o x.ele --backend abacus",
        "triangulate - -o x.ele",
        "triangulate box.poly -o -",
        "triangulate box.poly -o x.tri --neigh",
        "verify - - --from poly --mesh-from tri",
        "generate uniform many -o x.node",
        "generate uniform 99999999999 -o x.node",
        "generate segments 100 -o x.node",
        "generate lava 100 -o x.node",
        "generate lattice 9 --width 0 -o x.node",
        "draw final box.poly -o x.gif",
        "draw lava box.poly -o x.svg",
        "draw final box.poly -o x.png --size 0",
        "draw voronoi box.poly -o x.svg --grid 0",
        "draw voronoi box.poly -o x.svg --grid 32769",
        "triangulate box.poly -o x.ele --threads 1025",
        "triangulate box.poly -o x.ele --threads -1",
    ] {
        let run = polder(folder.path(), args);
        assert_eq!(run.code, 2, "{args}: {}", run.err);
        assert!(!run.err.is_empty());
    }
    assert_eq!(names(folder.path()), ["box.poly"]);
    assert_eq!(ok(folder.path(), "--help").err, "");
    assert!(ok(folder.path(), "--version").text().starts_with("polder 0."));
}

#[test]
fn an_output_is_replaced_whole_or_left_as_it_was() {
    let folder = folder(&[("box.poly", BOX), ("cross.poly", CROSS), ("x.ele", "old"), ("plain", "")]);
    let dir = folder.path();
    assert_eq!(polder(dir, "triangulate cross.poly -o x.ele").code, 1);
    assert_eq!(fs::read_to_string(dir.join("x.ele")).unwrap(), "old");
    // One of two outputs cannot be written: then neither is.
    fs::create_dir(dir.join("x.neigh")).unwrap();
    assert_eq!(polder(dir, "triangulate box.poly -o x.ele --neigh").code, 3);
    assert_eq!(fs::read_to_string(dir.join("x.ele")).unwrap(), "old");
    fs::remove_dir(dir.join("x.neigh")).unwrap();
    ok(dir, "triangulate box.poly -o x.ele");
    assert!(fs::read_to_string(dir.join("x.ele")).unwrap().starts_with("2 3 0\n"));
    assert_eq!(names(dir), ["box.poly", "cross.poly", "plain", "x.ele"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = |name: &str| fs::metadata(dir.join(name)).unwrap().permissions().mode();
        assert_eq!(mode("x.ele"), mode("plain"), "as any other new file");
        std::os::unix::fs::symlink("x.ele", dir.join("link.ele")).unwrap();
        ok(dir, "triangulate box.poly -o link.ele");
        assert!(fs::symlink_metadata(dir.join("link.ele")).unwrap().is_symlink());
        ok(dir, "triangulate box.poly -o /dev/null --to ele");
    }
}

#[test]
fn holes_and_outlines_get_one_line_of_warning() {
    let hole = BOX.replace("\n0\n", "\n1\n1 2 1\n");
    let outline = "3 2 0 0\n1 0 0\n2 4 0\n3 4 3\n3 0\n1 1 2\n2 2 3\n3 3 1\n0\n";
    let folder = folder(&[("hole.poly", &hole), ("outline.poly", outline), ("box.poly", BOX)]);
    for (file, warned) in [("hole", true), ("outline", true), ("box", false)] {
        let run = ok(folder.path(), &format!("triangulate {file}.poly -o x.tri"));
        assert_eq!(run.err.lines().filter(|line| line.contains("whole convex hull")).count(), warned as usize);
        assert_eq!(run.err.lines().count(), 1 + warned as usize, "{}", run.err);
        assert_eq!(ok(folder.path(), &format!("triangulate {file}.poly -o x.tri --quiet")).err, "");
    }
}

#[test]
fn the_report_says_what_became_of_everything() {
    let input = "6 2 0 0\n1 0 0\n2 4 0\n3 4 3\n4 0 3\n5 4 3\n6 2 0\n4 0\n1 1 2\n2 2 1\n3 3 5\n4 4 1\n0\n";
    let folder = folder(&[("x.poly", input)]);
    let report: Value =
        serde_json::from_str(&ok(folder.path(), "triangulate x.poly -o x.tri --report json").text()).unwrap();
    assert_eq!(report["points"], serde_json::json!({"total": 6, "vertices": 5, "duplicates": 1, "added": 0}));
    assert_eq!(report["triangles"], 3);
    assert_eq!(report["constraints"]["zero_length"], serde_json::json!([2]));
    assert_eq!(report["constraints"]["repeated"], serde_json::json!([1]));
    assert_eq!(report["constraints"]["through_vertices"], 2);
    assert!(!report["stages"].as_array().unwrap().is_empty());
}

#[test]
fn a_seed_gives_the_same_file_and_every_family_can_be_triangulated() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let families = [
        "uniform",
        "gaussian",
        "clusters",
        "exponential",
        "circle",
        "cocircular",
        "concentric",
        "lattice",
        "collinear",
        "near-collinear",
        "huge",
        "tiny",
        "mixed",
        "segments",
        "spiral",
        "comb",
        "fan",
    ];
    for family in families {
        ok(dir, &format!("generate {family} 200 -o a.poly --seed 5"));
        ok(dir, &format!("generate {family} 200 -o b.pslg --seed 5"));
        assert_eq!(ok(dir, "digest a.poly").text(), ok(dir, "digest b.pslg").text(), "{family}");
        ok(dir, "triangulate a.poly -o a.obj");
        ok(dir, "verify a.poly a.obj --canonical");
    }
    ok(dir, "generate uniform 5 -o a.node --seed 1");
    ok(dir, "generate uniform 5 -o b.node --seed 2");
    assert_ne!(fs::read(dir.join("a.node")).unwrap(), fs::read(dir.join("b.node")).unwrap());
    ok(dir, "generate lattice 12 --width 4 -o l.node");
    assert!(fs::read_to_string(dir.join("l.node")).unwrap().contains("12 3 2"));
}

#[test]
fn every_stage_can_be_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    for (family, n) in
        [("segments", 60), ("circle", 100), ("collinear", 9), ("uniform", 0), ("uniform", 1), ("huge", 9)]
    {
        ok(dir, &format!("generate {family} {n} -o in.poly"));
        for stage in ["voronoi", "dualized", "shifted", "inserted", "constrained", "final"] {
            ok(dir, &format!("draw {stage} in.poly -o out.svg"));
            let svg = fs::read_to_string(dir.join("out.svg")).unwrap();
            assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{family} {n} {stage}");
            ok(dir, &format!("draw {stage} in.poly -o out.png --size 100"));
            assert!(fs::read(dir.join("out.png")).unwrap().starts_with(b"\x89PNG"));
        }
    }
    ok(dir, "generate uniform 50 -o in.poly");
    ok(dir, "draw voronoi in.poly --grid 64 -o fine.svg");
    assert!(fs::read_to_string(dir.join("fine.svg")).unwrap().contains("<title>64 x"));
}

/// An interrupt ends the command with exit code 4, and leaves nothing behind.
#[cfg(unix)]
#[test]
fn an_interrupt_cancels() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_polder"));
    command.args(["triangulate", "-", "--from", "node", "-o", "x.ele", "--error-format", "json"]);
    command.current_dir(folder.path()).stdin(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(b"1000000 2 0 0\n1 0 0\n").unwrap();
    // Until the handler is in place an interrupt would end it without a word.
    std::thread::sleep(std::time::Duration::from_millis(500));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    // It may be waiting for a line when the interrupt comes, and looks at the flag before it waits for the next one.
    for i in 2..1000 {
        if stdin.write_all(format!("{i} {i} 0\n").as_bytes()).is_err() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(4));
    let error: Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!(error["kind"], "cancelled");
    assert!(names(folder.path()).is_empty());
}

#[test]
fn devices_without_vulkan_are_an_error_in_one_line() {
    let run = |args: &[&str]| without_vulkan().args(args).output().unwrap();
    let plain = run(&["devices"]);
    assert_eq!((plain.status.code(), plain.stdout.len()), (Some(3), 0));
    let said = String::from_utf8(plain.stderr).unwrap();
    let said: Vec<&str> = said.lines().filter(|line| line.starts_with("polder: ")).collect();
    assert!(said.len() == 1 && said[0].contains("Vulkan"), "{said:?}");
    let error = run(&["devices", "--json", "--error-format", "json"]);
    assert_eq!((error.status.code(), error.stdout.len()), (Some(3), 0));
    let error: Value = serde_json::from_str(String::from_utf8(error.stderr).unwrap().lines().last().unwrap()).unwrap();
    assert_eq!(error["kind"], "unsupported");
}

/// A square with a square hole in it, and a point far off.
const FRAME: &str = "9 2 0 0\n1 0 0\n2 9 0\n3 9 9\n4 0 9\n5 3 3\n6 6 3\n7 6 6\n8 3 6\n9 20 5\n\
    8 0\n1 1 2\n2 2 3\n3 3 4\n4 4 1\n5 5 6\n6 6 7\n7 7 8\n8 8 5\n";

#[test]
fn the_domain_has_neither_exterior_nor_holes() {
    let holes = |text: &str| format!("{FRAME}{text}");
    let folder = folder(&[
        ("hole.poly", &holes("1\n1 4 5\n")),
        ("none.poly", &holes("0\n")),
        ("odd.poly", &holes("3\n1 4 4\n2 15 5\n3 -9 -9\n")),
        ("on.poly", &holes("2\n1 4 4\n2 4 3\n")),
        ("box.poly", BOX),
    ]);
    let dir = folder.path();
    let triangles = |args: &str| {
        let run = ok(dir, &format!("triangulate {args} -o out.ele --report json"));
        let report: Value = serde_json::from_str(&run.text()).unwrap();
        let ele = fs::read_to_string(dir.join("out.ele")).unwrap();
        let count: u64 = ele.split_whitespace().next().unwrap().parse().unwrap();
        assert_eq!(report["triangles"], count);
        (count, run.err)
    };
    let (whole, said) = triangles("hole.poly");
    assert!(whole == 11 && said.contains("--domain"), "{whole} {said}");
    assert_eq!(triangles("hole.poly --domain"), (8, String::new()));
    assert_eq!(triangles("none.poly --domain").0, 10);
    let (count, said) = triangles("odd.poly --domain");
    assert_eq!(count, 8);
    assert!(said.contains("hole 2 lies outside all outlines") && said.contains("hole 3 lies in no triangle"), "{said}");
    let (count, said) = triangles("box.poly --domain");
    assert!(count == 0 && said.contains("nothing is left"), "{said}");

    let run = polder(dir, "triangulate on.poly -o out.ele --domain --error-format json");
    assert_eq!((run.code, run.error()["kind"].clone()), (1, "seed_on_constraint".into()));
    assert_eq!(run.error()["hole"], 2);
    ok(dir, "draw final hole.poly --domain -o out.svg");
    assert!(fs::read_to_string(dir.join("out.svg")).unwrap().contains("8 triangles"));
    assert_eq!(polder(dir, "draw shifted hole.poly --domain -o out.svg").code, 2);
}

#[test]
fn segments_that_cross_are_split_where_that_is_asked_for() {
    let folder = folder(&[("cross.poly", CROSS)]);
    let dir = folder.path();
    assert_eq!(polder(dir, "triangulate cross.poly -o out.ele").code, 1);
    let run = ok(dir, "triangulate cross.poly --crossings split -o out.ele --node --report json");
    let report: Value = serde_json::from_str(&run.text()).unwrap();
    assert_eq!((&report["points"]["added"], &report["triangles"]), (&1.into(), &4.into()));
    let node = fs::read_to_string(dir.join("out.node")).unwrap();
    assert_eq!(node.lines().count(), 6);
    assert!(node.lines().last().unwrap().starts_with("5 2 1.5"), "{node}");
    let said = ok(dir, "triangulate cross.poly --crossings split -o out.ele").err;
    assert!(said.contains("--node") && said.contains("1 point added where segments cross"), "{said}");
    for format in ["obj", "ply", "vtk", "svg", "tri"] {
        ok(dir, &format!("triangulate cross.poly --crossings split -o out.{format}"));
    }
    assert!(fs::read_to_string(dir.join("out.obj")).unwrap().contains("v 2 1.5"));
    let few = polder(dir, "triangulate cross.poly --crossings split --max-added 0 -o no.ele --error-format json");
    assert_eq!((few.code, few.error()["kind"].clone()), (1, "too_large".into()));
    assert!(polder(dir, "triangulate cross.poly -o no/x.ele --crossings split").err.ends_with("(os error 2)\n"));
}
