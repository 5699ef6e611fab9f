use super::{Frame, colors};
use glam::DVec2;
use std::io::{self, Write};

/// An SVG picture in the making: shapes in the order in which they are painted.
#[derive(Clone, Debug)]
pub struct Picture {
    frame: Frame,
    body: Vec<u8>,
}

impl Picture {
    /// An empty picture.
    pub fn new(frame: Frame) -> Self {
        Self { frame, body: Vec::new() }
    }

    /// A filled polygon.
    pub fn polygon(&mut self, corners: &[DVec2], fill: &str) {
        if corners.is_empty() {
            return;
        }
        self.raw("<path fill=\"").raw(fill).raw("\" d=\"");
        for (i, &p) in corners.iter().enumerate() {
            self.raw(if i == 0 { "M" } else { "L" }).at(p);
        }
        self.raw("Z\"/>\n");
    }

    /// Rectangles of one color, each by two opposite corners, without seams between them.
    pub fn rectangles(&mut self, rectangles: impl IntoIterator<Item = [DVec2; 2]>, fill: &str) {
        self.raw("<path shape-rendering=\"crispEdges\" fill=\"").raw(fill).raw("\" d=\"");
        for [p, q] in rectangles {
            self.raw("M").at(p).raw("L").at(DVec2::new(q.x, p.y)).raw("L").at(q).raw("L").at(DVec2::new(p.x, q.y));
            self.raw("Z");
        }
        self.raw("\"/>\n");
    }

    /// Triangles of one color, without seams between them.
    pub fn triangles(&mut self, triangles: impl IntoIterator<Item = [DVec2; 3]>, fill: &str) {
        self.raw("<path fill=\"").raw(fill).raw("\" stroke=\"").raw(fill).raw("\" stroke-width=\".5\" d=\"");
        for [a, b, c] in triangles {
            self.raw("M").at(a).raw("L").at(b).raw("L").at(c).raw("Z");
        }
        self.raw("\"/>\n");
    }

    /// Lines of one color and width, as one path; those too short to be seen are left out.
    pub fn lines(&mut self, lines: impl IntoIterator<Item = [DVec2; 2]>, color: &str, width: f64) {
        let frame = self.frame;
        let head =
            format!("<path fill=\"none\" stroke=\"{color}\" stroke-width=\"{width:.2}\" stroke-linecap=\"round\" d=\"");
        self.raw(&head);
        for ends in lines {
            let [a, b] = ends.map(|p| hundredths(frame.map(p)));
            if a != b {
                self.body.push(b'M');
                push_position(&mut self.body, a);
                self.body.push(b'l');
                push_position(&mut self.body, [b[0] - a[0], b[1] - a[1]]);
            }
        }
        self.raw("\"/>\n");
    }

    /// Dots of one color and radius: a path of round ends.
    pub fn dots(&mut self, points: impl IntoIterator<Item = DVec2>, color: &str, radius: f64) {
        let head =
            format!("<path stroke=\"{color}\" stroke-width=\"{:.2}\" stroke-linecap=\"round\" d=\"", 2.0 * radius);
        self.raw(&head);
        for p in points {
            self.raw("M").at(p).raw("h0");
        }
        self.raw("\"/>\n");
    }

    /// Any SVG elements, in the units of the picture.
    pub fn raw(&mut self, svg: &str) -> &mut Self {
        self.body.extend_from_slice(svg.as_bytes());
        self
    }

    fn at(&mut self, p: DVec2) -> &mut Self {
        let p = hundredths(self.frame.map(p));
        push_position(&mut self.body, p);
        self
    }

    /// The frame.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Writes the picture; the title is what a browser shows.
    ///
    /// # Errors
    ///
    /// What `out` says.
    pub fn write(&self, out: &mut dyn Write, title: &str) -> io::Result<()> {
        let (w, h) = (self.frame.width, self.frame.height);
        writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w:.2} {h:.2}\" width=\"{w:.0}\" height=\"{h:.0}\">"
        )?;
        let title = title.replace('&', "&amp;").replace('<', "&lt;");
        writeln!(out, "<title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>", colors::PAPER)?;
        out.write_all(&self.body)?;
        writeln!(out, "</svg>")
    }
}

fn hundredths(p: DVec2) -> [i64; 2] {
    [p.x, p.y].map(|x| (100.0 * x).round() as i64)
}

/// Two numbers with two decimals, without needless zeros.
fn push_position(out: &mut Vec<u8>, p: [i64; 2]) {
    for (i, x) in p.into_iter().enumerate() {
        if x < 0 {
            out.push(b'-');
        } else if i == 1 {
            out.push(b' ');
        }
        let (whole, part) = (x.unsigned_abs() / 100, x.unsigned_abs() % 100);
        out.extend_from_slice(whole.to_string().as_bytes());
        if part > 0 {
            out.push(b'.');
            out.push(b'0' + (part / 10) as u8);
            if !part.is_multiple_of(10) {
                out.push(b'0' + (part % 10) as u8);
            }
        }
    }
}
