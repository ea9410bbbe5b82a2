//! Palette: every colour has a name and a value on light and on dark ground. Pictures use the names as CSS variables,
//! so one picture serves light screen, dark screen and print.

use std::fmt::Write as _;

use plotters::style::RGBColor;

/// A colour by its use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Headings in a picture.
    Text,
    /// Numbers at the axes, legends.
    Muted,
    /// Axes.
    Axis,
    /// Grid lines.
    Grid,
    /// Band below lines: the free gap.
    Band,
    /// Limits and deadlines.
    Limit,
    /// The f64 reference, a broad line below the board's.
    Reference,
    /// Bars of the histogram.
    Bar,
    /// Teeth in contact on the drive side.
    DriveSide,
    /// Parted teeth.
    Separated,
    /// Teeth in contact on the back side.
    BackSide,
    /// First line of a picture, first planet.
    First,
    /// Second line.
    Second,
    /// Third line.
    Third,
    /// Fourth line.
    Fourth,
    /// Fifth line.
    Fifth,
    /// First class of a map, of the least values: darkest on dark ground, brightest on light ground.
    Class1,
    /// Second class.
    Class2,
    /// Third class.
    Class3,
    /// Fourth class.
    Class4,
    /// Fifth class.
    Class5,
    /// Sixth class.
    Class6,
    /// Seventh class.
    Class7,
    /// Eighth class.
    Class8,
}

/// Lines of a picture in the order of use, distinguishable for colour-blind readers (after Okabe and Ito, 2008).
pub const LINES: [Ink; 5] = [Ink::First, Ink::Second, Ink::Third, Ink::Fourth, Ink::Fifth];

/// Classes of a map from the least value to the greatest (viridis, which stays ordered without colours).
pub const CLASSES: [Ink; 8] =
    [Ink::Class1, Ink::Class2, Ink::Class3, Ink::Class4, Ink::Class5, Ink::Class6, Ink::Class7, Ink::Class8];

/// Name, value on light ground, value on dark ground. The light values must differ, since they are the placeholders of
/// the variables in a drawn picture.
const INK_TABLE: [(Ink, &str, u32, u32); 24] = [
    (Ink::Text, "text", 0x1b2430, 0xe8ecf1),
    (Ink::Muted, "muted", 0x5b6776, 0x9aa7b6),
    (Ink::Axis, "axis", 0x98a3b0, 0x566272),
    (Ink::Grid, "grid", 0xe7ebf0, 0x252d38),
    (Ink::Band, "band", 0xf3ead2, 0x332d1c),
    (Ink::Limit, "limit", 0xc62f3b, 0xff6b74),
    (Ink::Reference, "reference", 0xb7c0cb, 0x6d7a89),
    (Ink::Bar, "bar", 0x3f7fb8, 0x5ea3dd),
    (Ink::DriveSide, "drive-side", 0x4c9fd4, 0x3f8fc4),
    (Ink::Separated, "separated", 0xf2dfae, 0x6a5b2c),
    (Ink::BackSide, "back-side", 0xd9743f, 0xd06a35),
    (Ink::First, "line-1", 0x0072b2, 0x56b4e9),
    (Ink::Second, "line-2", 0xd55e00, 0xff9248),
    (Ink::Third, "line-3", 0x009e73, 0x2fd0a2),
    (Ink::Fourth, "line-4", 0xb0508c, 0xe08fc4),
    (Ink::Fifth, "line-5", 0x9c7a00, 0xe6c229),
    (Ink::Class1, "class-1", 0xfde725, 0x440154),
    (Ink::Class2, "class-2", 0xa0da39, 0x46327e),
    (Ink::Class3, "class-3", 0x4ac16d, 0x365c8d),
    (Ink::Class4, "class-4", 0x1fa187, 0x277f8e),
    (Ink::Class5, "class-5", 0x277f8e, 0x1fa187),
    (Ink::Class6, "class-6", 0x365c8d, 0x4ac16d),
    (Ink::Class7, "class-7", 0x46327e, 0xa0da39),
    (Ink::Class8, "class-8", 0x440154, 0xfde725),
];

impl Ink {
    /// Value on light ground, for plotters.
    pub fn colour(self) -> RGBColor {
        let (_, _, light, _) = INK_TABLE[self.table_row()];
        let [_, red, green, blue] = light.to_be_bytes();
        RGBColor(red, green, blue)
    }

    /// Name of the CSS variable.
    pub fn name(self) -> &'static str {
        INK_TABLE[self.table_row()].1
    }

    fn table_row(self) -> usize {
        // The test `inks_have_distinct_values` checks that every variant has its row.
        INK_TABLE.iter().position(|row| row.0 == self).unwrap_or(0)
    }
}

/// Replaces the light values by the variables.
pub fn with_variables(mut svg: String) -> String {
    for (_, name, light, _) in INK_TABLE {
        svg = svg.replace(&format!("\"#{light:06X}\""), &format!("\"var(--{name})\""));
    }
    svg
}

/// CSS that defines the variables for the selector `root`.
pub fn style_sheet(root: &str) -> String {
    let mut light = String::new();
    let mut dark = String::new();
    for (_, name, on_light, on_dark) in INK_TABLE {
        // Writing to a string cannot fail.
        let _ = write!(light, "--{name}:#{on_light:06x};");
        let _ = write!(dark, "--{name}:#{on_dark:06x};");
    }
    format!("{root}{{{light}}}\n@media screen and (prefers-color-scheme:dark){{{root}{{{dark}}}}}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inks_have_distinct_values() {
        for (index, (ink, name, light, _)) in INK_TABLE.iter().enumerate() {
            assert_eq!(*ink as usize, index, "rows stand in the order of the variants");
            assert!(INK_TABLE.iter().filter(|row| row.1 == *name || row.2 == *light).count() == 1, "{name}");
        }
    }

    #[test]
    fn colours_become_variables() {
        assert_eq!(with_variables(r##"<a fill="#0072B2"/>"##.into()), r#"<a fill="var(--line-1)"/>"#);
    }
}
