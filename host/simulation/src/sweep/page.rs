//! Report of a sweep as a document: maps of each figure, points of the least and greatest values, and points without a
//! result. Equal sweeps give equal pages.

use super::grid::Grid;
use super::manifest::Manifest;
use super::pictures::{self, MetricPictures};
use super::points::Points;
use super::table::{Status, SweepTable};
use report::document::{
    Block, Document, Text, code, facts, notes, number, numbers, picture, quiet, row, section, strong, table, text,
    words,
};
use report::provenance::VERSION;

/// Largest number of listed points without a result.
const MAX_LISTED_POINTS: usize = 20;

/// The whole report.
pub fn document(manifest: &Manifest, grid: &Grid, points: &Points) -> Document {
    let result = SweepTable::from_points(manifest, grid, points);
    let [whole, diverged, refused] =
        [Status::Whole, Status::Diverged, Status::Refused].map(|status| result.count(status));
    let mut blocks = vec![section("What was swept", sweep_facts(manifest, [whole, diverged, refused]))];
    blocks.push(section("Least and greatest", extremes_table(&result)));
    match pictures::over_one_axis(&result) {
        Some(figure) => blocks.push(section("The figures", vec![picture(figure, Text::default())])),
        None => blocks.extend((0..result.metrics.len()).map(|column| map(&result, column))),
    }
    if diverged + refused > 0 {
        blocks.push(section("Points without a result", failed_points(&result)));
    }
    Document {
        title: format!("Joint {}, swept", manifest.joint),
        heading: text("Joint ") + manifest.joint.as_str() + ", swept",
        subtitle: text(format!("{} points · scheme ", manifest.points)) + strong(manifest.scheme.as_str()),
        blocks,
        footer: text("joint ") + VERSION + " · every point is in points.csv",
        ..Document::default()
    }
}

fn sweep_facts(manifest: &Manifest, [whole, diverged, refused]: [usize; 3]) -> Vec<Block> {
    let mut rows: Vec<(Text, Text)> = vec![("grid".into(), code(manifest.vary.join(" × ")))];
    if !manifest.motion.is_empty() {
        rows.push(("motion".into(), code(manifest.motion.trim())));
    }
    rows.push(("points with a result".into(), number(whole as f64) + quiet(format!(" of {}", manifest.points))));
    let bad = |count: usize| if count > 0 { strong(count.to_string()) } else { number(0.0) };
    rows.push(("diverged: the scheme does not hold the motion".into(), bad(diverged)));
    rows.push(("invalid joint".into(), bad(refused)));
    vec![facts(rows)]
}

fn extremes_table(result: &SweepTable<'_>) -> Vec<Block> {
    let columns = vec![words("Figure"), words("unit"), numbers("least"), notes("at"), numbers("greatest"), notes("at")];
    let rows = (0..result.metrics.len()).map(|column| {
        let metric = result.metrics[column];
        let (name, unit) = (text(pictures::title(metric)), text(pictures::unit(metric).name));
        match result.extremes(column) {
            Some([least, most]) => {
                let value = |point: usize| number(result.values[column][point]);
                let alike = result.values[column][least] == result.values[column][most];
                let place =
                    |point: usize| text(if alike { "everywhere".to_owned() } else { result.position_text(point) });
                row([name, unit, value(least), place(least), value(most), place(most)])
            }
            None => row([name, unit, text("–"), text(""), text("–"), text("")]),
        }
    });
    vec![table(columns, rows.collect())]
}

fn map(result: &SweepTable<'_>, column: usize) -> Block {
    let MetricPictures { figures, left_out, points_a_cell } = pictures::metric_pictures(result, column);
    let mut blocks: Vec<Block> = figures
        .into_iter()
        .map(|(what, figure)| picture(figure, if what.is_empty() { Text::default() } else { code(what) }))
        .collect();
    if points_a_cell > 1 {
        let note =
            format!("A cell stands for up to {points_a_cell} points: their mean, or that one of them has no result.");
        blocks.push(Block::Note(note.into()));
    }
    if left_out > 0 {
        blocks.push(Block::Note(
            format!("{left_out} more maps of this figure are not shown; points.csv has them.").into(),
        ));
    }
    section(pictures::title(result.metrics[column]), blocks)
}

fn failed_points(result: &SweepTable<'_>) -> Vec<Block> {
    let bad: Vec<usize> = (0..result.status.len()).filter(|point| result.status[*point] != Status::Whole).collect();
    let word = |status: Status| if status == Status::Diverged { "diverged" } else { "invalid joint" };
    let rows = bad
        .iter()
        .take(MAX_LISTED_POINTS)
        .map(|point| row([text(word(result.status[*point])), text(result.position_text(*point))]));
    let mut blocks = vec![table(vec![words("status"), notes("at")], rows.collect())];
    if bad.len() > MAX_LISTED_POINTS {
        blocks.push(Block::Note(format!("{} more are in points.csv.", bad.len() - MAX_LISTED_POINTS).into()));
    }
    blocks
}

#[cfg(test)]
mod tests {
    use report::document::html;

    use super::super::metrics::Metric;
    use super::*;

    /// Page of a sweep with given results.
    fn page(vary: &[&str], result: impl Fn(u64) -> String) -> String {
        let vary: Vec<String> = vary.iter().map(ToString::to_string).collect();
        let grid = Grid::parse(&vary, None).expect("a grid");
        let manifest = Manifest {
            schema: String::new(),
            digest: String::new(),
            version: String::new(),
            joint: "J".to_owned(),
            vary,
            points: grid.points,
            metrics: vec![Metric::PeakForceN, Metric::Period],
            scheme: "euler".to_owned(),
            motion: String::new(),
            profile_sha256: None,
            joint_file: String::new(),
        };
        let points: Points = (0..grid.points).map(|point| (point, result(point))).collect();
        html(&document(&manifest, &grid, &points))
    }

    fn figures(page: &str) -> usize {
        page.matches("<svg").count()
    }

    const BACKLASH: &str = "half_backlash_um=0:90:10";
    const DAMPING: &str = "mesh.damping_ratio=0.1,0.2,0.3,0.5";
    const INERTIA: &str = "link_inertia_kg_m2=0.1:2:0.1";

    fn some_fail(point: u64) -> String {
        match point % 10 {
            7 => "diverged,,".to_owned(),
            8 => "refused,,".to_owned(),
            rest => format!("ok,{}.5e1,{}", point * point, rest / 4),
        }
    }

    #[test]
    fn one_axis_gives_lines_with_failures_marked() {
        let page = page(&[BACKLASH], some_fail);
        assert_eq!(figures(&page), 1);
        assert!(page.contains("diverged: 1 of 10 points") && page.contains("invalid joint: 1 of 10 points"));
        assert!(page.contains("half_backlash_um = 70"), "the list of them");
    }

    #[test]
    fn two_axes_give_a_map_per_figure() {
        let page = page(&[BACKLASH, DAMPING], some_fail);
        assert_eq!(figures(&page), 2);
        for shown in ["in N", "var(--class-1)", "var(--class-8)", "var(--limit)", ">diverged<", "mesh.damping_ratio"] {
            assert!(page.contains(shown), "{shown}");
        }
    }

    /// More than two axes give a map for each value of the further axes; the page names maps that are left out.
    #[test]
    fn further_axes_give_a_map_per_value() {
        let page = page(&[BACKLASH, DAMPING, INERTIA], some_fail);
        assert_eq!(figures(&page), 2 * 4, "the two longest are backlash and inertia");
        assert!(page.contains("mesh.damping_ratio = 0.5"));
        let many = self::page(&["mesh.damping_ratio=0.01:0.2:0.01", BACKLASH, INERTIA], some_fail);
        assert_eq!(figures(&many), 2 * 10, "the two longest are damping and inertia");
        let left_out = self::page(&["half_backlash_um=0:13:1", "mesh.damping_ratio=0.01:0.2:0.01", INERTIA], some_fail);
        assert_eq!(figures(&left_out), 2 * 12);
        assert!(left_out.contains("2 more maps of this figure are not shown"));
    }

    #[test]
    fn large_grid_is_drawn_in_cells() {
        let page =
            page(&["half_backlash_um=0:499:1", "link_inertia_kg_m2=0.01:4:0.01"], |point| format!("ok,{point},0"));
        assert!(page.contains("A cell stands for up to 28 points"));
        assert!(page.len() < 6_000_000, "{}", page.len());
    }

    #[test]
    fn sweep_without_results_has_a_page() {
        for vary in [&[BACKLASH][..], &[BACKLASH, DAMPING], &["half_backlash_um=3"]] {
            let page = page(vary, |_| "diverged,,".to_owned());
            assert!(page.contains("diverged"), "{vary:?}");
        }
    }
}
