//! Files that are not what they claim to be: every one gets an error that says where, and none a panic.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder_io::*;
use polder_mesh::{DVec2, Pslg, Triangulation};
use proptest::prelude::*;
use std::io::Read;

fn input(format: InputFormat, bytes: impl AsRef<[u8]> + Clone + 'static) -> Result<Input, IoError> {
    let known = Input::read_from(Source::bytes(bytes.clone(), "x"), format);
    // The same through a reader that does not tell its size, as standard input does not.
    let unknown = Input::read_from(Source::new(std::io::Cursor::new(bytes), "x"), format);
    assert_eq!(known.is_ok(), unknown.is_ok());
    known
}

fn mesh(format: MeshFormat, bytes: impl AsRef<[u8]> + 'static) -> Result<MeshFile, IoError> {
    MeshFile::read_from(Source::bytes(bytes, "x"), format)
}

#[test]
fn text_inputs() {
    let node = InputFormat::Node;
    let poly = InputFormat::Poly;
    let cases = [
        (node, ""),
        (node, "# nothing\n\n  \n"),
        (node, "three 2 0 0\n"),
        (node, "-1 2 0 0\n"),
        (node, "1 3 0 0\n1 0 0 0\n"),
        (node, "1 2 0 2\n1 0 0 0 0\n"),
        (node, "1 2 0 0 0\n1 0 0\n"),
        (node, "4000000000 2 0 0\n1 0 0\n2 1 0\n3 0 1\n"),
        (node, "18446744073709551615 2 0 0\n1 0 0\n"),
        (node, "99999999999999999999 2 0 0\n1 0 0\n"),
        (node, "1 2 4000000000 0\n1 0 0\n"),
        (node, "3 2 0 0\n1 0 0\n2 1 0\n"),
        (node, "2 2 0 0\n1 0 0\n2 1\n"),
        (node, "2 2 0 0\n1 0 0\n2 1 0 5\n"),
        (node, "2 2 1 0\n1 0 0 1\n2 1 0\n"),
        (node, "2 2 0 1\n1 0 0 1\n2 1 0 one\n"),
        (node, "2 2 0 0\n1 0 0\n3 1 0\n"),
        (node, "2 2 0 0\n7 0 0\n8 1 0\n"),
        (node, "2 2 0 0\n1 0 0\n2 1 0\n3 1 1\n"),
        (node, "2 2 0 0\n1 0 0\n2 0x10 0\n"),
        (node, "2 2 0 0\n1 0 0\n2 1,5 0\n"),
        (node, "2 2 0 0\n1 0 0\n2 \u{1b}[31m\u{0} 0\n"),
        (node, "2 2 0 0\n1 0 0\n2 nan 0\n"),
        (node, "2 2 0 0\n1 0 0\n2 0 -inf\n"),
        (node, "2 2 0 0\n1 0 0\n2 0 1e999\n"),
        (poly, "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n"),
        (poly, "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n1 0\n"),
        (poly, "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n1 0\n1 1\n0\n"),
        (poly, "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n1 0\n1 1 2\n"),
        (poly, "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n1 0\n1 1 4\n0\n"),
        (poly, "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n1 0\n1 0 1\n0\n"),
        (poly, "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n1 0\n1 0 3\n0\n"),
        (poly, "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n1 0\n1 0 -1\n0\n"),
        (poly, "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n1 0\n1 0 1.5\n0\n"),
        (poly, "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n4000000000 0\n1 0 1\n0\n"),
        (poly, "1 2 0 0\n0 0 0\n0 0\n1\n"),
        (poly, "1 2 0 0\n0 0 0\n0 0\n1\n1 nan 2\n"),
        (poly, "1 2 0 0\n0 0 0\n0 0\n0\n1\n1 0 0\n"),
        (poly, "1 2 0 0\n0 0 0\n0 0\n0\n4000000000\n"),
        (poly, "1 2 0 0\n0 0 0\n0 0\n0\n0\nmore\n"),
        (poly, "0 2 0 0\n1 0\n1 1 2\n0\n"),
    ];
    let show = |(format, text): (InputFormat, &'static str)| {
        let error = input(format, text).unwrap_err();
        format!("{:?}\n  {}: {error}\n", text, error.kind())
    };
    insta::assert_snapshot!(cases.map(show).concat());
}

#[test]
fn raw_inputs() {
    let word = |x: u64| x.to_le_bytes().to_vec();
    let point = |x: f64, y: f64| [x.to_le_bytes(), y.to_le_bytes()].concat();
    let ends = |a: u32, b: u32| [a.to_le_bytes(), b.to_le_bytes()].concat();
    let cases = [
        ("nothing", vec![]),
        ("half a count", vec![1; 12]),
        ("four billion points", [word(4_000_000_000), word(0), point(0.0, 0.0)].concat()),
        ("all the points there can be", [word(u64::MAX), word(u64::MAX)].concat()),
        ("four billion constraints", [word(1), word(4_000_000_000), point(0.0, 0.0)].concat()),
        ("half a point", [word(1), word(0), word(0)].concat()),
        ("one byte short", [word(1), word(1), point(0.0, 0.0), vec![0; 7]].concat()),
        ("more than promised", [word(1), word(0), point(0.0, 0.0), vec![0]].concat()),
        ("NaN", [word(2), word(0), point(0.0, 0.0), point(1.0, f64::NAN)].concat()),
        ("infinity", [word(2), word(0), point(0.0, 0.0), point(f64::NEG_INFINITY, 1.0)].concat()),
        ("out of range", [word(2), word(1), point(0.0, 0.0), point(1.0, 1.0), ends(0, 2)].concat()),
        ("text", b"3 2 0 0\n1 0.25 0.5\n2 0 0\n3 1 1\n".to_vec()),
    ];
    let show = |(name, bytes): (&str, Vec<u8>)| {
        let error = input(InputFormat::Pslg, bytes).unwrap_err();
        format!("{name}\n  {}: {error}\n", error.kind())
    };
    insta::assert_snapshot!(cases.map(show).concat());
}

#[test]
fn meshes() {
    let ply = |format: &str, body: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n{body}"
        )
    };
    let vtk = |body: &str| format!("# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\n{body}");
    let cases = [
        (MeshFormat::Ele, "".to_string()),
        (MeshFormat::Ele, "1 4 0\n1 1 2 3 4\n".into()),
        (MeshFormat::Ele, "4000000000 3 0\n1 1 2 3\n".into()),
        (MeshFormat::Ele, "2 3 0\n1 1 2 3\n".into()),
        (MeshFormat::Ele, "1 3 0\n1 1 2\n".into()),
        (MeshFormat::Ele, "1 3 0\n1 1 2 0\n".into()),
        (MeshFormat::Ele, "1 3 0\n0 0 1 -2\n".into()),
        (MeshFormat::Ele, "1 3 0\n9 0 1 2\n".into()),
        (MeshFormat::Ele, "1 3 0\n0 0 1 2\n1 3 4 5\n".into()),
        (MeshFormat::Tri, "".into()),
        (MeshFormat::Tri, "\u{1}\0\0\0\0\0\0\0\0\0\0".into()),
        (MeshFormat::Obj, "v 0 0\nv 1\n".into()),
        (MeshFormat::Obj, "v 0 0\nv 1 nan\n".into()),
        (MeshFormat::Obj, "v 0 0\nv 1 0\nv 0 1\nf 1 2\n".into()),
        (MeshFormat::Obj, "v 0 0\nv 1 0\nv 0 1\nf 1 2 3 3\n".into()),
        (MeshFormat::Obj, "v 0 0\nv 1 0\nv 0 1\nf 1 2 4\n".into()),
        (MeshFormat::Obj, "v 0 0\nv 1 0\nv 0 1\nf 1 2 -4\n".into()),
        (MeshFormat::Obj, "v 0 0\nv 1 0\nv 0 1\nf 1 2 0\n".into()),
        (MeshFormat::Ply, "plx\n".into()),
        (MeshFormat::Ply, "ply\nformat binary_big_endian 1.0\n".into()),
        (MeshFormat::Ply, "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n".into()),
        (MeshFormat::Ply, "ply\nformat ascii 1.0\nelement vertex 4\nend_header\n".into()),
        (MeshFormat::Ply, "ply\nformat ascii 1.0\nproperty float x\n".into()),
        (MeshFormat::Ply, "ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n".into()),
        (MeshFormat::Ply, "ply\nelement vertex 0\nend_header\n".into()),
        (MeshFormat::Ply, ply("ascii", "0 0\n1 0\n")),
        (MeshFormat::Ply, ply("ascii", "0 0\n1 0\n0 inf\n3 0 1 2\n")),
        (MeshFormat::Ply, ply("ascii", "0 0\n1 0\n0 1\n4 0 1 2 2\n")),
        (MeshFormat::Ply, ply("ascii", "0 0\n1 0\n0 1\n3 0 1 3\n")),
        (MeshFormat::Ply, ply("ascii", "0 0\n1 0\n0 1\n3 0 1 -1\n")),
        (MeshFormat::Ply, ply("ascii", "0 0\n1 0\n0 1 1\n3 0 1 2\n")),
        (MeshFormat::Ply, ply("binary_little_endian", "0000\n")),
        (MeshFormat::Vtk, "VTK\n".into()),
        (MeshFormat::Vtk, "# vtk DataFile Version 3.0\ntitle\nBINARY\n".into()),
        (MeshFormat::Vtk, "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET STRUCTURED_POINTS\n".into()),
        (MeshFormat::Vtk, vtk("POINTS 4000000000 double\n0 0 0\n")),
        (MeshFormat::Vtk, vtk("POINTS 2 double\n0 0 0\n")),
        (MeshFormat::Vtk, vtk("POINTS 1 double\n0 nan 0\n")),
        (MeshFormat::Vtk, vtk("POINTS 1 double\n0 0 0\nPOLYGONS 1 5\n4 0 0 0 0\n")),
        (MeshFormat::Vtk, vtk("POINTS 1 double\n0 0 0\nPOLYGONS 1 4\n3 0 0 1\n")),
        (MeshFormat::Vtk, vtk("POINTS 1 double\n0 0 0\nPOLYGONS 4000000000 4\n3 0 0 0\n")),
        (MeshFormat::Vtk, vtk("TRIANGLES 1\n")),
        (MeshFormat::Svg, "<svg/>".into()),
    ];
    let show = |(format, text): (MeshFormat, String)| {
        let error = mesh(format, text.clone()).unwrap_err();
        format!("{format:?} {:?}\n  {}: {error}\n", text, error.kind())
    };
    insta::assert_snapshot!(cases.map(show).concat());
}

#[test]
fn what_triangle_accepts_is_read() {
    let poly = "\u{feff}# a box\r\n4 2 1 1 # header\r\n\r\n0  0 0\t1.5 7 # first\n1 1. .0 -2e-3 0\n 2 +1 1 3 0\n3 0 1 4 0\n\
                2 1\n1 0 1 5\n2 1 2 6\n1\n1 0.5 0.5\n2\n1 .25 .25 9 0.1\n2 .5 .75 8";
    let input = input(InputFormat::Poly, poly).unwrap();
    assert_eq!(input.pslg.points()[1], DVec2::new(1.0, 0.0));
    assert_eq!(input.attributes, [1.5, -2e-3, 3.0, 4.0]);
    assert_eq!(input.point_markers, Some(vec![7, 0, 0, 0]));
    assert_eq!((input.first, input.pslg.constraints()), (0, &[[0, 1], [1, 2]][..]));
    assert_eq!(input.constraint_markers, Some(vec![5, 6]));
    assert_eq!(input.holes, [DVec2::new(0.5, 0.5)]);
    assert_eq!(input.regions[0].max_area, Some(0.1));
    assert_eq!(input.regions[1].max_area, None);
    // The dimension, attributes and markers may be left out of the header.
    assert_eq!(self::input(InputFormat::Node, "1\n1 2 3\n").unwrap().pslg.points(), [DVec2::new(2.0, 3.0)]);
    assert_eq!(self::input(InputFormat::Poly, "0 2 0 0\n0 0\n0\n").unwrap().pslg, Pslg::default());
}

#[test]
fn other_tools_meshes_are_read() {
    let expected = [[0, 1, 2], [0, 2, 3]];
    let obj = "mtllib x\nv 0 0 5\nv 1 0 5\nvt 0 0\nv 1 1 5 1.0\nv 0 1 5\ng all\nf 1/1/1 2//2 3/4\nf -4 -2 -1\n";
    assert_eq!(mesh(MeshFormat::Obj, obj).unwrap().triangles, expected);
    let ply = "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\nproperty uchar red\n\
               element face 2\nproperty list uchar int vertex_index\nend_header\n0 0 255\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
    assert_eq!(mesh(MeshFormat::Ply, ply).unwrap().triangles, expected);
    let vtk = "# vtk DataFile Version 2.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0\n1 1 0 0 1 0\n\
               CELLS 3 11\n2 0 1\n3 0 1 2\n3 0 2 3\nCELL_TYPES 3\n3\n5\n5\nPOINT_DATA 4\nSCALARS z float\n";
    assert_eq!(mesh(MeshFormat::Vtk, vtk).unwrap().triangles, expected);
    let six = "2 6 1\n1 1 2 3 5 6 7 0.5\n2 1 3 4 8 9 5 0.5\n# Generated by triangle\n";
    assert_eq!(mesh(MeshFormat::Ele, six).unwrap().triangles, expected);
}

#[test]
fn a_line_without_end_is_refused_before_it_fills_memory() {
    let endless = std::io::repeat(b'1').take(1 << 40);
    let error = Input::read_from(Source::new(endless, "x"), InputFormat::Node).unwrap_err();
    assert_eq!((error.kind(), error.place()), ("malformed_file", Some(Place::Line(1))));
}

#[test]
fn cancelling_and_failing_readers_end_the_reading() {
    use std::sync::{Arc, atomic::AtomicBool};
    let cancel = Some(Arc::new(AtomicBool::new(true)));
    let source = Source::new(std::io::repeat(b'\n'), "x").with_cancel(cancel);
    assert_eq!(Input::read_from(source, InputFormat::Poly).unwrap_err().kind(), "cancelled");
    struct Broken;
    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("the disk is on fire"))
        }
    }
    let error = Input::read_from(Source::new(Broken, "x"), InputFormat::Pslg).unwrap_err();
    assert_eq!((error.kind(), error.to_string()), ("io", "x: the disk is on fire".into()));
}

fn valid_files() -> Vec<(bool, usize, Vec<u8>)> {
    let pslg = generate::segments(12, 4, 1);
    let input = Input {
        holes: vec![DVec2::new(0.5, 0.25)],
        regions: vec![Region { point: DVec2::ONE, attribute: 1.0, max_area: Some(2.0) }],
        attributes_per_point: 1,
        attributes: vec![1.5; 12],
        point_markers: Some(vec![1; 12]),
        ..Input::new(pslg, 1)
    };
    let points = input.pslg.points();
    let mesh = Triangulation::from_triangles(12, &[[0, 1, 2], [0, 2, 3], [3, 4, 0]]).unwrap();
    let mut files = vec![(false, 0, vec![]), (false, 1, vec![]), (false, 2, vec![])];
    files.extend((0..5).map(|format| (true, format, vec![])));
    let results = [
        write_node(&mut files[0].2, &input),
        write_poly(&mut files[1].2, &input),
        write_pslg(&mut files[2].2, &input.pslg),
        write_ele(&mut files[3].2, &mesh, 1),
        write_tri(&mut files[4].2, mesh.triangles()),
        write_obj(&mut files[5].2, points, &mesh),
        write_ply(&mut files[6].2, points, &mesh),
        write_vtk(&mut files[7].2, points, &mesh),
    ];
    results.into_iter().for_each(Result::unwrap);
    files
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn random_damage_never_panics(
        which in 0usize..8,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..6), 1..6),
    ) {
        let (is_mesh, format, mut bytes) = valid_files().swap_remove(which);
        for (index, byte, kind) in damage {
            if bytes.is_empty() {
                break;
            }
            let i = index.index(bytes.len());
            match kind {
                0 => bytes[i] = byte,
                1 => bytes[i] = b"0123456789 .-e\n#"[byte as usize % 16],
                2 => { bytes.remove(i); }
                3 => bytes.insert(i, b"9-.e \n"[byte as usize % 6]),
                4 => bytes.truncate(i),
                _ => { let part = bytes[i..].to_vec(); bytes.extend(part); }
            }
        }
        if is_mesh {
            use MeshFormat::*;
            let _ = mesh([Ele, Tri, Obj, Ply, Vtk][format], bytes);
        } else {
            use InputFormat::*;
            let _ = input([Node, Poly, Pslg][format], bytes);
        }
    }
}
