//! The pictures.

use super::{Distribution, Results, Series};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::error::Error;
use std::path::Path;

const BLUE: RGBColor = RGBColor(0x1f, 0x6f, 0xb4);
const ORANGE: RGBColor = RGBColor(0xd9, 0x6c, 0x0b);
const GREEN: RGBColor = RGBColor(0x2a, 0x8f, 0x4f);
const PURPLE: RGBColor = RGBColor(0x84, 0x4f, 0xa8);
const GRAY: RGBColor = RGBColor(0x70, 0x70, 0x70);
const FONT: &str = "sans-serif";

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Drawn = Result<(), Box<dyn Error>>;

/// Flips over intersections: both series with their lines, and all inputs with logarithmic axes.
pub(super) fn flips(results: &Results, path: &Path) -> Result<(), String> {
    let draw = || -> Drawn {
        let root = SVGBackend::new(path, (960, 440)).into_drawing_area();
        root.fill(&WHITE)?;
        let (left, right) = root.split_horizontally(480);
        series(results, &left)?;
        all_inputs(results, &right)?;
        Ok(root.present()?)
    };
    draw().map_err(|error| format!("{}: {error}", path.display()))
}

fn series(results: &Results, area: &Area<'_>) -> Drawn {
    let both = [(&results.more_points, BLUE), (&results.more_constraints, ORANGE)];
    let samples = || both.iter().flat_map(|(series, _)| &series.samples);
    let most = |value: fn(&super::Sample) -> u64| samples().map(value).max().unwrap_or(1) as f64 * 1.1;
    // Room for the legend above.
    let (x, y) = (most(|sample| sample.intersections), 1.4 * most(super::Sample::flips));
    let mut chart = ChartBuilder::on(area)
        .caption("synthetic inputs, with fitted lines", (FONT, 16))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d(0.0..x, 0.0..y)?;
    let count = |n: &f64| if x > 2e6 { format!("{:.0}M", n / 1e6) } else { format!("{:.0}k", n / 1e3) };
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("constraint-triangle intersections")
        .y_desc("flips")
        .x_label_formatter(&count)
        .y_label_formatter(&count)
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 14))
        .draw()?;
    for (Series { name, samples, fit }, color) in both {
        let ends = [0, samples.len() - 1].map(|i| samples[i].intersections as f64);
        chart
            .draw_series(LineSeries::new(ends.map(|x| (x, fit.at(x))), color.stroke_width(1)))?
            .label(format!("{name}: slope {:.2}, R² {:.4}", fit.slope, fit.r_squared))
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, color.filled()));
        let dots = samples.iter().map(|sample| (sample.intersections as f64, sample.flips() as f64));
        chart.draw_series(dots.map(|at| Circle::new(at, 4, color.filled())))?;
        let inserting = samples.iter().map(|sample| (sample.intersections as f64, sample.inserting as f64));
        chart.draw_series(inserting.map(|at| Circle::new(at, 3, color.stroke_width(1))))?;
    }
    chart
        .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
        .label("hollow: the flips that insert, without those after")
        .legend(|(x, y)| Circle::new((x + 8, y), 3, GRAY.stroke_width(1)));
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}

fn all_inputs(results: &Results, area: &Area<'_>) -> Drawn {
    let samples: Vec<_> = [&results.more_points, &results.more_constraints]
        .into_iter()
        .flat_map(|series| &series.samples)
        .chain(&results.others)
        .filter(|sample| sample.intersections > 0)
        .collect();
    let most = samples.iter().map(|sample| sample.intersections.max(sample.flips())).max().unwrap_or(1) as f64 * 3.0;
    let mut chart = ChartBuilder::on(area)
        .caption("all inputs, logarithmic axes", (FONT, 16))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d((10.0..most).log_scale(), (10.0..most).log_scale())?;
    let power = |n: &f64| format!("10{}", superscript(n.log10().round() as u32));
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("constraint-triangle intersections")
        .y_desc("flips")
        .x_label_formatter(&power)
        .y_label_formatter(&power)
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 14))
        .draw()?;
    chart
        .draw_series(LineSeries::new([(10.0, 10.0), (most, most)], GRAY.stroke_width(1)))?
        .label("a flip an intersection")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], GRAY.stroke_width(1)));
    let groups =
        [("synthetic", BLUE), ("square rings", PURPLE), ("all from one point", ORANGE), ("real inputs", GREEN)];
    let group = |set: &str| match set {
        "square rings" => 1,
        "all from one point" => 2,
        _ if set.starts_with("synthetic") || set.ends_with(" constraints") => 0,
        _ => 3,
    };
    for (i, (name, color)) in groups.into_iter().enumerate() {
        let mine = samples.iter().filter(|sample| group(&sample.set) == i);
        let dots = mine.map(|sample| (sample.intersections as f64, sample.flips() as f64));
        chart
            .draw_series(dots.map(|at| Circle::new(at, 4, color.filled())))?
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, color.filled()));
    }
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}

/// How many constraints have how many intersections: a group of bars for each range.
pub(super) fn intersections(results: &Results, path: &Path) -> Result<(), String> {
    let draw = || -> Drawn {
        let sets: Vec<(&Distribution, RGBColor)> = results.distributions.iter().zip([BLUE, GREEN]).collect();
        let bins = sets.iter().max_by_key(|(set, _)| set.bins.len()).map_or(&[][..], |(set, _)| &set.bins);
        let most = sets.iter().flat_map(|(set, _)| &set.bins).map(|bin| bin.constraints).max().unwrap_or(1);
        let root = SVGBackend::new(path, (960, 400)).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(62)
            .build_cartesian_2d(0.0..bins.len() as f64, (0.7..4.0 * most as f64).log_scale())?;
        let power = |n: &f64| format!("10{}", superscript(n.log10().round() as u32));
        chart
            .configure_mesh()
            .disable_x_mesh()
            .x_labels(0)
            .light_line_style(WHITE)
            .y_desc("constraints")
            .y_label_formatter(&power)
            .label_style((FONT, 13))
            .axis_desc_style((FONT, 14))
            .draw()?;
        let width = 0.8 / sets.len().max(1) as f64;
        for (i, &(set, color)) in sets.iter().enumerate() {
            let name = format!("{}: {} intersections, at most {}", set.name, set.intersections, set.most);
            let bar = |(k, bin): (usize, &super::Bin)| {
                let from = k as f64 + 0.1 + width * i as f64;
                Rectangle::new([(from, 0.7), (from + width, bin.constraints as f64)], color.filled())
            };
            let some = set.bins.iter().enumerate().filter(|(_, bin)| bin.constraints > 0);
            chart
                .draw_series(some.map(bar))?
                .label(name)
                .legend(move |(x, y)| Rectangle::new([(x + 2, y - 5), (x + 14, y + 5)], color.filled()));
        }
        let style = (FONT, 13).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Top));
        let (top, bottom) = (chart.plotting_area().get_pixel_range().1.end, 16);
        for (k, bin) in bins.iter().enumerate() {
            let label = match (bin.from, bin.to) {
                (0, _) => "0".into(),
                (1, 2) => "2".into(),
                (from, to) => format!("{from}–{to}"),
            };
            let (x, _) = chart.backend_coord(&(k as f64 + 0.5, 0.7));
            root.draw(&Text::new(label, (x, top + 6), style.clone()))?;
        }
        let (x, _) = chart.backend_coord(&(bins.len() as f64 / 2.0, 0.7));
        let style = (FONT, 14).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Top));
        root.draw(&Text::new("triangles that a constraint runs through", (x, top + 6 + bottom), style))?;
        legend(&mut chart, SeriesLabelPosition::UpperRight)?;
        Ok(root.present()?)
    };
    draw().map_err(|error| format!("{}: {error}", path.display()))
}

fn legend<'a, X, Y>(
    chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>,
    position: SeriesLabelPosition,
) -> Drawn
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let labels = &mut chart.configure_series_labels();
    let style = labels.position(position).background_style(WHITE.mix(0.85)).border_style(GRAY.mix(0.4));
    Ok(style.label_font((FONT, 13)).draw()?)
}

fn superscript(n: u32) -> String {
    let digit = |c: char| c.to_digit(10).and_then(|d| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(d as usize));
    n.to_string().chars().filter_map(digit).collect()
}
