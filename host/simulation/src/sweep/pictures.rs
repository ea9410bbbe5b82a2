//! Pictures of a sweep: over one axis each figure as points on a line, over two as a map in classes, over more as maps
//! of the two longest axes for every value of the others. Points without a result are marked.

use super::metrics::Metric;
use super::table::{NumberedAxis, Status, SweepTable};
use report::number::{PAGE, Style};
use report::panels::line;
use report::plot::Figure;
use report::plot::ink::{CLASSES, Ink};
use report::plot::mark::Mark;
use report::plot::panel::{Panel, VerticalAxis};
use report::plot::unit::Unit;

/// Largest number of cells of a map across and up; with more points a cell covers several.
const MAX_CELLS: [usize; 2] = [128, 64];
/// Largest number of maps of one figure, for values of the other axes.
const MAX_MAPS: usize = 12;
/// Height of a map [px].
const MAP_HEIGHT: i32 = 330;
/// Largest number of values that are drawn as points on the line.
const MAX_DRAWN_POINTS: usize = 150;
/// Ratio of greatest to least value above which classes are logarithmic [-].
const LOG_CLASS_RATIO: f64 = 1000.0;

/// Unit of an axis; the keys contain their units.
const AXIS_UNIT: Unit = Unit { factor: 1.0, name: "" };

/// Kinds of points without a result.
const FAILURE_INKS: [(Status, Ink, &str); 2] =
    [(Status::Diverged, Ink::Limit, "diverged"), (Status::Refused, Ink::Reference, "invalid joint")];

/// Pictures of one figure, and the number of maps that are not shown.
pub struct MetricPictures {
    /// Pictures, each with the values of its fixed axes.
    pub figures: Vec<(String, Figure)>,
    /// Number of maps that are not shown.
    pub left_out: usize,
    /// Points in a cell.
    pub points_a_cell: usize,
}

/// Axes from the longest to the shortest.
fn by_length(table: &SweepTable<'_>) -> Vec<usize> {
    let mut order: Vec<usize> = (0..table.axes.len()).collect();
    order.sort_by_key(|axis| std::cmp::Reverse(table.axes[*axis].words.len()));
    order
}

/// All columns over the axis, if only one axis has more than one value.
pub fn over_one_axis(table: &SweepTable<'_>) -> Option<Figure> {
    if table.axes.iter().filter(|axis| axis.words.len() > 1).count() > 1 {
        return None;
    }
    let axis = &table.axes[by_length(table)[0]];
    let panels = (0..table.metrics.len()).map(|column| lines(table, column, axis)).collect();
    let range = (axis.edges()[0], axis.edges()[axis.values.len()]);
    Some(picture(format!("All figures over {}", axis.key), axis, panels, range))
}

/// Maps of a column over the two longest axes; the first one on the command line is horizontal.
pub fn metric_pictures(table: &SweepTable<'_>, column: usize) -> MetricPictures {
    let order = by_length(table);
    let other = order.get(1).copied().unwrap_or(order[0]);
    maps(table, column, order[0].min(other), order[0].max(other))
}

/// One column over one axis.
fn lines(table: &SweepTable<'_>, column: usize, axis: &NumberedAxis<'_>) -> Panel {
    let metric = table.metrics[column];
    let values = &table.values[column];
    let mut points: Vec<(f64, f64)> =
        (0..values.len()).map(|point| (axis.values[axis.index(point)], values[point])).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let finite: Vec<(f64, f64)> = points.iter().copied().filter(|point| point.1.is_finite()).collect();
    let (low, high) = finite
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| (low.min(point.1), high.max(point.1)));
    let mut marks = Vec::new();
    if !is_class(metric) {
        marks.push(line(points, Ink::First, ""));
    }
    if finite.len() <= MAX_DRAWN_POINTS || is_class(metric) {
        marks.push(Mark::Points { points: finite, ink: Ink::First, label: String::new(), size: 4.5 });
    }
    marks.extend(strips(table, axis, (low, high)));
    Panel { height: 190, ..Panel::lines(title(metric), unit(metric), marks) }
}

/// Points without a result, as strips below the others.
fn strips(table: &SweepTable<'_>, axis: &NumberedAxis<'_>, (low, high): (f64, f64)) -> Vec<Mark> {
    let (low, span) = if low <= high { (low, (high - low).max(0.1 * high.abs()).max(1e-12)) } else { (0.0, 1.0) };
    let edges = axis.edges();
    let strip = |(status, ink, label): (Status, Ink, &str)| {
        let mut cells: Vec<usize> = (0..table.status.len())
            .filter(|point| table.status[*point] == status)
            .map(|point| axis.cell(axis.index(point)))
            .collect();
        cells.sort_unstable();
        let mut boxes: Vec<[f64; 4]> = Vec::new();
        for cell in &cells {
            let [from, to] = [edges[*cell], edges[cell + 1]];
            match boxes.last_mut() {
                Some(last) if last[1] == from => last[1] = to,
                _ => boxes.push([from, to, low - 0.12 * span, low - 0.05 * span]),
            }
        }
        let label = format!("{label}: {} of {} points", cells.len(), table.status.len());
        (!boxes.is_empty()).then_some(Mark::Boxes { boxes, ink, label })
    };
    FAILURE_INKS.into_iter().filter_map(strip).collect()
}

/// Maps over two axes, one for every value of the others.
fn maps(table: &SweepTable<'_>, column: usize, across: usize, up: usize) -> MetricPictures {
    let metric = table.metrics[column];
    let scale = Scale::new(metric, &table.values[column]);
    let others: Vec<usize> = (0..table.axes.len()).filter(|axis| ![across, up].contains(axis)).collect();
    let [wide, high] = [across, up].map(|axis| &table.axes[axis]);
    let group = [wide.words.len().div_ceil(MAX_CELLS[0]), high.words.len().div_ceil(MAX_CELLS[1])];
    let all: usize = others.iter().map(|axis| table.axes[*axis].words.len()).product();
    let mut cells = vec![Map::new(wide, high, group); all.min(MAX_MAPS)];
    for point in 0..table.status.len() {
        let number = others.iter().fold(0, |number, axis| {
            let axis = &table.axes[*axis];
            number * axis.words.len() + axis.index(point)
        });
        if let Some(map) = cells.get_mut(number) {
            map.add(wide.cell(wide.index(point)), high.cell(high.index(point)), table, column, point);
        }
    }
    let figures = cells.iter().enumerate().map(|(number, map)| {
        let mut rest = number;
        let mut fixed: Vec<String> = Vec::new();
        for axis in others.iter().rev() {
            let axis = &table.axes[*axis];
            fixed.push(format!("{} = {}", axis.key, axis.words[rest % axis.words.len()]));
            rest /= axis.words.len();
        }
        fixed.reverse();
        let unit = unit(metric).name;
        let in_unit = if unit.is_empty() { String::new() } else { format!("in {unit}") };
        let panel = Panel {
            title: if high.by_index { format!("{in_unit} {}", places(high)) } else { in_unit },
            unit: AXIS_UNIT,
            height: MAP_HEIGHT,
            marks: map.marks(&scale, wide, high),
            axis: VerticalAxis::Named(high.key.to_owned()),
        };
        let range = (wide.edges()[0], wide.edges()[wide.values.len()]);
        let title = format!("{} over {} and {}", title(metric), wide.key, high.key);
        (fixed.join(", "), picture(title, wide, vec![panel], range))
    });
    MetricPictures {
        figures: figures.collect(),
        left_out: all.saturating_sub(MAX_MAPS),
        points_a_cell: group[0] * group[1],
    }
}

/// Cells of a map with the sums of their points.
#[derive(Debug, Clone)]
struct Map {
    group: [usize; 2],
    width: usize,
    cells: Vec<Cell>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Cell {
    sum: f64,
    count: usize,
    without: Option<Status>,
}

impl Map {
    fn new(wide: &NumberedAxis<'_>, high: &NumberedAxis<'_>, group: [usize; 2]) -> Self {
        let width = wide.words.len().div_ceil(group[0]);
        Self { group, width, cells: vec![Cell::default(); width * high.words.len().div_ceil(group[1])] }
    }

    fn add(&mut self, x: usize, y: usize, table: &SweepTable<'_>, column: usize, point: usize) {
        let place = y / self.group[1] * self.width + x / self.group[0];
        let (cell, value) = (&mut self.cells[place], table.values[column][point]);
        if table.status[point] != Status::Whole {
            cell.without = cell.without.max(Some(table.status[point]));
        } else if value.is_finite() {
            cell.sum += value;
            cell.count += 1;
        }
    }

    /// Boxes of each class, with adjacent cells of a class merged; a cell with a failed point counts as failed.
    fn marks(&self, scale: &Scale, wide: &NumberedAxis<'_>, high: &NumberedAxis<'_>) -> Vec<Mark> {
        let edges = [(wide, self.group[0]), (high, self.group[1])].map(|(axis, group)| {
            let all = axis.edges();
            let mut edges: Vec<f64> = all[..all.len() - 1].iter().step_by(group).copied().collect();
            edges.push(all[all.len() - 1]);
            edges
        });
        let kind = |cell: &Cell| match cell.without {
            Some(status) => FAILURE_INKS.iter().position(|(known, ..)| *known == status).map(Kind::Without),
            None if cell.count == 0 => None,
            None => Some(Kind::Class(scale.class(cell.sum / cell.count as f64))),
        };
        let mut boxes: Vec<(Kind, [f64; 4])> = Vec::new();
        for (y, row) in self.cells.chunks(self.width).enumerate() {
            for (x, cell) in row.iter().enumerate() {
                let Some(kind) = kind(cell) else { continue };
                let [left, right, low, up] = [edges[0][x], edges[0][x + 1], edges[1][y], edges[1][y + 1]];
                match boxes.last_mut() {
                    Some((known, last)) if *known == kind && last[1] == left && last[2] == low => last[1] = right,
                    _ => boxes.push((kind, [left, right, low, up])),
                }
            }
        }
        let of = |wanted: Kind| boxes.iter().filter(|(kind, _)| *kind == wanted).map(|(_, one)| *one).collect();
        // Every class is in the legend, so that all maps of one figure share a scale.
        let classes = (0..scale.classes()).map(|class| Mark::Boxes {
            boxes: of(Kind::Class(class)),
            ink: scale.ink(class),
            label: scale.label(class),
        });
        let without = FAILURE_INKS.iter().enumerate().map(|(place, (_, ink, label))| Mark::Boxes {
            boxes: of(Kind::Without(place)),
            ink: *ink,
            label: (*label).to_owned(),
        });
        let is_there = |mark: &Mark| matches!(mark, Mark::Boxes { boxes, .. } if !boxes.is_empty());
        classes.chain(without.filter(is_there)).collect()
    }
}

/// Content of a drawn cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Class(usize),
    Without(usize),
}

/// Classes of values, by their lower ends.
struct Scale {
    ends: Vec<f64>,
    /// True if each value is a class of its own.
    single: bool,
}

impl Scale {
    fn new(metric: Metric, values: &[f64]) -> Self {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        if low > high {
            return Self { ends: Vec::new(), single: false };
        }
        if is_class(metric) || low == high {
            let mut ends: Vec<f64> = finite().collect();
            ends.sort_by(f64::total_cmp);
            ends.dedup();
            if ends.len() <= CLASSES.len() {
                return Self { ends, single: true };
            }
        }
        let count = CLASSES.len() as f64;
        let share = |class: usize| class as f64 / count;
        let end = |class: usize| match low > 0.0 && high / low > LOG_CLASS_RATIO {
            true => low * (high / low).powf(share(class)),
            false => low + (high - low) * share(class),
        };
        Self { ends: (0..CLASSES.len()).map(end).collect(), single: false }
    }

    fn classes(&self) -> usize {
        self.ends.len()
    }

    /// Class of a value: the last one that begins at or below it.
    fn class(&self, value: f64) -> usize {
        self.ends.partition_point(|end| *end <= value).saturating_sub(1)
    }

    /// Colour of a class; few classes are spread over all colours.
    fn ink(&self, class: usize) -> Ink {
        let steps = (self.ends.len().max(2) - 1) as f64;
        CLASSES[(class as f64 / steps * (CLASSES.len() - 1) as f64).round() as usize]
    }

    fn label(&self, class: usize) -> String {
        let end = LEGEND.write(self.ends[class]);
        if self.single { end } else { format!("≥ {end}") }
    }
}

/// Number format of a legend, which has little room.
const LEGEND: Style =
    Style { digits: report::number::Digits::Significant { count: 3, from: 1e-3, below: 1e6, decimals: 1 }, ..PAGE };

/// Returns true for figures whose whole-number values are classes.
fn is_class(metric: Metric) -> bool {
    metric == Metric::Period
}

/// Title of a column on a page.
pub fn title(metric: Metric) -> &'static str {
    match metric {
        Metric::SunDeflectionPeakToPeakUm => "Sun–planet deflection, peak to peak",
        Metric::SunDeflectionRmsUm => "Sun–planet deflection, RMS about its mean",
        Metric::RingDeflectionPeakToPeakUm => "Ring–planet deflection, peak to peak",
        Metric::RingDeflectionRmsUm => "Ring–planet deflection, RMS about its mean",
        Metric::SeparatedShare => "Share of time with teeth separated",
        Metric::BackSideShare => "Share of time on the back side",
        Metric::ImpactsPerS => "Landings of all meshes in a second",
        Metric::PeakForceN => "Greatest mesh force",
        Metric::Period => "Mesh periods after which the motion repeats; 0: not within 32",
    }
}

/// Unit of a column's values.
pub fn unit(metric: Metric) -> Unit {
    let name = match metric {
        Metric::SunDeflectionPeakToPeakUm
        | Metric::SunDeflectionRmsUm
        | Metric::RingDeflectionPeakToPeakUm
        | Metric::RingDeflectionRmsUm => "µm",
        Metric::ImpactsPerS => "1/s",
        Metric::PeakForceN => "N",
        Metric::SeparatedShare | Metric::BackSideShare | Metric::Period => "",
    };
    Unit { factor: 1.0, name }
}

fn picture(title: String, axis: &NumberedAxis<'_>, panels: Vec<Panel>, range: (f64, f64)) -> Figure {
    let note = if axis.by_index { places(axis) } else { String::new() };
    Figure { note, ..Figure::new(title, axis.key, AXIS_UNIT, range, panels) }
}

/// Legend of the places on an axis without numbers.
fn places(axis: &NumberedAxis<'_>) -> String {
    let words = axis.words.iter().zip(1..).take(12).map(|(word, place)| format!("{place} {word}"));
    format!("{}: {}", axis.key, words.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_cover_the_range() {
        for values in [vec![3.0, 11.0, 5.5], vec![1e-3, 1.0, 10.0], vec![-2.0, 6.0, 0.0]] {
            let scale = Scale::new(Metric::PeakForceN, &values);
            assert_eq!(scale.classes(), CLASSES.len());
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert_eq!([scale.class(low), scale.class(high)], [0, CLASSES.len() - 1]);
        }
        // Over many decades the classes are ratios.
        assert_eq!(Scale::new(Metric::PeakForceN, &[1e-3, 1.0, 10.0]).class(1.0), 6);
    }

    #[test]
    fn few_integers_get_own_classes() {
        let scale = Scale::new(Metric::Period, &[0.0, 3.0, 1.0, 3.0, f64::NAN]);
        assert_eq!((0..scale.classes()).map(|class| scale.label(class)).collect::<Vec<_>>(), ["0", "1", "3"]);
        assert_eq!([scale.ink(0), scale.ink(2)], [CLASSES[0], CLASSES[7]]);
    }
}
