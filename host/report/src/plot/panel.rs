//! A panel: title and legend above the plot, where they cover no data, axes with units, and marks. The marks determine
//! the ranges.

use plotters::coord::ranged1d::ValueFormatter;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{Area, CommonAxis, Drawn, FINE, HorizontalAxis, RIGHT, text_style};
use super::ink::Ink;
use super::mark::Mark;
use super::thin::thin;
use super::unit::{Unit, axis_range, tick_label};
use crate::number::PAGE;

/// Height of title and legend [px].
const HEAD_HEIGHT: i32 = 34;
/// Distance between a panel and the next title [px].
const PANEL_GAP: i32 = 10;

/// A panel of a [`Figure`](super::Figure).
pub struct Panel {
    /// Name of the quantity.
    pub title: String,
    /// Unit of the vertical axis.
    pub unit: Unit,
    /// Height including the title [px].
    pub height: i32,
    /// Marks in drawing order; values in SI.
    pub marks: Vec<Mark>,
    /// Scale of the vertical axis.
    pub axis: VerticalAxis,
}

/// Scale of the vertical axis.
#[derive(Debug, Clone, PartialEq)]
pub enum VerticalAxis {
    /// Linear, over the range of the marks with a margin.
    Linear,
    /// Logarithmic from below one, for counts.
    Counts,
    /// Logarithmic; values that are not positive or below the range are drawn at its lower end.
    Decades {
        /// Exponent of the lowest power.
        from: i32,
        /// Exponent of the highest power.
        to: i32,
    },
    /// Linear, over exactly the range of the marks, with the name of the quantity.
    Named(String),
    /// One row for each name, top first, without numbers.
    Rows(Vec<String>),
}

impl Panel {
    /// Panel of lines with the default height.
    pub fn lines(title: impl Into<String>, unit: Unit, marks: Vec<Mark>) -> Self {
        Self { title: title.into(), unit, height: 210, marks, axis: VerticalAxis::Linear }
    }

    /// Draws the panel; the last panel of a figure has the numbers of the common axis.
    pub fn draw(&self, area: &Area<'_>, common: &CommonAxis<'_>, last: bool) -> Drawn {
        self.draw_head(area, common)?;
        let horizontal = (common.across(common.range.0), common.across(common.range.1));
        let mut builder = ChartBuilder::on(area);
        builder
            .margin_top(HEAD_HEIGHT * FINE)
            .margin_right(RIGHT * FINE)
            .set_label_area_size(LabelAreaPosition::Left, common.shape.left * FINE);
        builder.set_label_area_size(LabelAreaPosition::Bottom, if last { 42 } else { PANEL_GAP } * FINE);
        let (low, high) = match &self.axis {
            VerticalAxis::Rows(rows) => (0.0, rows.len() as f64),
            VerticalAxis::Decades { from, to } => (f64::from(*from), f64::from(*to)),
            VerticalAxis::Named(_) => {
                let values = self.marks.iter().flat_map(Mark::values).map(|value| value * self.unit.factor);
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
            }
            _ => axis_range(self.marks.iter().flat_map(Mark::values).map(|value| value * self.unit.factor)),
        };
        if self.axis == VerticalAxis::Counts {
            let top = high.max(10.0) * 1.5;
            let mut chart = builder.build_cartesian_2d(horizontal.0..horizontal.1, (0.5..top).log_scale())?;
            self.draw_inside(&mut chart, common, (0.5, top), last, &|count| power_of_ten(*count))
        } else {
            let mut chart = builder.build_cartesian_2d(horizontal.0..horizontal.1, low..high)?;
            let decades = matches!(self.axis, VerticalAxis::Decades { .. });
            let label = |value: &f64| if decades { exponent_label(*value) } else { tick_label(*value, high - low) };
            self.draw_inside(&mut chart, common, (low, high), last, &label)?;
            self.draw_row_names(area, common)
        }
    }

    /// Draws the title at the left and the legend at the right.
    fn draw_head(&self, area: &Area<'_>, common: &CommonAxis<'_>) -> Drawn {
        let at = |x: i32, y: i32| (x * FINE, y * FINE);
        let title = text_style(13, Ink::Text, FontStyle::Bold);
        area.draw(&Text::new(self.title.clone(), at(common.shape.left, 12), title))?;
        let mut right = common.shape.width - RIGHT;
        for mark in self.marks.iter().rev() {
            let (label, ink) = mark.label();
            if label.is_empty() {
                continue;
            }
            right -= text_width(label);
            area.draw(&Text::new(label.to_owned(), at(right, 14), text_style(11, Ink::Muted, FontStyle::Normal)))?;
            right -= 22;
            let swatch = ink.colour();
            match mark {
                Mark::Points { .. } => {
                    area.draw(&Rectangle::new([at(right + 6, 17), at(right + 11, 22)], swatch.filled()))?;
                }
                Mark::Band { .. } | Mark::Boxes { .. } => {
                    area.draw(&Rectangle::new([at(right, 14), at(right + 16, 24)], swatch.filled()))?;
                }
                _ => {
                    let ends = vec![at(right, 19), at(right + 16, 19)];
                    area.draw(&PathElement::new(ends, swatch.stroke_width(2 * FINE as u32)))?;
                }
            }
            right -= 16;
        }
        Ok(())
    }

    /// Draws bands below the grid, and all other marks above it.
    fn draw_inside<Y: VerticalScale>(
        &self,
        chart: &mut Chart<'_, '_, Y>,
        common: &CommonAxis<'_>,
        vertical: (f64, f64),
        last: bool,
        vertical_label: &dyn Fn(&f64) -> String,
    ) -> Drawn {
        let is_band = |mark: &&Mark| matches!(mark, Mark::Band { .. });
        self.marks.iter().filter(is_band).try_for_each(|mark| self.draw_mark(mark, chart, common, vertical))?;
        self.draw_mesh(chart, common, last, vertical_label)?;
        self.marks
            .iter()
            .filter(|mark| !is_band(mark))
            .try_for_each(|mark| self.draw_mark(mark, chart, common, vertical))
    }

    fn draw_mesh<Y: VerticalScale>(
        &self,
        chart: &mut Chart<'_, '_, Y>,
        common: &CommonAxis<'_>,
        last: bool,
        vertical_label: &dyn Fn(&f64) -> String,
    ) -> Drawn {
        let span = common.across(common.range.1) - common.across(common.range.0);
        let horizontal_label = |value: &f64| match common.runs {
            _ if !last => String::new(),
            HorizontalAxis::Linear => tick_label(*value, span),
            HorizontalAxis::Decades => exponent_label(*value),
        };
        let fine = FINE as u32;
        let mut mesh = chart.configure_mesh();
        mesh.axis_style(Ink::Axis.colour().stroke_width(fine))
            .bold_line_style(Ink::Grid.colour().stroke_width(fine))
            .light_line_style(TRANSPARENT)
            .label_style(text_style(11, Ink::Muted, FontStyle::Normal))
            .axis_desc_style(text_style(12, Ink::Muted, FontStyle::Normal))
            .x_labels((common.shape.width / 90).max(4) as usize)
            .y_labels(6)
            .x_label_formatter(&horizontal_label)
            .y_label_formatter(&vertical_label)
            .set_all_tick_mark_size(3 * FINE);
        if last {
            mesh.x_desc(match common.unit.name {
                "" => common.name.to_owned(),
                unit => format!("{} [{unit}]", common.name),
            });
        }
        match &self.axis {
            VerticalAxis::Rows(_) => mesh.disable_mesh().y_labels(0),
            VerticalAxis::Named(name) => mesh.y_desc(name),
            _ => mesh.y_desc(self.unit.name),
        };
        mesh.draw()?;
        Ok(())
    }

    fn draw_mark<Y: VerticalScale>(
        &self,
        mark: &Mark,
        chart: &mut Chart<'_, '_, Y>,
        common: &CommonAxis<'_>,
        vertical: (f64, f64),
    ) -> Drawn {
        let across = |value: f64| common.across(value);
        let up = |value: f64| match self.axis {
            VerticalAxis::Decades { from, .. } => (value * self.unit.factor).log10().max(f64::from(from)),
            _ => value * self.unit.factor,
        };
        let horizontal = (across(common.range.0), across(common.range.1));
        let columns = (common.shape.width - common.shape.left - RIGHT) as usize;
        let clip = |value: f64| value.clamp(vertical.0, vertical.1);
        let filled = mark.label().1.colour().filled();
        match mark {
            Mark::Line { points, ink, width, .. } => {
                let style = ink.colour().stroke_width((width * f64::from(FINE)) as u32);
                let scaled: Vec<_> = points.iter().map(|(x, y)| (across(*x), up(*y))).collect();
                for stretch in thin(&scaled, horizontal, columns) {
                    chart.draw_series(LineSeries::new(stretch.into_iter().map(|(x, y)| (x, clip(y))), style))?;
                }
            }
            Mark::Points { points, size, .. } => {
                let (low, high) = (-(size * f64::from(FINE) / 2.0) as i32, (size * f64::from(FINE) / 2.0) as i32);
                let finite = points.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
                chart.draw_series(finite.map(|(x, y)| {
                    let spot = Rectangle::new([(low, low), (high, high)], filled);
                    EmptyElement::at((across(*x), clip(up(*y)))) + spot
                }))?;
            }
            Mark::Band { range, .. } => {
                let corners = [(horizontal.0, clip(up(range.0))), (horizontal.1, clip(up(range.1)))];
                chart.draw_series([Rectangle::new(corners, filled)])?;
            }
            Mark::Deadline { at, .. } => {
                let ends = [(across(*at), vertical.0), (across(*at), vertical.1)];
                chart.draw_series(LineSeries::new(ends, Ink::Limit.colour().stroke_width(2 * FINE as u32)))?;
            }
            Mark::Boxes { boxes, .. } => {
                let corners = |b: &[f64; 4]| [(across(b[0]), clip(up(b[2]))), (across(b[1]), clip(up(b[3])))];
                chart.draw_series(boxes.iter().map(|b| Rectangle::new(corners(b), filled)))?;
            }
        }
        Ok(())
    }

    fn draw_row_names(&self, area: &Area<'_>, common: &CommonAxis<'_>) -> Drawn {
        let VerticalAxis::Rows(rows) = &self.axis else { return Ok(()) };
        let row_height = (self.height - HEAD_HEIGHT - PANEL_GAP) / rows.len().max(1) as i32;
        let style = text_style(11, Ink::Muted, FontStyle::Normal).pos(Pos::new(HPos::Right, VPos::Center));
        for (index, row) in rows.iter().enumerate() {
            let y = HEAD_HEIGHT + row_height * index as i32 + row_height / 2;
            area.draw(&Text::new(row.clone(), ((common.shape.left - 8) * FINE, y * FINE), style.clone()))?;
        }
        Ok(())
    }
}

/// A vertical axis that can be labelled, linear or logarithmic.
trait VerticalScale: Ranged<ValueType = f64> + ValueFormatter<f64> {}
impl<Y: Ranged<ValueType = f64> + ValueFormatter<f64>> VerticalScale for Y {}

/// A chart over a linear horizontal axis.
type Chart<'a, 'b, Y> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, Y>>;

/// Labels at 1, 10, 100 ...; the grid lines in between have none.
fn power_of_ten(count: f64) -> String {
    let exponent = count.log10().round();
    let whole = (count / 10f64.powf(exponent) - 1.0).abs() < 1e-6 && exponent >= 0.0;
    if whole { PAGE.write(count.round()) } else { String::new() }
}

/// Labels of an axis of exponents: 0.01, 1, 100; powers beyond 10^4 as such; lines between whole powers have none.
fn exponent_label(exponent: f64) -> String {
    let whole = exponent.round();
    match whole {
        _ if (exponent - whole).abs() > 1e-6 => String::new(),
        w if (-3.0..=4.0).contains(&w) => PAGE.write(10f64.powf(w)),
        w => format!("1e{w:.0}").replace('-', "\u{2212}"),
    }
}

/// Estimated width of a text of 11 px [px]: no font is available, and every reader has another one.
fn text_width(text: &str) -> i32 {
    (text.chars().count() as f64 * 6.1).ceil() as i32
}
