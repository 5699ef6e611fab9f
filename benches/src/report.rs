//! The tables.

use crate::inputs::Input;
use crate::machine::Machine;
use crate::memory;
use crate::timing;
use serde::Serialize;

#[derive(Debug, Serialize)]
pub(crate) struct Results {
    machine: Machine,
    points: usize,
    runs: usize,
    pub(crate) peers: Vec<timing::Comparison>,
    pub(crate) degenerate: Vec<Vec<timing::Ratio>>,
    pub(crate) memory: Vec<memory::Comparison>,
    pub(crate) constrained: Option<crate::gpu::constrained::Results>,
    pub(crate) delaunay: Option<crate::gpu::delaunay::Results>,
    pub(crate) voronoi: Option<crate::gpu::voronoi::Results>,
    pub(crate) figures: Option<crate::figures::Results>,
}

impl Results {
    pub(crate) fn new(points: usize, runs: usize) -> Self {
        let (peers, degenerate, memory) = (Vec::new(), Vec::new(), Vec::new());
        Self {
            machine: Machine::this(),
            points,
            runs,
            peers,
            degenerate,
            memory,
            constrained: None,
            delaunay: None,
            voronoi: None,
            figures: None,
        }
    }

    pub(crate) fn print_json(&self) {
        match serde_json::to_string_pretty(self) {
            Ok(text) => println!("{text}"),
            Err(error) => eprintln!("bench: {error}"),
        }
    }

    pub(crate) fn print(&self) {
        let Machine { cores, processor, version, commit } = &self.machine;
        println!("polder {version} ({commit}) on {cores} cores of {processor}; median of {} runs", self.runs);
        if !self.peers.is_empty() {
            println!(
                "\nSeconds, and in brackets the ratio to spade; * where the number of triangles differs from ours"
            );
            let rows = self.peers.iter().map(|case| {
                let cell = |time: &timing::Time| {
                    let ratio = time.to_spade.map_or(String::new(), |ratio| format!(" ({ratio:.2})"));
                    let mark = if time.same_count { "" } else { "*" };
                    (time.program.clone(), format!("{:.3}{ratio}{mark}", time.seconds))
                };
                (label(case.input, case.points), case.times.iter().map(cell).collect())
            });
            table(rows.collect());
        }
        if !self.degenerate.is_empty() {
            println!("\nSeconds, and in brackets the ratio to a uniform input of the same size");
            let rows = self.degenerate.iter().filter_map(|case| {
                let cell =
                    |r: &timing::Ratio| (format!("polder-{}", r.threads), format!("{:.3} ({:.2})", r.seconds, r.ratio));
                let first = case.first()?;
                Some((label(first.input, first.points), case.iter().map(cell).collect()))
            });
            table(rows.collect());
        }
        if !self.memory.is_empty() {
            println!("\nPeak bytes a point beyond the input");
            let rows = self.memory.iter().map(|case| {
                let cell = |peak: &memory::Peak| (peak.program.clone(), format!("{:.0}", peak.bytes_a_point));
                (label(case.input, case.points), case.peaks.iter().map(cell).collect())
            });
            table(rows.collect());
        }
        if let Some(delaunay) = &self.delaunay {
            delaunay.print();
        }
        if let Some(constrained) = &self.constrained {
            constrained.print();
        }
        if let Some(voronoi) = &self.voronoi {
            voronoi.print();
        }
        if let Some(figures) = &self.figures {
            figures.print();
        }
    }
}

fn label(input: Input, points: usize) -> String {
    format!("{} ({points})", input.name())
}

/// Prints rows of named cells; the columns are the names in the order in which they come up.
fn table(rows: Vec<(String, Vec<(String, String)>)>) {
    let mut columns: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flat_map(|(_, cells)| cells) {
        if !columns.contains(&name.as_str()) {
            columns.push(name);
        }
    }
    let first = rows.iter().map(|(label, _)| label.len()).max().unwrap_or(0);
    let line = |label: &str, cells: Vec<&str>| {
        let cells: String = cells.iter().map(|cell| format!("  {cell:>14}")).collect();
        println!("{label:first$}{cells}");
    };
    line("", columns.clone());
    for (label, cells) in &rows {
        let cell = |column: &&str| cells.iter().find(|(name, _)| name == column).map_or("-", |(_, text)| text);
        line(label, columns.iter().map(cell).collect());
    }
}
