//! Lemmas of [CET] 3.2: what monotonic paths enclose.

use super::Case;
use crate::cases::{Random, neighbors, pixels};

/// Lasso Lemma: a monotonic path from a site to a pixel, closed by the straight line back, encloses no site.
pub(crate) fn lasso(case: &Case) -> Result<(), String> {
    let mut random = Random(1);
    for pixel in pixels(case.sites.size) {
        let Some(loop_) = monotonic_path(case, pixel, &mut random) else { continue };
        if let Some(site) = enclosed(case, &loop_) {
            return Err(format!("the lasso to pixel {pixel:?} encloses site {site:?}"));
        }
    }
    Ok(())
}

/// Spliced Lasso Lemma: two monotonic paths to neighboring pixels of different colors, closed by the straight line
/// between the sites, enclose no site. Two pixels that share but a corner count if the other two pixels there differ.
pub(crate) fn spliced_lasso(case: &Case) -> Result<(), String> {
    let mut random = Random(2);
    for a in pixels(case.sites.size) {
        for d in neighbors(case.sites.size, a) {
            let across = [[a[0], d[1]], [d[0], a[1]]].map(|pixel| case.diagram.color(pixel));
            let is_diagonal = a[0] != d[0] && a[1] != d[1];
            if d < a || case.diagram.color(a) == case.diagram.color(d) || is_diagonal && across[0] == across[1] {
                continue;
            }
            let paths = [a, d].map(|pixel| monotonic_path(case, pixel, &mut random));
            let [Some(mut loop_), Some(back)] = paths else { continue };
            loop_.reverse();
            loop_.extend(back);
            if let Some(site) = enclosed(case, &loop_) {
                return Err(format!("the spliced lasso through pixels {a:?} and {d:?} encloses site {site:?}"));
            }
        }
    }
    Ok(())
}

/// A monotonic path from a pixel back to its site, by predecessors taken at random.
fn monotonic_path(case: &Case, pixel: [u16; 2], random: &mut Random) -> Option<Vec<[u16; 2]>> {
    let site = case.site(case.diagram.color(pixel));
    let mut path = vec![pixel];
    let mut at = pixel;
    while at != site {
        let choices = case.predecessors(at);
        if choices.is_empty() {
            return None;
        }
        at = choices[random.below(choices.len())];
        path.push(at);
    }
    Some(path)
}

/// A site strictly inside a closed polygon: one that it winds around.
fn enclosed(case: &Case, polygon: &[[u16; 2]]) -> Option<[u16; 2]> {
    let bound = |k: usize| (polygon.iter().map(|p| p[k]).min().unwrap(), polygon.iter().map(|p| p[k]).max().unwrap());
    let ((left, right), (low, high)) = (bound(0), bound(1));
    let in_box = |[x, y]: [u16; 2]| left < x && x < right && low < y && y < high;
    let sites = case.sites.pixels[..case.sites.count].iter().copied();
    sites.filter(|&site| in_box(site)).find(|&site| winding(polygon, site).is_some_and(|turns| turns != 0))
}

/// How often a closed polygon winds around a point; `None` on the polygon itself.
fn winding(polygon: &[[u16; 2]], point: [u16; 2]) -> Option<i32> {
    let shifted = |p: [u16; 2]| [i64::from(p[0]) - i64::from(point[0]), i64::from(p[1]) - i64::from(point[1])];
    let mut turns = 0;
    for (i, &from) in polygon.iter().enumerate() {
        let (a, b) = (shifted(from), shifted(polygon[(i + 1) % polygon.len()]));
        let turn = a[0] * b[1] - a[1] * b[0];
        if turn == 0 && a[0] * b[0] + a[1] * b[1] <= 0 {
            return None;
        }
        if a[1] <= 0 && b[1] > 0 && turn > 0 {
            turns += 1;
        } else if a[1] > 0 && b[1] <= 0 && turn < 0 {
            turns -= 1;
        }
    }
    Some(turns)
}

#[test]
fn winding_numbers() {
    let square = [[0, 0], [4, 0], [4, 4], [0, 4]];
    assert_eq!(winding(&square, [2, 2]), Some(1));
    assert_eq!(winding(&square, [5, 2]), None.or(Some(0)));
    assert_eq!(winding(&square, [4, 2]), None);
    assert_eq!(winding(&[[0, 4], [4, 4], [4, 0], [0, 0]], [1, 3]), Some(-1));
    // A line there and back encloses nothing.
    assert_eq!(winding(&[[0, 0], [4, 1]], [2, 1]), Some(0));
}
